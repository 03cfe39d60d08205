"""Progress, cancelling, and what goes on meanwhile."""

import os
import signal
import threading
import time

import numpy as np
import pytest
from complete_mesh import Cancelled, Completer, Status, complete_mesh, list_holes
from conftest import same
from meshes import column


@pytest.fixture(scope="module")
def small():
    """Quick to fill, for a call per progress call."""
    return column(around=36, up=24, windows=((0.8, 0.5, 0.5),), flutes=6)


CALLS = {
    "complete_mesh": complete_mesh,
    "list_holes": list_holes,
    "Completer": Completer,
    "Completer.complete": lambda v, f, progress: Completer(v, f).complete(progress=progress),
}


@pytest.mark.parametrize("name", CALLS)
def test_progress_never_falls_and_comes_to_the_end(small, name):
    seen = []
    CALLS[name](*small, progress=lambda *call: seen.append((*call, threading.get_ident())))
    fractions, stages, threads = zip(*seen)
    assert list(fractions) == sorted(fractions) and 0 <= fractions[0] and fractions[-1] <= 1
    assert all(isinstance(stage, str) and stage for stage in stages)
    assert set(threads) == {threading.get_ident()}
    if name in ("complete_mesh", "Completer.complete"):
        assert fractions[-1] == 1 and len(set(fractions)) > 5 and len(set(stages)) > 3


@pytest.mark.parametrize("name", CALLS)
def test_every_progress_call_can_cancel(small, name):
    vertices, faces = small[0].copy(), small[1].copy()
    cancelled = 0
    while True:
        calls = []

        def progress(*call):
            calls.append(call)
            return len(calls) > cancelled

        try:
            CALLS[name](*small, progress=progress)
        except Cancelled as error:
            assert error.status == Status.CANCELLED
            cancelled += 1
            assert len(calls) == cancelled  # and none after it
        else:
            break  # there were fewer calls: how many depends on the time they take
    assert len(calls) <= cancelled
    assert cancelled >= (20 if name in ("complete_mesh", "Completer.complete") else 1)
    assert same(vertices, small[0]) and same(faces, small[1])


def test_cancelled_completer_fills_again(small):
    completer = Completer(*small)
    reference = complete_mesh(*small)
    for at in (0.05, 0.3, 0.6, 0.9):
        with pytest.raises(Cancelled):
            completer.complete(progress=lambda fraction, _: fraction >= at)
        assert same(completer.complete().vertices, reference.vertices)


def test_result_does_not_depend_on_progress(small):
    watched = complete_mesh(*small, progress=lambda *_: None)
    assert same(watched.vertices, complete_mesh(*small).vertices)


def test_exception_comes_out(small):
    class Mine(Exception):
        pass

    calls = []

    def progress(*call):
        calls.append(call)
        if len(calls) == 3:
            raise Mine("enough")

    with pytest.raises(Mine, match="enough"):
        complete_mesh(*small, progress=progress)
    assert len(calls) == 3


@pytest.fixture
def ctrl_c():
    """Python's own handler, which is not there in a program that was started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("progress", [None, lambda *_: None])
def test_ctrl_c_cancels(ctrl_c, progress):
    mesh = column(around=120, up=90, windows=((0.8, 0.5, 0.6),))
    start = time.monotonic()
    complete_mesh(*mesh)
    whole = time.monotonic() - start
    taken = []
    for _ in range(5):
        timer = threading.Timer(min(whole * 0.2, 0.1), os.kill, [os.getpid(), signal.SIGINT])
        start = time.monotonic()
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            complete_mesh(*mesh, progress=progress)
        taken.append(time.monotonic() - start)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert min(taken) < whole * 0.8  # others may keep the machine busy


def test_handler_of_the_host_is_left_alone(small):
    came = []
    before = signal.signal(signal.SIGINT, lambda *_: came.append(1))
    try:
        sent = []

        def progress(*_):
            if not sent:
                sent.append(os.kill(os.getpid(), signal.SIGINT))

        result = complete_mesh(*small, progress=progress)
        assert result.filled_count == 1 and came == [1]
    finally:
        signal.signal(signal.SIGINT, before)


def test_other_threads_run_meanwhile(broken):
    """With the GIL held, nothing could be counted between two progress calls."""
    state = {"ticks": 0, "on": True}

    def tick():
        while state["on"]:
            state["ticks"] += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        between, last = [], None

        def progress(*_):
            nonlocal last
            if last is not None:
                between.append(state["ticks"] - last)
            last = state["ticks"]

        complete_mesh(*broken, progress=progress)
    finally:
        state["on"] = False
        thread.join()
    # Progress calls may let others run, too, but only for a tick or so.
    assert max(between) > 8


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_number_of_workers_changes_no_byte(broken, threads):
    one, many = complete_mesh(*broken, threads=1), complete_mesh(*broken, threads=threads)
    for name in ("vertices", "faces", "new_vertex_barycentrics", "new_vertex_confidences"):
        assert same(getattr(one, name), getattr(many, name))


@pytest.mark.parametrize("kept", [False, True])
def test_calls_on_many_threads_change_no_byte(broken, kept):
    meshes = [broken, (broken[0][:, [1, 2, 0]], broken[1]), (broken[0] * 2, broken[1])]
    if kept:
        completer = Completer(*broken)
        options = [{}, {"method": "smooth"}, {"selection": "ids", "selection_ids": [1]}]
        jobs = [lambda o=o: completer.complete(**o) for o in options] * 2
    else:
        jobs = [lambda m=m: complete_mesh(*m) for m in meshes] * 2
    alone = [job().vertices for job in jobs]
    together = [None] * len(jobs)

    def work(i):
        together[i] = jobs[i]().vertices

    workers = [threading.Thread(target=work, args=(i,)) for i in range(len(jobs))]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert all(same(a, b) for a, b in zip(alone, together))
    assert not np.array_equal(alone[0], alone[1])
