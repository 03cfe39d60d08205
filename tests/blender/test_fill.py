"""Object Mode: what is added, and that nothing else changes."""

import bpy
import numpy as np
import scenes
from checks import check
from fill_hole_coherently.complete_mesh import complete_mesh


def fill(**options):
    return bpy.ops.mesh.fill_hole_coherently(**options)


def reference(ob, steering=3, **options):
    """What the library makes of the same mesh and what it carries, and the polygon of each triangle."""
    if ob.mode == "EDIT":
        ob.update_from_editmode()
    mesh = ob.data.copy()  # in Edit Mode a mesh's attributes are empty
    faces, polygons = scenes.triangles(mesh)
    rows, names = scenes.values(mesh)
    if rows is not None and "vertex_values" not in options:
        options |= {"vertex_values": rows, "steering_channels": steering if names[0][1] == 4 else 0}
    bpy.data.meshes.remove(mesh)
    return complete_mesh(scenes.positions(ob.data), faces, **options), polygons


def new_polygons(mesh, first):
    return np.array([tuple(polygon.vertices) for polygon in list(mesh.polygons)[first:]])


def check_added(name, ob, before, result):
    """Exactly the fill was added: coordinates and faces to the bit, the rest untouched."""
    mesh = ob.data
    n, m = len(before["positions"]), len(before["polygon sizes"])
    lost = scenes.kept(before, scenes.snapshot(ob))
    check(f"{name}: what was there is as it was", not lost, lost)
    places = scenes.positions(mesh)[n:]
    check(f"{name}: new coordinates", places.tobytes() == result.new_vertices.tobytes())
    faces = new_polygons(mesh, m)
    check(f"{name}: new faces", np.array_equal(faces, result.new_faces), faces.shape)
    check(f"{name}: there are some", len(faces) > 20)
    valid = mesh.copy()
    check(f"{name}: a valid mesh", not valid.validate(verbose=True))
    bpy.data.meshes.remove(valid)


def test_object_mode():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    result, polygons = reference(ob)
    check("object mode", fill() == {"FINISHED"})
    check_added("object mode", ob, before, result)
    n, m = len(before["positions"]), len(before["polygon sizes"])
    selected = scenes.get(ob.data.polygons, "select", 1, bool)[:, 0]
    check("new faces, and they alone, are selected", selected[m:].all() and not selected[:m].any())
    check_looks(ob, result, n, m)
    check_attributes(ob, result, polygons, n, m)


def check_looks(ob, result, n, m):
    mesh = ob.data
    upper = [hole.centre[2] > 0 for hole in result.holes]
    check("a hole above and one below", sorted(upper) == [False, True])
    of_face = np.array([upper[hole] for hole in result.new_face_holes])
    materials = scenes.get(mesh.polygons, "material_index", 1, np.int32)[m:, 0]
    check("material of the surroundings", np.array_equal(materials, of_face.astype(np.int32)))
    smooth = scenes.get(mesh.polygons, "use_smooth", 1, bool)[m:, 0]
    check("shading of the surroundings", np.array_equal(smooth, of_face))
    weights = scenes.weights(ob)[n:]
    check("weight that is 1 all around is 1", (weights[:, 0] == 1).all(), weights[:, 0].min())
    height = (scenes.positions(mesh)[n:, 2] + 1.5) / 3
    off = np.abs(weights[:, 1] - height).max()
    check("weight that grows with the height goes on", off < 0.03, off)
    raised = scenes.get(mesh.shape_keys.key_blocks["raised"].data, "co", 3, np.float32)[n:]
    off = np.abs(raised - (0, 0, 0.25) - scenes.positions(mesh)[n:]).max()
    check("shape key that raises all raises the fill", off < 1e-6, off)
    basis = scenes.get(mesh.shape_keys.key_blocks["Basis"].data, "co", 3, np.float32)
    check("basis is the mesh", basis.tobytes() == scenes.positions(mesh).tobytes())
    shaky = scenes.get(mesh.shape_keys.key_blocks["random"].data, "co", 3, np.float32)[n:]
    move = shaky - scenes.positions(mesh)[n:]
    check("shape key between those of the rim", -1e-6 < move.min() < move.max() < 0.0101 and move.std() > 0)


def check_attributes(ob, result, polygons, n, m):
    mesh = ob.data
    completed = scenes.get(mesh.attributes["completed"].data, "value", 1, np.int32)[:, 0]
    check("completed", not completed[:m].any() and (completed[m:] == 1).all() and len(completed) > m)
    source = scenes.get(mesh.attributes["completion_source"].data, "value", 1, np.int32)[:, 0]
    triangle = result.new_vertex_source_faces
    expected = np.where(triangle < 0, -1, polygons[triangle])
    check("completion_source", (source[:n] == -1).all() and np.array_equal(source[n:], expected))
    check("sources are polygons of the input", 0 <= source[n:].max() < m)
    confidence = scenes.get(mesh.attributes["completion_confidence"].data, "value", 1, np.float32)[:, 0]
    expected = result.new_vertex_confidences.astype(np.float32)
    check("completion_confidence", not confidence[:n].any() and np.array_equal(confidence[n:], expected))
    check("there is confidence", confidence[n:].min() > 0.5)
    domains = [mesh.attributes[name].domain for name in ("completed", "completion_source", "completion_confidence")]
    check("domains", domains == ["FACE", "POINT", "POINT"], domains)


