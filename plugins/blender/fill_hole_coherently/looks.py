# SPDX-License-Identifier: GPL-3.0-or-later
"""What new vertices and faces have beside their places: material and shading, weights, colours,
texture coordinates, shape keys from around the hole; attributes that tell them from the rest."""

import numpy as np

from .spread import Spread  # noqa: F401 - for mesh_data

COMPLETED, SOURCE, CONFIDENCE = "completed", "completion_source", "completion_confidence"


def match_rims(bm, result, vertices, faces):
    """A fill takes the material and the shading that most of the faces around its hole have."""
    first_new = len(bm.faces) - len(faces)
    holes = [hole for hole in result.holes if hole.status == "filled"]
    for hole in holes:
        votes = {}
        for loop in hole.loops:
            for a, b in zip(loop, np.roll(loop, -1)):
                edge = bm.edges.get((bm.verts[a], bm.verts[b]))
                for face in edge.link_faces if edge else ():
                    if face.index < first_new:
                        look = face.material_index, face.smooth
                        votes[look] = votes.get(look, 0) + 1
        material, smooth = max(votes, key=lambda look: (votes[look], look), default=(0, True))
        for face in faces[hole.first_new_face : hole.first_new_face + hole.new_face_count]:
            face.material_index, face.smooth = material, smooth


def spread_layers(bm, spread, vertices, faces):
    """Vertex groups, colours and texture coordinates, evenly from the rims over the fills."""
    rim = [bm.verts[i] for i in spread.rim]
    _spread_weights(bm, spread, rim, vertices)
    for layers in (bm.verts.layers.float_color, bm.verts.layers.color):
        for layer in layers.values():
            values = spread([vertex[layer][:] for vertex in rim])
            for vertex, value in zip(vertices, values.tolist()):
                vertex[layer] = value
    loops = bm.loops.layers
    for layer in (*loops.float_color.values(), *loops.color.values()):
        _spread_corners(bm, spread, rim, faces, lambda loop: loop[layer][:], _set_item(layer))
    for layer in loops.uv.values():
        _spread_corners(bm, spread, rim, faces, lambda loop: loop[layer].uv[:], _set_uv(layer))


def _set_item(layer):
    def set_item(loop, value):
        loop[layer] = value

    return set_item


def _set_uv(layer):
    def set_uv(loop, value):
        loop[layer].uv = value

    return set_uv


def _spread_corners(bm, spread, rim, faces, get, put):
    """Where a rim vertex has several values, at a seam, the fill has their mean."""
    first_new = len(bm.faces) - len(faces)
    at_rim = []
    for vertex in rim:
        own = [get(loop) for loop in vertex.link_loops if loop.face.index < first_new]
        at_rim.append(np.mean(own, axis=0))
    inside = spread(at_rim)
    place = {vertex.index: value for vertex, value in zip(rim, at_rim)}
    first = len(bm.verts) - spread.count
    for face in faces:
        for loop in face.loops:
            i = loop.vert.index
            put(loop, inside[i - first] if i >= first else place[i])


def _spread_weights(bm, spread, rim, vertices):
    layer = bm.verts.layers.deform.active
    if layer is None:
        return
    groups = sorted({group for vertex in rim for group in vertex[layer].keys()})
    values = spread([[vertex[layer].get(group, 0.0) for group in groups] for vertex in rim])
    for vertex, weights in zip(vertices, values.tolist()):
        for group, weight in zip(groups, weights):
            if weight > 1e-4:
                vertex[layer][group] = min(weight, 1.0)


def spread_keys(bm, spread, vertices):
    """Shape keys move a fill as they move its rim."""
    at_rim = np.array([bm.verts[i].co for i in spread.rim]).reshape(-1, 3)
    own = np.array([vertex.co for vertex in vertices]).reshape(-1, 3)
    for layer in bm.verts.layers.shape.values():
        moved = np.array([bm.verts[i][layer] for i in spread.rim]).reshape(-1, 3) - at_rim
        for vertex, co in zip(vertices, (own + spread(moved)).tolist()):
            vertex[layer] = co


def _layer(bm, name):
    """The layer of one of our attributes, or None."""
    if name == COMPLETED:
        return _booleans(bm).get(name)
    return (bm.verts.layers.int if name == SOURCE else bm.verts.layers.float).get(name)


def _booleans(bm):
    """Python sees no booleans of a BMesh in old versions of Blender: there it is 0 or 1."""
    return getattr(bm.faces.layers, "bool", bm.faces.layers.int)


def make_layers(bm, mesh):
    """Adds our attributes where they are not there yet; gives the names that are taken by
    something else, which stays."""
    taken = []
    for name in (COMPLETED, SOURCE, CONFIDENCE):
        if _layer(bm, name) is not None:
            continue
        if name in mesh.attributes:
            taken.append(name)
        elif name == COMPLETED:
            _booleans(bm).new(name)
        elif name == SOURCE:
            layer = bm.verts.layers.int.new(name)
            for vertex in bm.verts:
                vertex[layer] = -1
        else:
            bm.verts.layers.float.new(name)
    return taken


def write_attributes(bm, result, polygons, vertices, faces, missed):
    """Where each new element comes from. Sources are numbers of polygons."""
    if COMPLETED not in missed:
        layer = _layer(bm, COMPLETED)
        for face in faces:
            face[layer] = True
    if SOURCE not in missed:
        layer = _layer(bm, SOURCE)
        triangles = result.new_vertex_source_faces
        sources = np.where(triangles >= 0, polygons[np.maximum(triangles, 0)], -1)
        for vertex, source in zip(vertices, sources.tolist()):
            vertex[layer] = source
    if CONFIDENCE not in missed:
        layer = _layer(bm, CONFIDENCE)
        for vertex, confidence in zip(vertices, result.new_vertex_confidences.tolist()):
            vertex[layer] = confidence
