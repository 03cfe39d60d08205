"""Meshes of vertices alone: what is added, and that nothing else changes."""

import bmesh
import bpy
import numpy as np
import scenes
from checks import check
from fill_hole_coherently.complete_mesh import complete_points, list_holes
from test_edit import edit, leave, select_vertices, selected_vertices
from test_fill import fill

# A hole of known centre and size on a relief, and another.
CENTRES, RADII = ((14.0, 17.0), (28.0, 15.0)), (4.5, 3.5)


def relief_data():
    """A waving hexagonal lattice of spacing 1 with two holes, and its border."""
    j, i = np.divmod(np.arange(1600), 40)
    x, y = i + 0.5 * (j % 2), j * np.sqrt(0.75)
    points = np.stack([x, y, height(x)], axis=1)
    for (cx, cy), radius in zip(CENTRES, RADII):
        points = points[np.hypot(points[:, 0] - cx, points[:, 1] - cy) >= radius]
    return points


def height(x):
    return 0.3 * np.sin(0.2 * x)


def cloud(rich=True):
    ob = scenes.add(relief_data(), [])
    mesh = ob.data
    if rich:
        x = scenes.positions(mesh)[:, 0].astype(float)
        shade = np.stack([x / 41, 1 - x / 41, 0 * x + 0.25, 0 * x + 1], 1)
        for name, kind in (("paint", "FLOAT_COLOR"), ("bytes", "BYTE_COLOR")):
            layer = mesh.color_attributes.new(name=name, type=kind, domain="POINT")
            layer.data.foreach_set("color", shade.astype(np.float32).ravel())
        own = mesh.attributes.new(name="own", type="FLOAT", domain="POINT")
        own.data.foreach_set("value", x.astype(np.float32))
        label = mesh.attributes.new(name="label", type="INT", domain="POINT")
        label.data.foreach_set("value", (x > 20).astype(np.int32) + 5)
        normal = mesh.attributes.new(name="normal", type="FLOAT_VECTOR", domain="POINT")
        if normal is not None:  # Blender 3.4 keeps that name for itself
            normal.data.foreach_set("vector", np.tile([0, 0, -2], (len(x), 1)).astype(np.float32).ravel())
        group = ob.vertex_groups.new(name="half")
        group.add(np.flatnonzero(x > 20).tolist(), 0.75, "REPLACE")
    return ob


def expected(ob, **options):
    """What the library makes of the same points and what they carry."""
    mesh = ob.data.copy()
    rows, names = scenes.values(mesh)
    normals = None
    if rows is not None:
        if "normal" in mesh.attributes:
            at = sum(width for name, width in names[: [n for n, _ in names].index("normal")])
            normals = rows[:, at : at + 3].astype(np.float32)
            rows = np.delete(rows, [at, at + 1, at + 2], axis=1)
        options |= {"vertex_values": rows, "steering_channels": 3}
    bpy.data.meshes.remove(mesh)
    return complete_points(scenes.positions(ob.data), normals, **options)


def check_added(name, ob, before, result):
    n = len(before["positions"])
    lost = scenes.kept(before, scenes.snapshot(ob))
    check(f"{name}: what was there is as it was", not lost, lost)
    places = scenes.positions(ob.data)[n:]
    check(f"{name}: new coordinates", places.tobytes() == result.new_points.tobytes(), len(places))
    check(f"{name}: there are some, and no faces", len(places) > 20 and not len(ob.data.polygons))
    return places


def column(ob, name, field, width, dtype=np.float32):
    return scenes.get(ob.data.attributes[name].data, field, width, dtype)


def test_points():
    ob = cloud()
    before = scenes.snapshot(ob)
    result = expected(ob)
    check("points", fill() == {"FINISHED"})
    places = check_added("points", ob, before, result)
    n = len(before["positions"])
    off = np.abs(places[:, 2] - height(places[:, 0])).max()
    check("on the relief", off < 0.1, off)
    near = [np.hypot(places[:, 0] - x, places[:, 1] - y) < r for (x, y), r in zip(CENTRES, RADII)]
    check("in both holes and nowhere else", near[0].any() and near[1].any() and (near[0] | near[1]).all())
    selected = scenes.get(ob.data.vertices, "select", 1, bool)[:, 0]
    check("new points, and they alone, are selected", selected[n:].all() and not selected[:n].any())
    check_carried(ob, result, places, n)


