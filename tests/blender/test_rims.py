"""Loose rims, missing parts, a fill to start from, sources with exceptions, another object beside the mesh."""

import bmesh
import bpy
import numpy as np
import scenes
from checks import check
from mathutils import Matrix
from test_edit import edit, leave, rims, select_vertices
from test_fill import check_added, fill, reference
from test_guidance import new_places, off_column, turned, whole
from test_sources import patch, select_faces, sources


def group(ob, name, vertices):
    ob.vertex_groups.new(name=name).add([int(v) for v in vertices], 1.0, "REPLACE")


def fold():
    """Two planes at right angles, the fold at x = 20, a hole in the first that ends at the fold; and the rim
    vertices there."""
    at, vertices, polygons = {}, [], []
    for j in range(32):
        for i in range(40):
            if 10 <= i < 20 and 10 <= j < 20:
                continue
            corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            for x, y in corners:
                if (x, y) not in at:
                    at[x, y] = len(vertices)
                    vertices.append((min(x, 20), y, max(x - 20, 0)))
            polygons.append([at[c] for c in corners])
    return scenes.add(vertices, polygons), [at[20, y] for y in range(10, 21)]


def inner(ob):
    """A vertex on no rim."""
    return int(np.flatnonzero((scenes.positions(ob.data) == (3, 3, 0)).all(axis=1))[0])


def test_loose_rim():
    """Beyond the fold is another plane, which pulls the fill up; not where the fold is loose."""
    highest = {}
    for loose in (False, True):
        for mode in ("OBJECT", "EDIT"):
            ob, on_fold = fold()
            # What else is in the group is not heeded.
            group(ob, "fold", [*on_fold, inner(ob)])
            before = scenes.snapshot(ob)
            name = f"loose rim {loose} {mode}"
            asked = {"loose_vertices": on_fold} if loose else {}
            result, _ = reference(ob, method="smooth", selection="near_vertices", selection_ids=on_fold[4:5], **asked)
            options = {"method": "SMOOTH", "loose_group": "fold" if loose else ""}
            if mode == "EDIT":
                edit("VERT")
                select_vertices(ob, on_fold[4:5])
            else:
                options["keep_largest_open"] = True
            check(name, fill(**options) == {"FINISHED"})
            if mode == "EDIT":
                leave()
            check_added(name, ob, before, result)
            highest[loose] = np.abs(new_places(ob, before)[:, 2]).max()
    check("a fill ends at a loose fold in its own plane", highest[True] < 1e-3, highest)
    check("and is pulled up without", highest[False] > 0.3, highest)


def test_missing_part():
    """A column without its top gets that of its twin, vertex for vertex; a fill without it stays below."""
    vertices, polygons = scenes.column_data(windows=())
    left = [p for p in polygons if max(vertices[p, 2]) < 0.6]
    used, inverse = np.unique(np.concatenate([np.array(p) for p in left]), return_inverse=True)
    numbers = iter(inverse.reshape(-1).tolist())
    left = [[next(numbers) for _ in p] for p in left]
    own = {}
    for part in (False, True):
        ob = scenes.add(vertices[used], left)
        before = scenes.snapshot(ob)
        twin = whole("twin", Matrix())
        faces, _ = scenes.triangles(twin.data)
        result, _ = reference(
            ob, exemplar_vertices=scenes.positions(twin.data), exemplar_faces=faces, exemplar_only=True,
            vertex_values=None, placement=np.eye(3, 4), refine=False, part=part,
        )
        name = f"part {part}"
        check(name, fill(source="OBJECT", source_object="twin", place="STAND", part=part) == {"FINISHED"})
        check_added(name, ob, before, result)
        new = new_places(ob, before)
        lost = vertices[vertices[:, 2] > 0.65]
        near = np.array([np.linalg.norm(new - p, axis=1).min() for p in lost])
        own[part] = (near < 1e-6).mean()
        if part:
            check("part: the twin's vertices are there", own[part] > 0.97 and len(lost) > 500, (near.max(), own[part]))
            check("part: on the column", off_column(new).max() < 0.01, off_column(new).max())
            check("part: up to the top", abs(new[:, 2].max() - 1.5) < 1e-6, new[:, 2].max())
    check("a fill has vertices of its own", own[False] < 0.1, own)


