"""What a mesh carries goes on with the shape: colours, numbers, texture coordinates; against the command
line's files, which tests/blender/run makes, and the library's own values."""

import os
import sys

import bpy
import numpy as np
import scenes
from checks import check
from mathutils.bvhtree import BVHTree
from test_edit import edit, leave
from test_fill import check_added, fill, reference

FILES = os.environ["COMPLETE_MESH_FILES"]
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from ply import Mesh  # noqa: E402

KINDS = [(kind, domain) for kind in ("BYTE_COLOR", "FLOAT_COLOR") for domain in ("POINT", "CORNER")]


def at_elements(mesh, rows, domain):
    if domain == "POINT":
        return rows
    return rows[scenes.get(mesh.loops, "vertex_index", 1, np.int32)[:, 0]]


def set_srgb(mesh, attribute, colours):
    """Colours of the vertices, of 255, as a file has them."""
    rgba = np.column_stack([colours, np.full(len(colours), 255)]) / 255
    if attribute.data_type == "BYTE_COLOR":
        low, high = rgba[:, :3] / 12.92, ((rgba[:, :3] + 0.055) / 1.055) ** 2.4
        rgba[:, :3] = np.where(rgba[:, :3] < 0.04045, low, high)
    attribute.data.foreach_set("color", at_elements(mesh, rgba, attribute.domain).astype(np.float32).ravel())


def painted(kind, domain):
    """The painted vessel with a hole, and the command line's fill of it."""
    broken, whole = Mesh(f"{FILES}/painted.ply"), Mesh(f"{FILES}/painted-whole.ply")
    ob = scenes.add(broken.points, broken.faces)
    attribute = ob.data.color_attributes.new(name="Col", type=kind, domain=domain)
    set_srgb(ob.data, attribute, np.array(broken.colours))
    ob.data.color_attributes.active_color = attribute
    return ob, whole


def new_corners(mesh, first):
    return scenes.get(mesh.loops, "vertex_index", 1, np.int32)[first:, 0]


def colours_of(ob):
    """(corners or vertices, 3), of 255 as stored."""
    attribute = ob.data.color_attributes["Col"]
    rows = scenes.get(attribute.data, "color", 4, np.float32)[:, :3].astype(float)
    if attribute.data_type == "BYTE_COLOR":
        rows = np.where(rows < 0.0031308, 12.92 * rows, 1.055 * rows ** (1 / 2.4) - 0.055)
    return 255 * rows


def check_painted(name, ob, before, whole, kind, domain):
    """Coordinates and colours are those of the command line's file."""
    n, corners = len(before["positions"]), len(before["corners"])
    lost = scenes.kept(before, scenes.snapshot(ob))
    check(f"{name}: what was there is as it was", not lost, lost)
    places, expected = scenes.positions(ob.data), np.array(whole.points, np.float32)
    if kind == "BYTE_COLOR":  # the very numbers that the file has
        check(f"{name}: coordinates of the command line", places.tobytes() == expected.tobytes())
    else:
        off = np.abs(places - expected).max() if len(places) == len(expected) else np.inf
        check(f"{name}: coordinates of the command line", off < 1e-3, off)
    got = colours_of(ob)[n if domain == "POINT" else corners :]
    at = np.arange(n, len(places)) if domain == "POINT" else new_corners(ob.data, corners)
    off = np.abs(got - np.array(whole.colours)[at]).max() if len(got) else np.inf
    check(f"{name}: colours of the command line", off <= 1.01, off)


def test_colours_go_on():
    for kind, domain in KINDS:
        for mode in ("OBJECT", "EDIT"):
            ob, whole = painted(kind, domain)
            before = scenes.snapshot(ob)
            if mode == "EDIT":
                edit()
            fill()
            leave()
            check_painted(f"{kind} {domain} {mode}", ob, before, whole, kind, domain)