def check_carried(ob, result, places, n):
    x = places[:, 0]
    shade = np.stack([x / 41, 1 - x / 41, 0 * x + 0.25, 0 * x + 1], 1)
    for name in ("paint", "bytes"):
        off = np.abs(column(ob, name, "color", 4)[n:] - shade).max()
        check(f"{name} goes on", off < 0.05, off)
    off = np.abs(column(ob, "own", "value", 1)[n:, 0] - x).max()
    check("numbers go on", off < 1.5, off)
    labels = column(ob, "label", "value", 1, np.int32)[n:, 0]
    check("labels are those of the rim", np.array_equal(labels, (x > 20) + 5))
    weights = scenes.weights(ob)[n:, 0]
    check("weights are those of the rim", np.array_equal(weights, np.where(x > 20, 0.75, -1)))
    if "normal" in ob.data.attributes:
        normals = column(ob, "normal", "vector", 3)[n:]
        check("normals", np.array_equal(normals, result.new_normals.astype(np.float32)))
        check("on the side of those given", normals[:, 2].max() < -0.9)
    completed = column(ob, "completed", "value", 1, np.int32)[:, 0]
    check("completed", not completed[:n].any() and (completed[n:] == 1).all())
    source = column(ob, "completion_source", "value", 1, np.int32)[:, 0]
    check("completion_source", (source[:n] == -1).all() and np.array_equal(source[n:], result.new_point_source_points))
    confidence = column(ob, "completion_confidence", "value", 1)[n:, 0]
    check("completion_confidence", np.array_equal(confidence, result.new_point_confidences.astype(np.float32)))


def test_plain_points():
    """Without attributes and without ours; smooth."""
    ob = cloud(rich=False)
    before = scenes.snapshot(ob)
    result = expected(ob, method="smooth")
    check("plain points", fill(method="SMOOTH", write_attributes=False) == {"FINISHED"})
    check_added("plain points", ob, before, result)
    check("no attribute came", "completed" not in ob.data.attributes)


def test_points_in_edit_mode():
    """The hole that a selected point of its rim chooses; the border if it is touched is another story."""
    ob = cloud()
    before = scenes.snapshot(ob)
    holes = list_holes(scenes.positions(ob.data))
    hole = min(holes, key=lambda h: np.linalg.norm(h.centre[:2] - CENTRES[1]))
    result = expected(ob, selection="ids", selection_ids=[hole.id])
    edit("VERT")
    select_vertices(ob, [int(hole.loops[0][3])])
    check("points in edit mode", fill() == {"FINISHED"})
    chosen = selected_vertices(ob)
    leave()
    places = check_added("points in edit mode", ob, before, result)
    n = len(before["positions"])
    check("new points are selected", chosen == list(range(n, n + len(places))))
    inside = np.hypot(places[:, 0] - CENTRES[1][0], places[:, 1] - CENTRES[1][1]) < RADII[1]
    check("in that hole alone", inside.all())


def test_points_max_size():
    ob = cloud(rich=False)
    before = scenes.snapshot(ob)
    sizes = sorted(h.edge_count for h in list_holes(scenes.positions(ob.data)) if not h.is_border)
    result = expected(ob, selection="max_edges", selection_max_edges=sizes[0])
    check("the smaller hole", fill(max_edges=sizes[0]) == {"FINISHED"})
    check_added("the smaller hole", ob, before, result)


def test_points_without_holes():
    j, i = np.divmod(np.arange(400), 20)
    flat = np.stack([i + 0.5 * (j % 2), j * np.sqrt(0.75), height(i)], axis=1)
    for what, vertices, edges in (
        ("no holes", flat, []),
        ("two points", flat[:2], []),
        ("edges without faces", flat, [(k, k + 1) for k in range(19)]),
    ):
        ob = scenes.add(vertices, [])
        if edges:
            bm = bmesh.new()
            bm.from_mesh(ob.data)
            bm.verts.ensure_lookup_table()
            for a, b in edges:
                bm.edges.new((bm.verts[a], bm.verts[b]))
            bm.to_mesh(ob.data)
            bm.free()
        before = scenes.snapshot(ob)
        try:
            state = fill()
        except RuntimeError:  # an error in words
            state = {"CANCELLED"}
        check(what, state == {"CANCELLED"})
        check(f"{what}: as it was", scenes.same(before, scenes.snapshot(ob)))


def test_points_from_faces():
    ob = cloud(rich=False)
    ob.vertex_groups.new(name="group").add(list(range(99)), 1.0, "REPLACE")
    check("points have no faces", fill(source="GROUP", source_group="group") == {"CANCELLED"})