def test_colours_and_uvs_run_on():
    """Plane gradients: what is spread over the fill must follow them."""
    ob = scenes.column(rich=False)
    mesh = ob.data
    places = scenes.positions(mesh)
    height = (places[:, 2] + 1.5) / 3
    colour = np.stack([height, 1 - height, height * 0 + 0.25, height * 0 + 1], 1)
    corners = scenes.get(mesh.loops, "vertex_index", 1, np.int32)[:, 0]
    for kind in ("FLOAT_COLOR", "BYTE_COLOR"):
        for domain, values in (("POINT", colour), ("CORNER", colour[corners])):
            made = mesh.color_attributes.new(name=f"{kind} {domain}", type=kind, domain=domain)
            made.data.foreach_set("color", values.astype(np.float32).ravel())
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", np.stack([height, 2 * height], 1)[corners].astype(np.float32).ravel())
    n, old_corners = len(places), len(corners)
    fill()
    mesh = ob.data
    height = (scenes.positions(mesh)[:, 2] + 1.5) / 3
    corner = scenes.get(mesh.loops, "vertex_index", 1, np.int32)[old_corners:, 0]
    for made in mesh.color_attributes:
        values = scenes.get(made.data, "color", 4, np.float32)
        point = made.domain == "POINT"
        values, at = (values[n:], height[n:]) if point else (values[old_corners:], height[corner])
        expected = np.stack([at, 1 - at, at * 0 + 0.25, at * 0 + 1], 1)
        off = np.abs(values - expected).max()
        check(f"{made.name} goes on", len(values) and off < 0.04, off)
    uv = scenes.get(mesh.uv_layers[0].data, "uv", 2, np.float32)[old_corners:]
    off = np.abs(uv - np.stack([height, 2 * height], 1)[corner]).max()
    check("texture coordinates go on", len(uv) and off < 0.06, off)


OPTIONS = [
    ({"method": "SMOOTH"}, {"method": "smooth"}),
    ({"density": 2.0}, {"sizing": "scaled", "sizing_value": 0.5}),
    ({"max_edges": 40}, {"selection": "max_edges", "selection_max_edges": 40}),
    ({"keep_largest_open": True}, {"selection": "all_but_largest"}),
    ({"join_loops": False}, {"grouping": "separate"}),
]


def test_options():
    sizes = set()
    for options, arguments in OPTIONS:
        ob = scenes.column(rich=False)
        before = scenes.snapshot(ob)
        result, _ = reference(ob, **arguments)
        check(f"{options}", fill(**options) == {"FINISHED"})
        check_added(f"{options}", ob, before, result)
        sizes.add(result.new_vertices.tobytes())
    check("options differ", len(sizes) >= 4, len(sizes))


def test_joined_loops():
    """A tube without its middle: one band, or two lids."""
    vertices, polygons = scenes.column_data(windows=())
    heights = [vertices[polygon][:, 2].mean() for polygon in polygons]
    polygons = [polygon for polygon, z in zip(polygons, heights) if abs(z) > 0.3]
    counts = {}
    for join in (True, False):
        ob = scenes.add(vertices, polygons)
        before = scenes.snapshot(ob)
        grouping = "automatic" if join else "separate"
        result, _ = reference(ob, grouping=grouping, method="smooth")
        fill(join_loops=join, method="SMOOTH")
        check_added(f"join loops {join}", ob, before, result)
        counts[join] = len(result.holes)
    check("a band is one hole, two lids are two", counts == {True: 1, False: 2}, counts)


def test_no_attributes():
    ob = scenes.column()
    before = scenes.snapshot(ob)
    result, _ = reference(ob)
    fill(write_attributes=False)
    check_added("no attributes", ob, before, result)
    names = {attribute.name for attribute in ob.data.attributes}
    check("no attribute is added", not any(name.startswith("complet") for name in names), names)


def test_object_transform_and_modifiers_do_not_matter():
    ob = scenes.column()
    ob.location, ob.scale = (5, 6, 7), (2, 2, 2)
    ob.modifiers.new("Subdivision", "SUBSURF")
    before = scenes.snapshot(ob)
    result, _ = reference(ob)
    fill()
    check_added("moved and subdivided", ob, before, result)
    check("modifier is kept", [modifier.type for modifier in ob.modifiers] == ["SUBSURF"])


def test_custom_normals():
    ob = scenes.column(rich=False)
    mesh = ob.data
    turned = np.random.default_rng(2).normal(size=(len(mesh.loops), 3))
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(turned.tolist())
    before, had = scenes.snapshot(ob), loop_normals(mesh)
    check("custom normals are set", mesh.has_custom_normals and np.abs(had - turned).max() < 0.02)
    result, _ = reference(ob)
    fill()
    check_added("custom normals", ob, before, result)
    # Stored in the frame of the corner, which the fill turns at the rim alone.
    inner = inner_corners(ob.data, len(before["corners"]), result)
    now = loop_normals(ob.data)[: len(had)]
    off = np.abs(now - had)[inner].max()
    check("custom normals away from the rim", ob.data.has_custom_normals and off < 1e-4, off)


def loop_normals(mesh):
    if hasattr(mesh, "calc_normals_split"):
        mesh.calc_normals_split()
    return scenes.get(mesh.loops, "normal", 3, np.float32)


def inner_corners(mesh, count, result):
    rim = np.unique(np.concatenate([loop for hole in result.holes for loop in hole.loops]))
    corners = scenes.get(mesh.loops, "vertex_index", 1, np.int32)[:count, 0]
    return ~np.isin(corners, rim)
