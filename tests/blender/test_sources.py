"""What a fill may be copied from."""

import bmesh
import bpy
import numpy as np
import scenes
from checks import check
from test_edit import edit, leave, rims, select_vertices
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


def select_faces(ob, wanted):
    bm = bmesh.from_edit_mesh(ob.data)
    for face in bm.faces:
        if wanted[face.index]:
            face.select_set(True)
    bmesh.update_edit_mesh(ob.data)


def patch(ob, far_from_rims):
    """Polygons on one side of the column: away from its holes, or from one hole on."""
    mesh = ob.data
    centres = scenes.get(mesh.polygons, "center", 3, np.float32)
    angle = np.arctan2(centres[:, 1], centres[:, 0]) % (2 * np.pi)
    low, high = (1.5, 2.9) if far_from_rims else (0.9, 2.9)
    return (angle > low) & (angle < high)


def check_selected(name, ob, before, chosen, **options):
    """A fill from the selected faces: the library's own from their triangles alone."""
    faces, polygons = scenes.triangles(ob.data)
    result, _ = reference(ob, source_faces=chosen[polygons], **options)
    free, _ = reference(ob, **options)
    check(f"{name}: finished", fill(source="SELECTED") == {"FINISHED"})
    leave()
    check_added(name, ob, before, result)
    came = sources(ob, len(before["positions"]))
    inside, found = chosen[came[came >= 0]].mean(), (came >= 0).mean()
    check(f"{name}: from there", inside == 1 and found > 0.5, (inside, found))
    free_came = free.new_vertex_source_faces
    free_came = polygons[free_came[free_came >= 0]]
    check(f"{name}: without it from elsewhere, too", not chosen[free_came].all())


def test_selected_faces_away_from_holes():
    """They touch no hole: all holes are filled from them."""
    ob = scenes.column()
    chosen = patch(ob, far_from_rims=True)
    rim = set(sum(rims(ob), []))
    check("the patch touches no hole", not any(rim & set(p.vertices) for p in ob.data.polygons if chosen[p.index]))
    before = scenes.snapshot(ob)
    edit()
    select_faces(ob, chosen)
    check_selected("from faces away from holes", ob, before, chosen)


def test_selected_faces_at_a_hole():
    """They touch one hole: that one is filled from them, the other stays."""
    ob = scenes.column()
    chosen = patch(ob, far_from_rims=False)
    at = [bool(set(rim) & set(sum((list(p.vertices) for p in ob.data.polygons if chosen[p.index]), []))) for rim in rims(ob)]
    check("the patch touches one hole", at.count(True) == 1, at)
    before = scenes.snapshot(ob)
    edit()
    select_faces(ob, chosen)
    check_selected("from faces at a hole", ob, before, chosen, selection="ids", selection_ids=[at.index(True)])


def test_selected_faces_and_a_rim_vertex():
    """A vertex of a rim beside them chooses the hole, without being a source."""
    ob = scenes.column()
    chosen = patch(ob, far_from_rims=True)
    rim = rims(ob)[1]
    before = scenes.snapshot(ob)
    edit("VERT")
    select_vertices(ob, rim[:1])
    select_faces(ob, chosen)
    check_selected("from faces, for a hole", ob, before, chosen, selection="ids", selection_ids=[1])


def test_source_is_not_remembered():
    """The next call may be for a mesh without the selection or the group."""
    properties = bpy.ops.mesh.fill_hole_coherently.get_rna_type().properties
    check("the source is not remembered", properties["source"].is_skip_save)


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
    # It has no colours: none are compared, and ours come from the rim.
    result, _ = reference(ob, exemplar_only=True, vertex_values=None, **exemplar)
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


def test_candidate():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    result, _ = reference(ob, candidate=2)
    fill(candidate=2)
    check_added("the second candidate", ob, before, result)


def test_no_source():
    ob = scenes.column()
    ob.vertex_groups.new(name="nobody")
    before = scenes.snapshot(ob)
    for options in (
        {"source": "GROUP"},
        {"source": "GROUP", "source_group": "missing"},
        {"source": "GROUP", "source_group": "nobody"},
        {"source": "SELECTED"},
        {"source": "OBJECT"},
        {"source": "OBJECT", "source_object": "thing"},
        {"source": "COLLECTION", "source_collection": "missing"},
        {"source": "COLLECTION", "source_collection": bpy.context.collection.name},
        {"place": "STAND"},
        {"place": "ALIGN", "place_object": "thing"},
        {"points_object": "missing"},
        {"points_object": "thing"},
    ):
        check(f"{options}", fill(**options) == {"CANCELLED"})
    check("no source: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
    edit()
    check("no face selected", fill(source="SELECTED") == {"CANCELLED"})
    leave()
    check("no face selected: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
