"""What a fill may be copied from."""

import bpy
import numpy as np
import scenes
from checks import check
from test_fill import check_added, fill, reference


def sources(ob, first):
    return scenes.get(ob.data.attributes["completion_source"].data, "value", 1, np.int32)[first:, 0]


def test_vertex_group():
    ob = scenes.column()
    group = ob.vertex_groups.new(name="low")
    low = scenes.positions(ob.data)[:, 2] < 0
    group.add(np.flatnonzero(low).tolist(), 0.5, "REPLACE")
    before = scenes.snapshot(ob)
    faces, polygons = scenes.triangles(ob.data)
    allowed = low[faces].all(axis=1)
    result, _ = reference(ob, source_faces=allowed)
    check("from a group", fill(source="GROUP", source_group="low") == {"FINISHED"})
    check_added("from a group", ob, before, result)
    came = sources(ob, len(before["positions"]))
    check("from a group: from there", np.isin(came[came >= 0], polygons[allowed]).all() and (came >= 0).any())


def test_another_object():
    """A twin of twice the coordinates and half the scale, turned and elsewhere."""
    vertices, polygons = scenes.column_data(windows=())
    ob = scenes.column()
    twin = bpy.data.meshes.new("twin")
    twin.from_pydata((2 * vertices).tolist(), [], polygons)
    other = bpy.data.objects.new("twin", twin)
    other.scale, other.location, other.rotation_euler = (0.5,) * 3, (5, 0, 1), (0.3, 0.2, 0.1)
    bpy.context.collection.objects.link(other)
    bpy.context.view_layer.update()
    before, faces = scenes.snapshot(ob), scenes.triangles(twin)
    places = scenes.positions(twin) @ np.array(other.matrix_world)[:3, :3].T
    places += np.array(other.matrix_world)[:3, 3]
    exemplar = {"exemplar_vertices": places.astype(np.float32), "exemplar_faces": faces[0]}
    result, _ = reference(ob, exemplar_only=True, **exemplar)
    check("from another object", fill(source="OBJECT", source_object="twin") == {"FINISHED"})
    check_added("from another object", ob, before, result)
    came = sources(ob, len(before["positions"]))
    old = len(before["polygon sizes"])
    has = came >= 0
    expected = faces[1][result.new_vertex_source_faces[has] - result.input_face_count] + old
    check("from another object: from there", has.mean() > 0.9 and np.array_equal(came[has], expected))


def test_no_mirroring():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    result, _ = reference(ob, unmirrored=True)
    fill(mirror=False)
    check_added("not mirrored", ob, before, result)


def test_no_source():
    ob = scenes.column()
    ob.vertex_groups.new(name="nobody")
    before = scenes.snapshot(ob)
    for options in (
        {"source": "GROUP"},
        {"source": "GROUP", "source_group": "missing"},
        {"source": "GROUP", "source_group": "nobody"},
        {"source": "OBJECT"},
        {"source": "OBJECT", "source_object": "thing"},
    ):
        check(f"{options}", fill(**options) == {"CANCELLED"})
    check("no source: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