def test_the_rim_has_other_colours():
    """Or the comparison would tell nothing."""
    ob, whole = painted("BYTE_COLOR", "POINT")
    n = len(ob.data.vertices)
    fill(method="SMOOTH")
    smooth, truth = colours_of(ob)[n:], np.array(whole.colours)[n:]
    check("colours from the rim have less contrast", smooth.std(0).max() < 0.8 * truth.std(0).max())


def test_colours_do_not_steer_if_not_asked():
    ob, whole = painted("BYTE_COLOR", "POINT")
    before = scenes.snapshot(ob)
    result, _ = reference(ob, steering=0)
    fill(match_colors=False)
    check_added("colours do not steer", ob, before, result)
    same = np.array_equal(result.new_vertices, np.array(whole.points, np.float32)[len(before["positions"]) :])
    check("colours that steer make another fill", not same)


def test_all_kinds_of_numbers():
    """Each attribute has the library's own numbers."""
    ob = scenes.column(rich=False)
    mesh, random = ob.data, np.random.default_rng(4)
    places = scenes.positions(mesh)
    for kind, domain in KINDS:
        made = mesh.color_attributes.new(name=f"{kind} {domain}", type=kind, domain=domain)
        rows = 0.5 + 0.2 * np.sin(places @ random.normal(size=(3, 4)) * 2)
        made.data.foreach_set("color", at_elements(mesh, rows, domain).astype(np.float32).ravel())
    for domain in ("POINT", "CORNER"):
        for kind, field, width in (("FLOAT", "value", 1), ("FLOAT_VECTOR", "vector", 3)):
            made = mesh.attributes.new(name=f"{kind} {domain}", type=kind, domain=domain)
            rows = np.cos(places @ random.normal(size=(3, width)) * 2)
            made.data.foreach_set(field, at_elements(mesh, rows, domain).astype(np.float32).ravel())
    before = scenes.snapshot(ob)
    result, _ = reference(ob)
    _, names = scenes.values(mesh)
    check("all kinds are there", len(names) == 8, names)
    fill()
    check_added("all kinds of numbers", ob, before, result)
    n, corners, first = len(places), len(before["corners"]), 0
    for name, width in names:
        expected = result.new_vertex_values[:, first : first + width]
        first += width
        attribute = ob.data.attributes[name]
        got = scenes.get(attribute.data, *scenes.FIELDS[attribute.data_type]).astype(float)
        if attribute.data_type == "BYTE_COLOR":
            low, high = 12.92 * got, 1.055 * got ** (1 / 2.4) - 0.055
            got = 255 * np.column_stack([np.where(got < 0.0031308, low, high)[:, :3], got[:, 3]])
        if attribute.domain == "CORNER":
            at = new_corners(ob.data, corners) - n
            got, expected = got[corners:][at >= 0], expected[at[at >= 0]]
        else:
            got = got[n:]
        off = np.abs(got - expected).max()
        check(f"{name} is the library's", off < (0.51 if "BYTE" in name else 1e-5), off)


def test_labels_stay_labels():
    """Integers, truths and words of the nearest place at the rim; never something between."""
    ob = scenes.column()
    mesh = ob.data
    n, m = len(mesh.vertices), len(mesh.polygons)
    labels = np.where(scenes.positions(mesh)[:, 2] > 0, 7, 3).astype(np.int32)
    mesh.attributes.new(name="label", type="INT", domain="POINT").data.foreach_set("value", labels)
    fill()
    mesh = ob.data
    height = scenes.positions(mesh)[n:, 2]
    got = scenes.get(mesh.attributes["label"].data, "value", 1, np.int32)[n:, 0]
    check("labels of vertices", np.array_equal(got, np.where(height > 0, 7, 3)))
    own = scenes.get(mesh.attributes["own"].data, "value", 1, np.int32)[:, 0]
    sides = {}
    for polygon in mesh.polygons[:m]:
        for a, b in polygon.edge_keys:
            sides.setdefault((a, b), set()).add(own[polygon.index])
    at_rim = [(p, set().union(*(sides.get(key, set()) for key in p.edge_keys))) for p in mesh.polygons[m:]]
    joined = [(p, beside) for p, beside in at_rim if beside]
    check("labels of faces at the rim", joined and all(own[p.index] in beside for p, beside in joined))
    known = set().union(*(beside for _, beside in joined))
    check("labels of faces inside", all(own[p.index] in known for p, _ in at_rim))


