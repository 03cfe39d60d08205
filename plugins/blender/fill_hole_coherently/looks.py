# SPDX-License-Identifier: GPL-3.0-or-later
"""What new vertices and faces have beside their places: material and shading, weights, shape keys and
labels from around the hole, colours and texture coordinates from where the shape was copied from;
attributes that tell them from the rest."""

import numpy as np

from . import values
from .spread import Spread

# Python sees no booleans in old versions.
LABELS = ("int", "string", "bool")
COMPLETED, SOURCE, CONFIDENCE = "completed", "completion_source", "completion_confidence"


class Fill:
    """The elements that were added to a bmesh, and how to get to them from the rim."""

    def __init__(self, bm, result, vertices, faces):
        self.bm, self.vertices, self.faces = bm, vertices, faces
        first_new = result.input_vertex_count
        self.spread = Spread(result.new_faces, first_new, len(vertices))
        self.rim = [bm.verts[i] for i in self.spread.rim]
        self.old_face_count = len(bm.faces) - len(faces)
        # Rows of the new vertices first, those of the rim after them.
        self._row = {int(v): len(vertices) + k for k, v in enumerate(self.spread.rim)}
        self._row |= {first_new + i: i for i in range(len(vertices))}

    def is_old(self, face):
        return face.index < self.old_face_count

    def corners(self):
        """The corners of new faces, each with the row of its vertex."""
        for face in self.faces:
            for loop in face.loops:
                yield loop, self._row[loop.vert.index]


def copy_from_rim(fill):
    """What cannot be mixed: labels from the nearest vertex at the rim, all that faces carry from the
    nearest face there."""
    nearest = [fill.rim[i] for i in fill.spread.nearest()]
    for layer in _labels(fill.bm.verts.layers):
        for vertex, like in zip(fill.vertices, nearest):
            vertex[layer] = like[layer]
    for layer in _labels(fill.bm.loops.layers) if fill.faces else ():
        at_rim = [next(loop for loop in v.link_loops if fill.is_old(loop.face))[layer] for v in fill.rim]
        labels = [at_rim[i] for i in fill.spread.nearest()] + at_rim
        for loop, row in fill.corners():
            loop[layer] = labels[row]
    # Not by copy_from: in Blender 5.0 the face that has been copied to is no longer known.
    layers = list(_labels(fill.bm.faces.layers, (*LABELS, *values.LAYERS.values())))
    known = [face for vertex in fill.rim for face in vertex.link_faces if fill.is_old(face)]
    reached = {face.index for face in known}
    for face in known:  # which grows: the new faces behind
        for other in (f for edge in face.edges for f in edge.link_faces):
            if other.index not in reached and not fill.is_old(other):
                reached.add(other.index)
                known.append(other)
                for layer in layers:
                    other[layer] = face[layer]


def _labels(layers, kinds=LABELS):
    for kind in kinds:
        for name, layer in getattr(layers, kind).items() if hasattr(layers, kind) else ():
            if name not in (COMPLETED, SOURCE) and not name.startswith("."):
                yield layer


def match_rims(fill, result):
    """A fill takes the material and the shading that most of the faces around its hole have."""
    bm = fill.bm
    holes = [hole for hole in result.holes if hole.status == "filled"]
    for hole in holes:
        votes = {}
        for loop in hole.loops:
            for a, b in zip(loop, np.roll(loop, -1)):
                edge = bm.edges.get((bm.verts[a], bm.verts[b]))
                for face in edge.link_faces if edge else ():
                    if fill.is_old(face):
                        look = face.material_index, face.smooth
                        votes[look] = votes.get(look, 0) + 1
        material, smooth = max(votes, key=lambda look: (votes[look], look), default=(0, True))
        for face in fill.faces[hole.first_new_face : hole.first_new_face + hole.new_face_count]:
            face.material_index, face.smooth = material, smooth


def set_values(fill, rows):
    """Colours and numbers: `rows` of the new vertices by (name, type, domain); what is not there
    runs evenly from the rim."""
    for kind, of_bmesh in values.LAYERS.items():
        for name, layer in getattr(fill.bm.verts.layers, of_bmesh).items():
            if values.is_user_s(name):
                own = rows.get((name, kind, "POINT"))
                if own is None:
                    own = fill.spread([_tuple(vertex[layer]) for vertex in fill.rim])
                for vertex, value in zip(fill.vertices, own.tolist()):
                    vertex[layer] = value if len(value) > 1 else value[0]
        for name, layer in getattr(fill.bm.loops.layers, of_bmesh).items():
            if fill.faces and values.is_user_s(name):
                at_rim = _corner_means(fill, lambda loop: _tuple(loop[layer]))
                own = rows.get((name, kind, "CORNER"))
                own = fill.spread(at_rim) if own is None else own
                table = np.concatenate([own, at_rim]).tolist()
                for loop, row in fill.corners():
                    loop[layer] = table[row] if len(table[row]) > 1 else table[row][0]


