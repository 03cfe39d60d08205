"""Undo gives the mesh back; redo with other options gives what they give, and quickly."""

import bpy
import scenes
from checks import check
from fill_hole_coherently import session
from test_edit import edit, leave
from test_fill import check_added, reference


def thing():
    """After undo, what Python held is stale."""
    return bpy.data.objects["thing"]


def do(**options):
    return bpy.ops.mesh.fill_hole_coherently("EXEC_DEFAULT", True, **options)


def snapshot_anywhere():
    mode = thing().mode
    if mode == "EDIT":
        thing().update_from_editmode()
    return scenes.snapshot(thing())


class Counted:
    """Counts the completers that are made and the fills."""

    def __enter__(self):
        self.made, self.fills = [], []
        real = self._real = session.Completer
        counted = self

        class Completer(real):
            def __init__(self, *arguments, **options):
                counted.made.append(options)
                super().__init__(*arguments, **options)

            def complete(self, **options):
                counted.fills.append(options)
                return super().complete(**options)

        session.Completer = Completer
        session.forget()
        return self

    def __exit__(self, *_):
        session.Completer = self._real
        session.forget()


def in_mode(mode, rich=True):
    scenes.column(rich)
    if mode == "EDIT":
        edit()
    bpy.ops.ed.undo_push(message="start")


def test_undo_and_redo():
    scenes.column()
    wanted = {density: reference(thing(), sizing="scaled", sizing_value=1 / density)[0] for density in (0.5, 2.0)}
    wanted[1.0], _ = reference(thing())
    for mode in ("OBJECT", "EDIT"):
        in_mode(mode)
        before = snapshot_anywhere()
        with Counted() as counted:
            for density in (1.0, 2.0, 0.5, 1.0):
                check(f"{mode}: density {density}", do(density=density) == {"FINISHED"})
                after = snapshot_anywhere()
                check(f"{mode}: something was filled", len(after["positions"]) > len(before["positions"]))
                bpy.ops.ed.undo()
                check(f"{mode}: undo {density} gives the mesh back", scenes.same(before, snapshot_anywhere()))
                check(f"{mode}: mode stays", thing().mode == mode)
                bpy.ops.ed.redo()
                check(f"{mode}: redo {density} gives the fill again", scenes.same(after, snapshot_anywhere()))
                if mode == "EDIT":
                    leave()
                check_added(f"{mode}: redo {density}", thing(), before, wanted[density])
                if mode == "EDIT":
                    bpy.ops.ed.undo_push(message="left")
                    bpy.ops.ed.undo()
                bpy.ops.ed.undo()
            check(f"{mode}: one completer for all", len(counted.made) == 1, len(counted.made))
            check(f"{mode}: a fill for each change", len(counted.fills) == 4, len(counted.fills))


def test_same_fill_is_not_computed_again():
    """An option that does not touch the shape needs no new fill."""
    in_mode("OBJECT")
    with Counted() as counted:
        do(write_attributes=True)
        first = snapshot_anywhere()
        bpy.ops.ed.undo()
        do(write_attributes=False)
        check("the same fill", not scenes.kept(snapshot_anywhere(), first))
        check("computed once", len(counted.fills) == 1, len(counted.fills))


def test_cache_follows_the_mesh():
    """A mesh that differs in one coordinate is another mesh."""
    in_mode("OBJECT", rich=False)
    with Counted() as counted:
        do()
        bpy.ops.ed.undo()
        thing().data.vertices[5].co.x += 0.01
        before = snapshot_anywhere()
        result, _ = reference(thing())
        do()
        check_added("moved vertex", thing(), before, result)
        check("a completer for each mesh", len(counted.made) == 2, len(counted.made))
        check("no more are kept than needed", len(session._kept) <= session.KEPT_MESHES)


def test_nothing_is_kept_over_files():
    in_mode("OBJECT")
    do()
    check("kept", len(session._kept) > 0)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    check("forgotten when another file is loaded", len(session._kept) == 0)