def test_weights_still_sum_to_one():
    ob = scenes.column(rich=False)
    n, height = len(ob.data.vertices), (scenes.positions(ob.data)[:, 2] + 1.5) / 3
    for name, weights in (("upper", height), ("lower", 1 - height)):
        group = ob.vertex_groups.new(name=name)
        for i, weight in enumerate(weights.tolist()):
            group.add([i], weight, "REPLACE")
    fill()
    off = np.abs(scenes.weights(ob)[n:].sum(axis=1) - 1).max()
    check("weights still sum to 1", off < 1e-4, off)


def twin(vertices, polygons, colours):
    mesh = bpy.data.meshes.new("twin")
    mesh.from_pydata(vertices, [], polygons)
    attribute = mesh.color_attributes.new(name="Col", type="FLOAT_COLOR", domain="CORNER")
    shown = np.column_stack([colours, np.full(len(colours), 255.0)]) / 255
    shown[:, :3] = np.where(shown[:, :3] < 0.04045, shown[:, :3] / 12.92, ((shown[:, :3] + 0.055) / 1.055) ** 2.4)
    attribute.data.foreach_set("color", at_elements(mesh, shown, "CORNER").astype(np.float32).ravel())
    other = bpy.data.objects.new("twin", mesh)
    bpy.context.collection.objects.link(other)
    return other


def test_another_object_gives_its_colours():
    """An intact twin, whose colours are floats of its corners: ours are bytes."""
    ob, _ = painted("BYTE_COLOR", "POINT")
    intact = Mesh(f"{FILES}/painted-intact.ply")
    other = twin([list(p) for p in intact.points], [list(f) for f in intact.faces], np.array(intact.colours))
    bpy.context.view_layer.update()
    before = scenes.snapshot(ob)
    n = len(before["positions"])
    rgba = np.column_stack([np.array(intact.colours, float), np.full(len(intact.points), 255.0)])
    result, _ = reference(
        ob,
        exemplar_vertices=scenes.positions(other.data),
        exemplar_faces=scenes.triangles(other.data)[0],
        exemplar_only=True,
        exemplar_values=rgba,
    )
    fill(source="OBJECT", source_object="twin")
    check_added("a painted twin", ob, before, result)
    off = np.abs(colours_of(ob)[n:] - result.new_vertex_values[:, :3]).max()
    check("a painted twin gives its colours", off < 0.51, off)
    off = np.abs(colours_of(ob)[n:] - colours_at(scenes.positions(ob.data)[n:], intact)).mean()
    check("they are those of the place", off < 3, off)


def colours_at(places, intact):
    """What is painted on a mesh nearest to some places."""
    tree = BVHTree.FromPolygons([list(p) for p in intact.points], [list(f) for f in intact.faces])
    rows = []
    for place in places.tolist():
        foot, _, face, _ = tree.find_nearest(place)
        corners = [np.array(intact.points[v]) for v in intact.faces[face]]
        weights = np.linalg.lstsq(np.vstack([np.array(corners).T, np.ones(3)]), [*foot, 1.0], rcond=None)[0]
        rows.append(weights @ [intact.colours[v] for v in intact.faces[face]])
    return np.array(rows)


# ---- texture coordinates ----------------------------------------------------------------------


def read_obj(path):
    """Positions, and of each face its corners' vertices and texture coordinates (None without)."""
    places, rows, faces = [], [], []
    for line in open(path):
        words = line.split()
        if words[:1] == ["v"]:
            places.append([float(x) for x in words[1:4]])
        elif words[:1] == ["vt"]:
            rows.append([float(x) for x in words[1:3]])
        elif words[:1] == ["f"]:
            corners = [word.split("/") for word in words[1:]]
            uv = [rows[int(c[1]) - 1] for c in corners] if all(len(c) > 1 and c[1] for c in corners) else None
            faces.append(([int(c[0]) - 1 for c in corners], uv))
    return np.array(places), faces


