"""Errors: in words, with the elements selected, and the mesh as it was."""

import os

import bmesh
import bpy
import numpy as np
import scenes
from checks import check
from fill_hole_coherently import session
from fill_hole_coherently.complete_mesh import CompleteMeshError, Status, _library
from test_edit import edit, leave, selected_vertices
from test_fill import fill


def complaint(**options):
    """What a script gets when the operator reports an error."""
    try:
        fill(**options)
    except RuntimeError as error:
        return str(error)
    return ""


def test_touching_holes():
    vertices, polygons, touching = scenes.bow_tie_data()
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.add(vertices, polygons)
        before = scenes.snapshot(ob)
        if mode == "EDIT":
            edit("FACE")
        text = complaint(max_edges=8, join_loops=False)
        check(f"{mode}: touching holes in words", "touch" in text and f"{touching}" in text, text)
        check(f"{mode}: says what to do", "Skip Unsafe" in text, text)
        if mode == "EDIT":
            check("touching vertex is selected", selected_vertices(ob) == [touching])
            leave()
        chosen = np.flatnonzero(scenes.get(ob.data.vertices, "select", 1, bool)).tolist()
        check(f"{mode}: the vertex is selected", chosen == [touching], chosen)
        check(f"{mode}: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
        check(f"{mode}: skip unsafe fills the other",
              fill(max_edges=8, join_loops=False, skip_unsafe=True, method="SMOOTH") == {"FINISHED"})
        new = [tuple(p.vertices) for p in list(ob.data.polygons)[len(polygons):]]
        corners = {1 + 6 * 9, 2 + 6 * 9, 1 + 7 * 9, 2 + 7 * 9}
        check(f"{mode}: the other hole", new and {i for face in new for i in face if i < 81} == corners, new)
        check(f"{mode}: attributes and all the rest", not scenes.kept(before, scenes.snapshot(ob)))


def test_nothing_but_unsafe_holes():
    vertices, polygons, _ = scenes.bow_tie_data()
    ob = scenes.add(vertices, polygons)
    before = scenes.snapshot(ob)
    state = fill(max_edges=4, join_loops=False, skip_unsafe=True)
    check("fills the hole that can be", state == {"FINISHED"})
    before = scenes.snapshot(ob)
    check("nothing is left", fill(max_edges=8, join_loops=False, skip_unsafe=True) == {"CANCELLED"})
    check("nothing is changed", scenes.same(before, scenes.snapshot(ob)))


def test_coordinate_that_is_not_finite():
    ob = scenes.column(rich=False)
    ob.data.vertices[11].co.y = float("nan")
    before = scenes.snapshot(ob)
    edit("FACE")
    text = complaint()
    check("not finite, in words", "vertex 11" in text.lower() and "finite" in text, text)
    check("the vertex is selected", selected_vertices(ob) == [11])
    leave()
    check("not finite: the mesh is as it was", not scenes.kept(before, scenes.snapshot(ob)))


def test_hole_that_fails():
    """The rim is selected. The failure is made up: which fills fail changes with the library."""
    ob = scenes.column(rich=False)
    real = session.Completer.complete

    def fails(self, **_):
        raise CompleteMeshError(Status.HOLE_FAILED, "hole 1 could not be filled", holes=[1])

    rim = None
    session.forget()
    try:
        session.Completer.complete = fails
        edit("FACE")
        text = complaint()
        rim = sorted(selected_vertices(ob))
        edges = [e for e in bmesh.from_edit_mesh(ob.data).edges if e.select and e.is_boundary]
    finally:
        session.Completer.complete = real
        session.forget()
    leave()
    faces, _ = scenes.triangles(ob.data)
    hole = session.Completer(scenes.positions(ob.data), faces).holes[1]
    check("failed hole in words", text.startswith("Error: Hole 1 could not") and "Skip Unsafe" in text, text)
    check("its rim is selected", rim == sorted(hole.loops[0].tolist()) and len(edges) == hole.edge_count)


def test_triangle_alone():
    """Its hole has its own shape."""
    ob = scenes.add([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    before = scenes.snapshot(ob)
    text = complaint(method="SMOOTH")
    check("a triangle alone is refused in words", len(text) > 40, text)
    check("a triangle alone stays", scenes.same(before, scenes.snapshot(ob)))


def test_nothing_to_fill():
    vertices, polygons = scenes.column_data(windows=())
    ob = scenes.add(vertices, polygons)
    before = scenes.snapshot(ob)
    check("a closed mesh", fill() == {"CANCELLED"})
    check("a closed mesh stays", scenes.same(before, scenes.snapshot(ob)))
    ob = scenes.column()
    before = scenes.snapshot(ob)
    check("no hole is small enough", fill(max_edges=5) == {"CANCELLED"})
    check("all stays", scenes.same(before, scenes.snapshot(ob)))


def test_no_faces():
    for data in (([], []), ([(0, 0, 0), (1, 0, 0)], [])):
        scenes.add(*data)
        check("a mesh of too few points, in words", "too few for a surface" in complaint(), complaint())


def test_not_a_mesh():
    scenes.clear()
    bpy.context.view_layer.objects.active = None
    check("no object", not bpy.ops.mesh.fill_hole_coherently.poll())
    empty = bpy.data.objects.new("empty", None)
    bpy.context.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    check("not a mesh", not bpy.ops.mesh.fill_hole_coherently.poll())
    scenes.column(rich=False)
    check("a mesh", bpy.ops.mesh.fill_hole_coherently.poll())


def test_attribute_of_the_user():
    """One that has our name and another meaning is left alone."""
    ob = scenes.column()
    own = ob.data.attributes.new(name="completion_source", type="FLOAT", domain="CORNER")
    own.data.foreach_set("value", np.arange(len(ob.data.loops), dtype=np.float32))
    corners = len(ob.data.loops)
    check("filled all the same", fill() == {"FINISHED"})
    own = ob.data.attributes["completion_source"]
    kind = own.domain, own.data_type
    check("the user's attribute is left alone", kind == ("CORNER", "FLOAT"), kind)
    values = scenes.get(own.data, "value", 1, np.float32)[:corners, 0]
    check("its values, too", np.array_equal(values, np.arange(corners)))
    check("the others are written", "completed" in ob.data.attributes)


def test_library_missing():
    """The add-on registers all the same; the operator says what is missing."""
    ob = scenes.column()
    before = scenes.snapshot(ob)
    loaded, _library._loaded = _library._loaded, None
    os.environ["COMPLETE_MESH_LIBRARY"] = "/nowhere/libcomplete_mesh.so"
    session.forget()
    try:
        text = complaint()
    finally:
        del os.environ["COMPLETE_MESH_LIBRARY"]
        _library._loaded = loaded
    check("library missing, in words", "/nowhere/libcomplete_mesh.so" in text, text)
    check("library missing: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
