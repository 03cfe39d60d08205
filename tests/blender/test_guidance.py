"""Guided by hand: a place given by an object, other sizes, several objects, points to pass through."""

import bpy
import numpy as np
import scenes
from checks import check
from mathutils import Euler, Matrix
from mathutils.bvhtree import BVHTree
from test_fill import check_added, fill, reference


def off_column(places):
    """How far points are from the faces of the intact column."""
    vertices, polygons = scenes.column_data(windows=())
    tree = BVHTree.FromPolygons(vertices.tolist(), polygons)
    return np.array([tree.find_nearest(p)[3] for p in places.tolist()])


def whole(name, matrix, windows=()):
    """The column without holes, as an object that stands as a matrix says."""
    vertices, polygons = scenes.column_data(windows=windows)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices.tolist(), [], polygons)
    other = bpy.data.objects.new(name, mesh)
    other.matrix_world = matrix
    bpy.context.collection.objects.link(other)
    bpy.context.view_layer.update()
    return other


def like(name, matrix):
    """An Empty."""
    empty = bpy.data.objects.new(name, None)
    empty.matrix_world = matrix
    bpy.context.collection.objects.link(empty)
    bpy.context.view_layer.update()
    return empty


def turned(scale=1.0, mirrored=False, shift=(0, 0, 0), angles=(0.3, 0.2, 0.1)):
    flip = Matrix.Diagonal((-1 if mirrored else 1, 1, 1, 1))
    return Matrix.Translation(shift) @ Euler(angles).to_matrix().to_4x4() @ Matrix.Scale(scale, 4) @ flip


def new_places(ob, before):
    return scenes.positions(ob.data)[len(before["positions"]) :]


def test_twin_of_another_size():
    """An intact twin, mirrored and 2.5 times as large: found with a range of scales, and not without."""
    errors = {}
    for scales in (None, (0.3, 0.5)):
        ob = scenes.column(rich=False)
        before = scenes.snapshot(ob)
        whole("twin", turned(2.5, True, (9, 2, 1)))
        options = {} if scales is None else {"least_scale": scales[0], "greatest_scale": scales[1]}
        check(f"scales {scales}", fill(source="OBJECT", source_object="twin", **options) == {"FINISHED"})
        lost = scenes.kept(before, scenes.snapshot(ob))
        check(f"scales {scales}: what was there is as it was", not lost, lost)
        errors[scales] = off_column(new_places(ob, before)).max()
    check("a scaled twin gives the surface back", errors[(0.3, 0.5)] < 1e-5, errors)
    check("and not without a range", errors[None] > 0.01, errors)


def test_by_hand_from_another_object():
    """The twin stands over the holes: its own surface to rounding, scaled and mirrored or not. As large
    as it stands in the scene, whatever its own coordinates."""
    for scale, mirrored in ((1.0, False), (0.25, False), (3.0, True)):
        ob = scenes.column(rich=False)
        ob.matrix_world = turned(1.5, False, (1, 2, 3))
        bpy.context.view_layer.update()
        before = scenes.snapshot(ob)
        # A column is its own mirror image across x, which a scaled mesh undoes below.
        twin = whole("twin", ob.matrix_world @ Matrix.Scale(1 / scale, 4) @ Matrix.Diagonal((-1 if mirrored else 1, 1, 1, 1)))
        co = scenes.positions(twin.data) * scale * ((-1, 1, 1) if mirrored else (1, 1, 1))
        twin.data.vertices.foreach_set("co", co.astype(np.float32).ravel())
        if mirrored:
            twin.data.flip_normals()
        name = f"by hand {scale} {mirrored}"
        check(name, fill(source="OBJECT", source_object="twin", place="STAND") == {"FINISHED"})
        lost = scenes.kept(before, scenes.snapshot(ob))
        check(f"{name}: what was there is as it was", not lost, lost)
        off = off_column(new_places(ob, before))
        check(f"{name}: on the column", off.max() < 1e-5, off.max())
        confidence = scenes.get(ob.data.attributes["completion_confidence"].data, "value", 1, np.float32)
        new = confidence[len(before["positions"]) :]
        check(f"{name}: believed", new.min() > 0.8, new.min())


def test_by_hand_is_taken_as_it_is():
    """Off by a thirtieth of the column: worse as it stands than aligned, and the same as the library's."""
    errors = {}
    for place in ("STAND", "ALIGN"):
        ob = scenes.column(rich=False)
        before = scenes.snapshot(ob)
        twin = whole("twin", Matrix.Translation((0.0, 0.03, 0.02)))
        faces, _ = scenes.triangles(twin.data)
        places = scenes.positions(twin.data) + np.float32([0.0, 0.03, 0.02])
        result, _ = reference(
            ob,
            exemplar_vertices=places.astype(np.float32),
            exemplar_faces=faces,
            exemplar_only=True,
            vertex_values=None,
            placement=np.eye(3, 4),
            refine=place == "ALIGN",
        )
        check(place, fill(source="OBJECT", source_object="twin", place=place) == {"FINISHED"})
        close = np.abs(new_places(ob, before) - result.new_vertices).max()
        check(f"{place}: as the library has it", close < 1e-5, close)
        errors[place] = off_column(new_places(ob, before)).max()
    check("aligned it fits better", errors["ALIGN"] < 1e-5 < 0.01 < errors["STAND"], errors)