def with_tents(ob, height):
    """A duplicate that stands elsewhere, whose holes are closed by a vertex each, so far from the axis."""
    mesh = ob.data.copy()
    bm = bmesh.new()
    bm.from_mesh(mesh)
    old, tops = bm.verts[:], []
    for rim in rims(ob):
        corners = [old[v] for v in rim]
        middle = sum((v.co for v in corners[1:]), corners[0].co.copy()) / len(corners)
        middle.xy *= height / middle.xy.length
        tops.append(middle.copy())
        top = bm.verts.new(middle)
        for a, b in zip(corners, corners[1:] + corners[:1]):
            bm.faces.new((a, b, top))
    bm.to_mesh(mesh)
    bm.free()
    other = bpy.data.objects.new("tents", mesh)
    other.matrix_world = turned(3.0, False, (5, 6, 7))
    bpy.context.collection.objects.link(other)
    return np.float32(tops)


def test_start_from():
    """What another object adds comes back to the bit where the fill is smooth, and is where a coherent one
    starts from."""
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.column()
        tops = with_tents(ob, 1.2)
        before = scenes.snapshot(ob)
        if mode == "EDIT":
            edit()
        check(f"start from, {mode}", fill(method="SMOOTH", initial_object="tents") == {"FINISHED"})
        if mode == "EDIT":
            leave()
        lost = scenes.kept(before, scenes.snapshot(ob))
        check(f"start from, {mode}: what was there is as it was", not lost, lost)
        new = new_places(ob, before)
        check(f"start from, {mode}: the tents", sorted(map(tuple, new)) == sorted(map(tuple, tops)), new)
    ob = scenes.column(rich=False)
    before = scenes.snapshot(ob)
    tops = with_tents(ob, 1.2)
    n, m = len(before["positions"]), len(before["polygon sizes"])
    faces, polygons = scenes.triangles(bpy.data.objects["tents"].data)
    start = {"initial_vertices": tops, "initial_faces": faces[polygons >= m]}
    check("the tents' vertices are the last", faces.max() == n + len(tops) - 1)
    result, _ = reference(ob, **start)
    free, _ = reference(ob)
    check("a coherent fill from a start", fill(initial_object="tents") == {"FINISHED"})
    check_added("a coherent fill from a start", ob, before, result)
    check("and is another", result.new_vertices.tobytes() != free.new_vertices.tobytes())


def test_start_from_something_else():
    """A mesh that is not this one and more is refused, and so is one that adds nothing."""
    for change in ("moved", "none", "turned", "fewer"):
        ob = scenes.column(rich=False)
        before = scenes.snapshot(ob)
        with_tents(ob, 1.2)
        other = bpy.data.objects["tents"]
        if change == "moved":
            other.data.vertices[3].co.x += 1e-3
        elif change == "none":
            other.data = ob.data.copy()
        elif change == "turned":
            other.data.flip_normals()
        else:
            bm = bmesh.new()
            bm.from_mesh(other.data)
            bm.faces.ensure_lookup_table()
            bmesh.ops.delete(bm, geom=[bm.faces[0]], context="FACES_ONLY")
            bm.to_mesh(other.data)
            bm.free()
        check(f"start from a mesh {change}", fill(initial_object="tents") == {"CANCELLED"})
        check(f"start from a mesh {change}: as it was", scenes.same(before, scenes.snapshot(ob)))


def test_all_but_a_group():
    """Lettering, or damage, that is not to be copied."""
    ob = scenes.column()
    low = np.flatnonzero(scenes.positions(ob.data)[:, 2] < 0)
    group(ob, "low", low)
    before = scenes.snapshot(ob)
    faces, polygons = scenes.triangles(ob.data)
    forbidden = np.isin(faces, low).all(axis=1)
    result, _ = reference(ob, source_faces=~forbidden)
    check("all but a group", fill(source="GROUP", source_group="low", source_inverted=True) == {"FINISHED"})
    check_added("all but a group", ob, before, result)
    came = sources(ob, len(before["positions"]))
    none = not np.isin(came[came >= 0], polygons[forbidden]).any()
    check("all but a group: nothing from there", none and (came >= 0).mean() > 0.5)


