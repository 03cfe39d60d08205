"""The way from the menu: a thread, progress, Esc. There is no window here, so the operator's own
methods are driven with a window manager that writes down what is asked of it."""

import threading
import time
import types

import bpy
import scenes
from checks import check
from fill_hole_coherently import operator, session
from fill_hole_coherently.guidance import Guided
from test_edit import edit, leave
from test_fill import check_added, reference

OPERATOR = operator.MESH_OT_fill_hole_coherently


class Manager:
    def __init__(self):
        self.said, self.timers, self.open = [], 0, 0

    def progress_begin(self, low, high):
        self.range, self.open = (low, high), self.open + 1

    def progress_update(self, value):
        self.said.append(value)

    def progress_end(self):
        self.open -= 1

    def event_timer_add(self, _step, window):
        self.timers += 1
        return "timer"

    def event_timer_remove(self, _timer):
        self.timers -= 1

    def modal_handler_add(self, _operator):
        self.handled = True


class Driven:
    """An operator in a window."""

    method, density, max_edges = "COHERENT", 1.0, 0
    source, place, mirror, candidate, points_object = "MESH", "SEARCH", True, 0, ""
    least_scale, greatest_scale, match_colors = 1.0, 1.0, True
    part, loose_group, initial_object, source_and_mesh = False, "", "", False
    keep_largest_open, join_loops, skip_unsafe, write_attributes = False, True, False, True
    invoke, modal, cancel, execute = OPERATOR.invoke, OPERATOR.modal, OPERATOR.cancel, OPERATOR.execute
    others, sources, guidance, points = Guided.others, Guided.sources, Guided.guidance, Guided.points
    rims, of_others_alone = Guided.rims, Guided.of_others_alone
    _arguments, _show = OPERATOR._arguments, OPERATOR._show
    _clean_up, _take, _finish, _fail = OPERATOR._clean_up, OPERATOR._take, OPERATOR._finish, OPERATOR._fail

    def __init__(self):
        self.reports, self.texts, self.manager = [], [], Manager()
        self.context = types.SimpleNamespace(
            window="window",
            window_manager=self.manager,
            active_object=bpy.context.active_object,
            workspace=types.SimpleNamespace(status_text_set=self.texts.append),
            tool_settings=bpy.context.tool_settings,
        )
        session.forget()
        real, operator.bpy = operator.bpy, types.SimpleNamespace(
            app=types.SimpleNamespace(background=False), data=bpy.data
        )
        try:
            self.state = self.invoke(self.context, None)
        finally:
            operator.bpy = real

    def report(self, kind, text):
        self.reports.append((*kind, text))

    def send(self, kind, value="NOTHING"):
        self.state = self.modal(self.context, types.SimpleNamespace(type=kind, value=value))
        return self.state

    def until_done(self, after=lambda: None):
        """Timer events until it ends; gives how many there were."""
        for ticks in range(1, 20000):
            after()
            if self.send("TIMER") != {"RUNNING_MODAL"}:
                return ticks
            time.sleep(0.002)
        return 0

    def check_closed(self, name):
        check(f"{name}: progress and timer are put away", (self.manager.open, self.manager.timers) == (0, 0))
        check(f"{name}: status line is cleared", self.texts[-1:] == [None])


def test_fills_with_progress():
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.column()
        before = scenes.snapshot(ob)
        result, _ = reference(ob)
        if mode == "EDIT":
            edit()
        driven = Driven()
        check(f"{mode}: goes on in the background", driven.state == {"RUNNING_MODAL"} and driven.manager.handled)
        check(f"{mode}: on another thread", driven._job._thread is not threading.current_thread())
        check(f"{mode}: other input waits", driven.send("A", "PRESS") == {"RUNNING_MODAL"})
        check(f"{mode}: the view can be moved", driven.send("WHEELUPMOUSE", "PRESS") == {"PASS_THROUGH"})
        ticks = driven.until_done()
        check(f"{mode}: ends", driven.state == {"FINISHED"}, (driven.state, driven.reports))
        check(f"{mode}: Blender goes on meanwhile", ticks > 8, ticks)
        said = driven.manager.said
        check(f"{mode}: progress never falls", said == sorted(said) and len(set(said)) > 4, said)
        check(f"{mode}: progress ends at 100", said[-1] == 100 and driven.manager.range == (0, 100), said[-1])
        check(f"{mode}: says what it does and how to stop", any("Esc cancels" in (text or "") for text in driven.texts))
        driven.check_closed(mode)
        if mode == "EDIT":
            leave()
        check_added(f"{mode}: from the menu", ob, before, result)
        check(f"{mode}: reports", [kind for kind, _ in driven.reports] == ["INFO"], driven.reports)


def test_esc_cancels():
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.column()
        before = scenes.snapshot(ob)
        if mode == "EDIT":
            edit()
        for wait in (0.0, 0.3, 0.6):
            driven = Driven()
            while driven._job.fraction < wait and driven._job.is_running:
                time.sleep(0.001)
            driven.send("ESC", "PRESS")
            driven.until_done()
            check(f"{mode}: Esc at {wait} cancels", driven.state == {"CANCELLED"}, driven.reports)
            check(f"{mode}: says so", driven.reports and driven.reports[0][:2] == ("INFO", "Cancelled: the mesh is as it was"))
            check(f"{mode}: the thread has ended", not driven._job.is_running)
            driven.check_closed(mode)
        if mode == "EDIT":
            leave()
        check(f"{mode}: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))


def test_blender_ends_it():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    driven = Driven()
    driven.cancel(driven.context)
    check("the thread ends with Blender", not driven._job.is_running)
    driven.check_closed("Blender ends it")
    check("the mesh is as it was then", scenes.same(before, scenes.snapshot(ob)))


def test_mesh_changes_meanwhile():
    """By a script or a timer of somebody else: the fill would not fit."""
    ob = scenes.column()
    driven = Driven()
    ob.data.vertices[3].co.x += 1
    before = scenes.snapshot(ob)
    driven.until_done()
    check("a mesh that changed is left", driven.state == {"CANCELLED"} and driven.reports[0][0] == "ERROR")
    check("a mesh that changed stays", scenes.same(before, scenes.snapshot(ob)))
    scenes.column()
    driven = Driven()
    scenes.clear()
    driven.until_done()
    check("a mesh that is gone", driven.state == {"CANCELLED"} and driven.reports[0][0] == "ERROR")


def test_trouble_on_the_thread():
    ob = scenes.column(rich=False)
    ob.data.vertices[11].co.y = float("nan")
    driven = Driven()
    driven.until_done()
    kind, text = driven.reports[0]
    check("an error on the thread is shown", kind == "ERROR" and "ertex 11" in text, driven.reports)
    check("and ends it", driven.state == {"CANCELLED"})
    driven.check_closed("error")