def _tuple(value):
    return (value,) if isinstance(value, float) else value[:]


def _corner_means(fill, get):
    """Where a rim vertex has several values, at a seam, the fill has their mean."""
    return np.array(
        [np.mean([get(c) for c in v.link_loops if fill.is_old(c.face)], axis=0) for v in fill.rim]
    )


def set_texture(fill, texture):
    """Texture coordinates: those of the source's place, see texture.py; without one they run evenly
    from the rim. `texture(name)`: faces that have a source, and their corners' coordinates."""
    for name, layer in fill.bm.loops.layers.uv.items():
        at_rim = _corner_means(fill, lambda loop: loop[layer].uv[:])
        table = np.concatenate([fill.spread(at_rim), at_rim]).tolist()
        for loop, row in fill.corners():
            loop[layer].uv = table[row]
        for face, corners in zip(*texture(name, [face.material_index for face in fill.faces])):
            for loop, coordinates in zip(fill.faces[face].loops, corners.tolist()):
                loop[layer].uv = coordinates


def spread_weights(fill):
    """Weights of a vertex often sum to 1: evenly from the rim they go on doing that."""
    layer = fill.bm.verts.layers.deform.active
    if layer is None:
        return
    groups = sorted({group for vertex in fill.rim for group in vertex[layer].keys()})
    spread = fill.spread([[vertex[layer].get(group, 0.0) for group in groups] for vertex in fill.rim])
    for vertex, weights in zip(fill.vertices, spread.tolist()):
        for group, weight in zip(groups, weights):
            if weight > 1e-4:
                vertex[layer][group] = min(weight, 1.0)


def spread_keys(fill):
    """Shape keys move a fill as they move its rim."""
    at_rim = np.array([vertex.co for vertex in fill.rim]).reshape(-1, 3)
    own = np.array([vertex.co for vertex in fill.vertices]).reshape(-1, 3)
    for layer in fill.bm.verts.layers.shape.values():
        moved = np.array([vertex[layer] for vertex in fill.rim]).reshape(-1, 3) - at_rim
        for vertex, co in zip(fill.vertices, (own + fill.spread(moved)).tolist()):
            vertex[layer] = co


def _layer(bm, name, elements):
    """The layer of one of our attributes, or None. `elements`: those that `completed` is of, faces or,
    of a cloud, vertices."""
    if name == COMPLETED:
        return _booleans(elements).get(name)
    return (bm.verts.layers.int if name == SOURCE else bm.verts.layers.float).get(name)


def _booleans(elements):
    """Python sees no booleans of a BMesh in old versions of Blender: there it is 0 or 1."""
    return getattr(elements.layers, "bool", elements.layers.int)


def absent_layers(bm, elements):
    """The names of our attributes that the mesh does not have."""
    return [name for name in (COMPLETED, SOURCE, CONFIDENCE) if _layer(bm, name, elements) is None]


def make_layers(bm, mesh, elements):
    """Adds our attributes where they are not there yet; gives the names that are taken by
    something else, which stays."""
    taken = []
    for name in (COMPLETED, SOURCE, CONFIDENCE):
        if _layer(bm, name, elements) is not None:
            continue
        if name in mesh.attributes:
            taken.append(name)
        elif name == COMPLETED:
            _booleans(elements).new(name)
        elif name == SOURCE:
            layer = bm.verts.layers.int.new(name)
            for vertex in bm.verts:
                vertex[layer] = -1
        else:
            bm.verts.layers.float.new(name)
    return taken


def write_attributes(bm, completed, vertices, sources, confidences, missed):
    """Where each new element comes from. `completed`: the new faces, or of a cloud the new vertices."""
    if COMPLETED not in missed:
        layer = _layer(bm, COMPLETED, bm.verts if completed is vertices else bm.faces)
        for element in completed:
            element[layer] = True
    if SOURCE not in missed:
        layer = _layer(bm, SOURCE, None)
        for vertex, source in zip(vertices, sources.tolist()):
            vertex[layer] = source
    if CONFIDENCE not in missed:
        layer = _layer(bm, CONFIDENCE, None)
        for vertex, confidence in zip(vertices, confidences.tolist()):
            vertex[layer] = confidence