def test_texture_goes_on():
    """As the command line has it for the same mesh in an OBJ file, in two charts that meet themselves."""
    places, faces = read_obj(f"{FILES}/textured.obj")
    _, whole = read_obj(f"{FILES}/textured-whole.obj")
    for mode in ("OBJECT", "EDIT"):
        ob = scenes.add(places, [face for face, _ in faces])
        rows = np.array([row for _, uv in faces for row in uv], np.float32)
        ob.data.uv_layers.new(name="UVMap").data.foreach_set("uv", rows.ravel())
        before = scenes.snapshot(ob)
        result, _ = reference(ob)
        if mode == "EDIT":
            edit()
        fill()
        leave()
        check_added(f"textured {mode}", ob, before, result)
        check_texture(mode, ob, result, rows, whole[len(faces) :])


def check_texture(mode, ob, result, rows, new):
    uv = scenes.get(ob.data.uv_layers[0].data, "uv", 2, np.float32)[len(rows) :].reshape(-1, 3, 2)
    n = len(ob.data.vertices) - len(result.new_vertex_sources)
    check(f"texture {mode}: as many faces", len(new) == len(uv) and len(uv) > 100)
    source = np.concatenate([np.full(n, -1), result.new_vertex_sources])
    inner, edge_of = [], np.ptp(rows.reshape(-1, 3, 2), axis=1).max()
    meeting, rim = [], []
    for got, (face, expected) in zip(uv, new):
        if expected is None or all(v < n for v in face):
            continue
        off = np.abs(got - np.array(expected)).max()
        own = {int(source[v]) for v in face}
        lists = (rim, inner, meeting)
        lists[0 if -1 in own else min(len(own), 2)].append(off)
    check(f"texture {mode}: the command line's", len(inner) > 50 and np.median(inner) < 1e-5, np.median(inner))
    far = np.mean(np.array(inner) > 1e-4)
    check(f"texture {mode}: but where sources meet", far < 0.02, far)
    # Those are few: an eighth, from two sources.
    check(f"texture {mode}: most have one source", len(meeting) < 0.2 * len(inner), (len(meeting), len(inner)))
    near = np.mean(np.array(rim) < edge_of)
    check(f"texture {mode}: at the rim, too", len(rim) > 20 and near > 0.9, near)
    # A face lies in one chart: no edge is longer than a face's own elsewhere, but for what is stretched.
    longest = np.linalg.norm(uv - np.roll(uv, 1, axis=1), axis=2).max()
    check(f"texture {mode}: no face runs across a chart", longest < 4 * edge_of, longest)


def test_another_material_has_another_image():
    """Where the source's face has another material its texture coordinates say nothing."""
    places, faces = read_obj(f"{FILES}/textured.obj")
    uvs = {}
    for same in (True, False):
        ob = scenes.add(places, [face for face, _ in faces])
        mesh = ob.data
        rows = np.array([row for _, uv in faces for row in uv], np.float32)
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", rows.ravel())
        for name in ("one", "two"):
            mesh.materials.append(bpy.data.materials.new(name))
        result, polygons = reference(ob)
        index = np.zeros(len(faces), np.int32)
        came = result.new_vertex_source_faces
        if not same:
            index[polygons[came[came >= 0]]] = 1
            for loop in result.holes[0].loops:
                index[[bool(set(face) & set(loop.tolist())) for face, _ in faces]] = 0
        mesh.polygons.foreach_set("material_index", index)
        fill()
        uvs[same] = scenes.get(ob.data.uv_layers[0].data, "uv", 2, np.float32)[len(rows) :]
    rim_low, rim_high = uvs[False].min(axis=0), uvs[False].max(axis=0)
    inside = ((uvs[True] > rim_low) & (uvs[True] < rim_high)).all(axis=1).mean()
    check("texture of another material is not taken", uvs[True].shape == uvs[False].shape and inside < 0.9, inside)