def test_all_but_the_selected():
    ob = scenes.column()
    chosen = patch(ob, far_from_rims=True)
    before = scenes.snapshot(ob)
    faces, polygons = scenes.triangles(ob.data)
    result, _ = reference(ob, source_faces=~chosen[polygons])
    edit()
    select_faces(ob, chosen)
    check("all but the selected", fill(source="SELECTED", source_inverted=True) == {"FINISHED"})
    leave()
    check_added("all but the selected", ob, before, result)
    came = sources(ob, len(before["positions"]))
    check("all but the selected: nothing from there", not chosen[came[came >= 0]].any() and (came >= 0).any())


def test_object_and_mesh():
    """Of an object without flutes comes nothing if the mesh itself serves, too; alone it is all there is."""
    off, of_mesh = {}, {}
    for beside in (False, True):
        ob = scenes.column(rich=False)
        before = scenes.snapshot(ob)
        flutes, scenes.FLUTES = scenes.FLUTES, 7
        try:
            other = whole("other", turned(1.0, False, (9, 2, 1)))
        finally:
            scenes.FLUTES = flutes
        faces, _ = scenes.triangles(other.data)
        matrix = np.array(ob.matrix_world.inverted_safe() @ other.matrix_world)
        places = (scenes.positions(other.data) @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
        result, _ = reference(
            ob, exemplar_vertices=places, exemplar_faces=faces, exemplar_only=not beside, vertex_values=None
        )
        name = f"object beside the mesh {beside}"
        check(name, fill(source="OBJECT", source_object="other", source_and_mesh=beside) == {"FINISHED"})
        check_added(name, ob, before, result)
        off[beside] = off_column(new_places(ob, before)).max()
        came = sources(ob, len(before["positions"]))
        of_mesh[beside] = ((came >= 0) & (came < len(before["polygon sizes"]))).mean()
    check("alone nothing is of the mesh", of_mesh[False] == 0, of_mesh)
    check("beside it nearly all", of_mesh[True] > 0.9 and off[True] < 1e-4 < off[False], (of_mesh, off))


def test_colours_of_the_mesh_beside_an_object():
    """The object has no attribute: colours come from the mesh where the shape does, not from the rim."""
    ob = scenes.column()
    before = scenes.snapshot(ob)
    other = whole("other", turned(1.0, False, (9, 2, 1)))
    faces, _ = scenes.triangles(other.data)
    matrix = np.array(ob.matrix_world.inverted_safe() @ other.matrix_world)
    places = (scenes.positions(other.data) @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    result, _ = reference(ob, exemplar_vertices=places, exemplar_faces=faces)
    check("beside an object", fill(source="OBJECT", source_object="other", source_and_mesh=True) == {"FINISHED"})
    check_added("beside an object", ob, before, result)
    _, names = scenes.values(ob.data)
    first = [name for name, _ in names].index("point")
    first = sum(width for _, width in names[:first])
    colours = scenes.get(ob.data.attributes["point"].data, "color", 4, np.float32)[len(before["positions"]) :]
    off = np.abs(colours - result.new_vertex_values[:, first : first + 4]).max()
    check("beside an object: colours as the library has them", off < 1e-6, off)


def test_rims_refused():
    ob = scenes.column()
    ob.vertex_groups.new(name="nobody")
    group(ob, "all of them", range(len(ob.data.vertices)))
    group(ob, "inside", set(range(len(ob.data.vertices))) - set(sum(rims(ob), [])))
    before = scenes.snapshot(ob)
    for options in (
        {"loose_group": "missing"},
        {"loose_group": "nobody"},
        {"loose_group": "inside"},
        {"initial_object": "missing"},
        {"initial_object": "thing"},
        {"source": "GROUP", "source_group": "all of them", "source_inverted": True},
    ):
        check(f"{options}", fill(**options) == {"CANCELLED"})
    check("refused: the mesh is as it was", scenes.same(before, scenes.snapshot(ob)))
    cloud = scenes.add(scenes.column_data()[0], [])
    group(cloud, "group", [1, 2])
    for options in ({"loose_group": "group"}, {"part": True}):
        check(f"a cloud: {options}", fill(**options) == {"CANCELLED"})
    properties = bpy.ops.mesh.fill_hole_coherently.get_rna_type().properties
    for name in ("part", "loose_group", "initial_object", "source_inverted", "source_and_mesh"):
        check(f"{name} is not remembered", properties[name].is_skip_save)