def test_like_an_empty():
    """The mesh itself, turned by three flutes about its axis, as an Empty shows it: the places of the holes
    come from there and from nowhere else."""
    ob = scenes.column()
    ob.matrix_world = turned(2.0, False, (4, 0, 0))
    bpy.context.view_layer.update()
    before = scenes.snapshot(ob)
    turn = Matrix.Rotation(2 * np.pi * 3 / scenes.FLUTES, 4, "Z")
    like("Empty", ob.matrix_world @ turn)
    result, polygons = reference(ob, placement=np.array(turn)[:3], refine=False)
    check("like an empty", fill(place="STAND", place_object="Empty") == {"FINISHED"})
    n, m = len(before["positions"]), len(before["polygon sizes"])
    # Blender has the matrices as floats.
    close = np.abs(new_places(ob, before) - result.new_vertices).max()
    check("like an empty: as the library has it", close < 1e-5, close)
    off = off_column(new_places(ob, before))
    check("like an empty: on the column", off.max() < 1e-5, off.max())
    came = scenes.get(ob.data.attributes["completion_source"].data, "value", 1, np.int32)[n:, 0]
    check("like an empty: there are sources", (came >= 0).mean() > 0.9, (came >= 0).mean())
    centres = scenes.get(ob.data.polygons, "center", 3, np.float32)
    moved = centres[came[came >= 0]].astype(float) @ np.array(turn)[:3, :3].T
    far = np.linalg.norm(moved - new_places(ob, before)[came >= 0], axis=1)
    check("like an empty: from there", far.max() < 0.12 and came.max() < m, far.max())


def test_collection():
    """Two objects on each other, one of another number of flutes: copied from the one that fits."""
    ob = scenes.column(rich=False)
    before = scenes.snapshot(ob)
    collection = bpy.data.collections.new("twins")
    bpy.context.scene.collection.children.link(collection)
    flutes = scenes.FLUTES
    for name in ("a wrong one", "the twin"):
        scenes.FLUTES = 7 if name == "a wrong one" else flutes
        try:
            other = whole(name, turned(1.0, False, (9, 2, 1)))
        finally:
            scenes.FLUTES = flutes
        collection.objects.link(other)
    objects = [bpy.data.objects[name] for name in ("a wrong one", "the twin")]
    check("from a collection", fill(source="COLLECTION", source_collection="twins") == {"FINISHED"})
    lost = scenes.kept(before, scenes.snapshot(ob))
    check("from a collection: what was there is as it was", not lost, lost)
    off = off_column(new_places(ob, before))
    check("from a collection: on the column", off.max() < 1e-5, off.max())
    came = scenes.get(ob.data.attributes["completion_source"].data, "value", 1, np.int32)
    came = came[len(before["positions"]) :, 0]
    first = len(before["polygon sizes"]) + len(objects[0].data.polygons)
    check("from a collection: of the twin", (came[came >= 0] >= first).mean() > 0.9, (came >= first).mean())
    bpy.data.collections.remove(collection)


def test_through_points():
    """A bump over a hole that nothing shows: the fill passes through its top, seen from another object."""
    angle, z, _ = scenes.WINDOWS[0]
    top = np.array([1.25 * np.cos(angle), 1.25 * np.sin(angle), z])
    near = {}
    for method in ("COHERENT", "SMOOTH"):
        for softness in (None, 0.0, 0.5):
            ob = scenes.column(rich=False)
            ob.matrix_world = turned(2.0, False, (1, 0, 0))
            before = scenes.snapshot(ob)
            options = {}
            if softness is not None:
                mesh = bpy.data.meshes.new("points")
                mesh.from_pydata([(0.0, 0.0, 0.0)], [], [])
                other = bpy.data.objects.new("points", mesh)
                bpy.context.collection.objects.link(other)
                other.location = ob.matrix_world @ Matrix.Translation(top).to_translation()
                options = {"points_object": "points", "softness": softness}
            bpy.context.view_layer.update()
            result, _ = reference(ob, method=method.lower(), **({} if softness is None else
                                  {"constraint_points": top[None], "softness": softness}))
            check(f"{method} {softness}", fill(method=method, **options) == {"FINISHED"})
            places = new_places(ob, before)
            close = np.abs(places - result.new_vertices).max()
            check(f"{method} {softness}: as the library has it", close < 1e-5, close)
            near[softness] = np.linalg.norm(places - top, axis=1).min()
        check(f"{method}: through the point", near[0.0] < 0.08 and near[None] > 2 * near[0.0], near)
        check(f"{method}: softness", near[None] > near[0.5] > near[0.0], near)


def test_far_points_are_refused():
    ob = scenes.column(rich=False)
    before = scenes.snapshot(ob)
    mesh = bpy.data.meshes.new("points")
    mesh.from_pydata([(0.0, 0.0, 90.0)], [], [])
    bpy.context.collection.objects.link(bpy.data.objects.new("points", mesh))
    try:
        fill(points_object="points")
        check("a far point is an error", False)
    except RuntimeError as error:
        check("a far point is an error that names it", "point 0" in str(error), error)
    check("a far point: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))


def test_a_wrong_place_is_not_believed():
    """A third of the column beside it: smooth, and no confidence."""
    ob = scenes.column(rich=False)
    before = scenes.snapshot(ob)
    whole("twin", Matrix.Translation((0.7, 0.5, 0.0)))
    smooth, _ = reference(ob, method="smooth")
    fill(source="OBJECT", source_object="twin", place="STAND")
    check_added("a wrong place", ob, before, smooth)
    confidence = scenes.get(ob.data.attributes["completion_confidence"].data, "value", 1, np.float32)
    check("a wrong place has no confidence", not confidence.any())


def test_not_remembered():
    properties = bpy.ops.mesh.fill_hole_coherently.get_rna_type().properties
    for name in ("place", "place_object", "points_object"):
        check(f"{name} is not remembered", properties[name].is_skip_save)
