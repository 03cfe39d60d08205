"""Edit Mode: the selection chooses, and the mesh in the editor is what is filled."""

import bmesh
import bpy
import numpy as np
import scenes
from checks import check
from fill_hole_coherently.complete_mesh import list_holes
from test_fill import check_added, check_attributes, check_looks, fill, reference


def edit(select_mode="FACE"):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_mode(type=select_mode)
    bpy.ops.mesh.select_all(action="DESELECT")


def leave():
    bpy.ops.object.mode_set(mode="OBJECT")


def select_vertices(ob, indices):
    bm = bmesh.from_edit_mesh(ob.data)
    bm.verts.ensure_lookup_table()
    for i in indices:
        bm.verts[i].select_set(True)
    bm.select_flush_mode()
    bmesh.update_edit_mesh(ob.data)


def selected_vertices(ob):
    bm = bmesh.from_edit_mesh(ob.data)
    return [vertex.index for vertex in bm.verts if vertex.select]


def rims(ob):
    faces, _ = scenes.triangles(ob.data)
    return [hole.loops[0].tolist() for hole in list_holes(scenes.positions(ob.data), faces)]


def test_edit_mode():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    result, polygons = reference(ob)
    edit()
    check("edit mode", fill() == {"FINISHED"})
    check("edit mode stays", ob.mode == "EDIT")
    bm = bmesh.from_edit_mesh(ob.data)
    m = len(before["polygon sizes"])
    check("new faces, and they alone, are selected in edit mode",
          [face.select for face in bm.faces] == [i >= m for i in range(len(bm.faces))])
    leave()
    check_added("edit mode", ob, before, result)
    check_looks(ob, result, len(before["positions"]), m)
    check_attributes(ob, result, polygons, len(before["positions"]), m)


def test_moved_in_the_editor():
    """What was moved since Edit Mode was entered counts."""
    ob = scenes.column(rich=False)
    edit()
    bm = bmesh.from_edit_mesh(ob.data)
    for vertex in bm.verts:
        vertex.co.z *= 1.25
    bmesh.update_edit_mesh(ob.data)
    leave()
    result, _ = reference(ob)
    before = scenes.snapshot(ob)
    ob = scenes.column(rich=False)
    edit()
    bm = bmesh.from_edit_mesh(ob.data)
    for vertex in bm.verts:
        vertex.co.z *= 1.25
    fill()
    leave()
    check_added("moved in the editor", ob, before, result)


def test_selection_chooses():
    for which in (0, 1):
        ob = scenes.column()
        before = scenes.snapshot(ob)
        rim = rims(ob)[which]
        result, _ = reference(ob, selection="ids", selection_ids=[which])
        edit("VERT")
        select_vertices(ob, rim[3:4])
        check(f"hole {which} by a vertex", fill() == {"FINISHED"})
        leave()
        check_added(f"hole {which} by a vertex", ob, before, result)


def test_faces_at_the_rim_choose():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    rim = set(rims(ob)[1])
    result, _ = reference(ob, selection="ids", selection_ids=[1])
    edit("FACE")
    bm = bmesh.from_edit_mesh(ob.data)
    next(f for f in bm.faces if len(rim & {v.index for v in f.verts}) >= 2).select_set(True)
    bmesh.update_edit_mesh(ob.data)
    fill()
    leave()
    check_added("hole by a face", ob, before, result)


def test_selection_elsewhere():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    far = sorted(set(range(len(ob.data.vertices))) - set(sum(rims(ob), [])))[7]
    edit("VERT")
    select_vertices(ob, [far])
    check("selection elsewhere fills nothing", fill() == {"CANCELLED"})
    check("the selection stays", selected_vertices(ob) == [far])
    leave()
    check("the mesh stays", scenes.same(before, scenes.snapshot(ob)))


def test_one_hole_after_the_other():
    """Attributes of the first fill live through the second."""
    ob = scenes.column()
    start = scenes.snapshot(ob)
    edit("VERT")
    select_vertices(ob, [rims(ob)[0][0]])
    fill()
    leave()
    between = scenes.snapshot(ob)
    names = ("completed", "completion_source", "completion_confidence")
    types = (np.int32, np.int32, np.float32)

    def ours():
        attributes = (ob.data.attributes[name].data for name in names)
        return [scenes.get(data, "value", 1, dtype)[:, 0] for data, dtype in zip(attributes, types)]

    first = ours()
    result, _ = reference(ob)
    fill()
    check_added("second hole", ob, between, result)
    for name, was, now in zip(names, first, ours()):
        check(f"{name} of the first fill", np.array_equal(now[: len(was)], was) and len(now) > len(was))
    faces = len(ob.data.polygons) - len(start["polygon sizes"])
    check("completed says both", ours()[0].sum() == faces)


def test_active_shape_key():
    """With another key active, Edit Mode shows and edits that one."""
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.column()
        before = scenes.snapshot(ob)
        ob.active_shape_key_index = 1
        if mode == "EDIT":
            edit()
        fill()
        if mode == "EDIT":
            leave()
        check_filled_keys(mode, ob, before)


def check_filled_keys(mode, ob, before):
    lost = scenes.kept(before, scenes.snapshot(ob))
    check(f"{mode}, active key: keys and mesh are kept", not lost, lost)
    n = len(before["positions"])
    blocks = ob.data.shape_keys.key_blocks
    raised = scenes.get(blocks["raised"].data, "co", 3, np.float32)[n:]
    basis = scenes.get(blocks["Basis"].data, "co", 3, np.float32)[n:]
    check(f"{mode}, active key: the fill lies in the key's and in the basis's surface",
          np.abs(raised - basis - (0, 0, 0.25)).max() < 1e-5 and len(raised) > 50)
    angle = np.arctan2(basis[:, 1], basis[:, 0])
    off = np.abs(np.hypot(basis[:, 0], basis[:, 1]) - 1 - 0.05 * np.cos(12 * angle)).max()
    check(f"{mode}, active key: on the column", off < 0.04, off)
