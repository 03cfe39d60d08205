"""Meshes of quads, n-gons and everything that an artist may have put on them; and what is in a mesh,
as arrays to compare."""

import bpy
import numpy as np
from mathutils import Color

AROUND, UP, FLUTES = 60, 48, 12
# Holes: angle, height and radius.
WINDOWS = ((0.8, 0.5, 0.45), (3.6, -0.6, 0.4))


def column_data(windows=WINDOWS):
    """A fluted column of quads, closed by two n-gons, with a hole at each window."""
    angle, height = np.meshgrid(np.arange(AROUND) * (2 * np.pi / AROUND), np.linspace(-1.5, 1.5, UP))
    radius = 1 + 0.05 * np.cos(FLUTES * angle)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], 2).reshape(-1, 3)
    at = np.arange(UP * AROUND).reshape(UP, AROUND)
    right = np.roll(at, -1, axis=1)
    quads = np.stack([at[:-1], right[:-1], right[1:], at[1:]], axis=2).reshape(-1, 4)
    middle = vertices[quads].mean(axis=1)
    for turn, z, size in windows:
        far = np.linalg.norm(middle - [np.cos(turn), np.sin(turn), z], axis=1) >= size
        quads, middle = quads[far], middle[far]
    lids = [at[0][::-1], at[-1]]
    used, inverse = np.unique(np.concatenate([quads.ravel(), *lids]), return_inverse=True)
    inverse = inverse.reshape(-1)
    polygons = inverse[: quads.size].reshape(-1, 4).tolist()
    polygons += [inverse[quads.size :][:AROUND].tolist(), inverse[quads.size :][AROUND:].tolist()]
    return vertices[used].astype(np.float32), polygons


def bow_tie_data():
    """A grid with two holes that touch in one vertex, and that vertex."""
    x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(81)], 1)
    cells = [(i, j) for j in range(8) for i in range(8) if (i, j) not in ((3, 3), (4, 4), (1, 6))]
    corner = [j * 9 + i for i, j in cells]
    return vertices, [[a, a + 1, a + 10, a + 9] for a in corner], 4 * 9 + 4


def clear():
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for ob in list(bpy.data.objects):
        bpy.data.objects.remove(ob)
    for mesh in list(bpy.data.meshes):
        bpy.data.meshes.remove(mesh)


def add(vertices, polygons):
    """A new active object in Object Mode, the only one."""
    clear()
    mesh = bpy.data.meshes.new("thing")
    mesh.from_pydata(np.asarray(vertices).tolist(), [], polygons)
    mesh.update()
    ob = bpy.data.objects.new("thing", mesh)
    bpy.context.collection.objects.link(ob)
    bpy.context.view_layer.objects.active = ob
    ob.select_set(True)
    return ob


def column(rich=True):
    ob = add(*column_data())
    if rich:
        enrich(ob)
    return ob


def enrich(ob):
    """UVs, colours of four kinds, materials, shading, groups, shape keys, seams, creases, and an
    attribute of the user's own, all of numbers that differ from element to element."""
    mesh, random = ob.data, np.random.default_rng(1)
    for name in ("UVMap", "Second"):
        layer = mesh.uv_layers.new(name=name)
        layer.data.foreach_set("uv", random.random(len(mesh.loops) * 2, np.float32))
    for name, kind, domain, count in (
        ("corner", "FLOAT_COLOR", "CORNER", len(mesh.loops)),
        ("corner byte", "BYTE_COLOR", "CORNER", len(mesh.loops)),
        ("point", "FLOAT_COLOR", "POINT", len(mesh.vertices)),
        ("point byte", "BYTE_COLOR", "POINT", len(mesh.vertices)),
    ):
        colours = mesh.color_attributes.new(name=name, type=kind, domain=domain)
        colours.data.foreach_set("color", random.random(count * 4, np.float32))
    own = mesh.attributes.new(name="own", type="INT", domain="FACE")
    own.data.foreach_set("value", np.arange(len(mesh.polygons), dtype=np.int32) * 7)
    for name in ("red", "green"):
        mesh.materials.append(bpy.data.materials.new(name))
    centres = np.empty(len(mesh.polygons) * 3, np.float32)
    mesh.polygons.foreach_get("center", centres)
    upper = centres.reshape(-1, 3)[:, 2] > 0
    mesh.polygons.foreach_set("material_index", upper.astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", upper)
    for edge in list(mesh.edges)[::3]:
        edge.use_seam = True
    for name, weight in (("all", lambda co: 1.0), ("height", lambda co: (co.z + 1.5) / 3)):
        group = ob.vertex_groups.new(name=name)
        for vertex in mesh.vertices:
            group.add([vertex.index], weight(vertex.co), "REPLACE")
    ob.shape_key_add(name="Basis")
    for name, move in (("raised", (0.0, 0.0, 0.25)), ("random", None)):
        key = ob.shape_key_add(name=name)
        places = positions(mesh) + (random.random((len(mesh.vertices), 3)) * 0.01 if move is None else move)
        key.data.foreach_set("co", places.astype(np.float32).ravel())
    mesh.update()


def positions(mesh):
    places = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", places)
    return places.reshape(-1, 3)


def triangles(mesh):
    """(m, 3) and the polygon of each, written down without foreach_get."""
    mesh.calc_loop_triangles()
    rows = [tuple(triangle.vertices) for triangle in mesh.loop_triangles]
    return np.array(rows, np.int32), np.array([t.polygon_index for t in mesh.loop_triangles])


def values(mesh):
    """What a mesh's attributes give the library: rows of the vertices, the active colour first, and
    (name, how many numbers) of each; written down without foreach_get. Bytes are 0 to 255, in sRGB."""
    columns, names = [], []
    active = mesh.color_attributes.active_color.name if mesh.color_attributes else None
    kinds = {"FLOAT": "value", "FLOAT_VECTOR": "vector", "FLOAT_COLOR": "color", "BYTE_COLOR": "color"}
    own = [a for a in mesh.attributes if a.data_type in kinds and a.domain in ("POINT", "CORNER")]
    own = [a for a in own if a.name != "position" and not a.name.startswith((".", "completion"))]
    for attribute in sorted(own, key=lambda a: ("COLOR" not in a.data_type, a.name != active)):
        rows = [getattr(element, kinds[attribute.data_type]) for element in attribute.data]
        rows = [[row] if isinstance(row, float) else list(row) for row in rows]
        if attribute.data_type == "BYTE_COLOR":
            shown = [[*Color(row[:3]).from_scene_linear_to_srgb(), row[3]] for row in rows]
            rows = [[float(round(255 * x)) for x in row] for row in shown]
        if attribute.domain == "CORNER":
            of_vertex = [[] for _ in mesh.vertices]
            for loop, row in zip(mesh.loops, rows):
                of_vertex[loop.vertex_index].append(row)
            rows = [[sum(x) / len(x) for x in zip(*own)] for own in of_vertex]
        columns.append(np.array(rows))
        names.append((attribute.name, len(rows[0])))
    return (np.concatenate(columns, 1), names) if columns else (None, names)


FIELDS = {
    "FLOAT": ("value", 1, np.float32),
    "INT": ("value", 1, np.int32),
    "BOOLEAN": ("value", 1, bool),
    "INT8": ("value", 1, np.int32),
    "FLOAT2": ("vector", 2, np.float32),
    "FLOAT_VECTOR": ("vector", 3, np.float32),
    "FLOAT_COLOR": ("color", 4, np.float32),
    "BYTE_COLOR": ("color", 4, np.float32),
    "INT32_2D": ("value", 2, np.int32),
    "INT16_2D": ("value", 2, np.int32),
}
# The selection is meant to change. Sharpness is compared as "smooth" and "sharp": Blender drops an
# attribute of it that is false everywhere.
CHANGING = {".select_vert", ".select_edge", ".select_poly", "sharp_face", "sharp_edge"}
CHANGING |= {"completed", "completion_source", "completion_confidence"}


def get(collection, field, width, dtype):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(field, values)
    return values.reshape(len(collection), width)


def snapshot(ob):
    """Everything in a mesh that is not Blender's own business, as arrays by name; one row an
    element, in order."""
    mesh = ob.data
    held = {
        "positions": positions(mesh),
        "edges": get(mesh.edges, "vertices", 2, np.int32),
        "polygon sizes": get(mesh.polygons, "loop_total", 1, np.int32),
        "polygon starts": get(mesh.polygons, "loop_start", 1, np.int32),
        "corners": get(mesh.loops, "vertex_index", 1, np.int32),
        "corner edges": get(mesh.loops, "edge_index", 1, np.int32),
        "materials": get(mesh.polygons, "material_index", 1, np.int32),
        "smooth": get(mesh.polygons, "use_smooth", 1, bool),
        "seams": get(mesh.edges, "use_seam", 1, bool),
        "sharp": get(mesh.edges, "use_edge_sharp", 1, bool),
        "weights": weights(ob),
    }
    for layer in mesh.uv_layers:
        held[f"uv {layer.name}"] = get(layer.data, "uv", 2, np.float32)
    for attribute in mesh.attributes:
        if attribute.name in CHANGING:
            continue
        values = get(attribute.data, *FIELDS[attribute.data_type])
        if attribute.name.startswith(".") and values.dtype == bool and not values.any():
            continue  # Blender's own, e.g. pinned UVs: it comes and goes with Edit Mode
        held[f"attribute {attribute.name}"] = values
    for key in mesh.shape_keys.key_blocks if mesh.shape_keys else ():
        held[f"key {key.name}"] = get(key.data, "co", 3, np.float32)
    return held


def weights(ob):
    """(n, groups): -1 where a vertex is not in a group."""
    table = np.full((len(ob.data.vertices), len(ob.vertex_groups)), -1.0, np.float32)
    for vertex in ob.data.vertices:
        for element in vertex.groups:
            table[vertex.index, element.group] = element.weight
    return table


def kept(before, after):
    """Names of what did not come through: elements of before must be there, first, in order, to
    the bit."""
    return [
        name
        for name, values in before.items()
        if name not in after
        or after[name].dtype != values.dtype
        or after[name][: len(values)].tobytes() != values.tobytes()
    ]


def same(before, after):
    """Whether two snapshots are equal to the bit, lengths and names included."""
    return not kept(before, after) and not kept(after, before)
