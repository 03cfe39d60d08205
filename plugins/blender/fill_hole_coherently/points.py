# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of vertices alone: new vertices for the holes of a cloud, and what they carry."""

import numpy as np
from mathutils.kdtree import KDTree

from . import looks, values

# An attribute of this name says which side of each point is out.
NORMAL = "normal", "FLOAT_VECTOR", "POINT"


def take_normals(attributes):
    """A cloud's attributes without its normals, and those, or None."""
    of_points = [a for a in attributes if a.key == NORMAL]
    others = [a for a in attributes if a.key != NORMAL]
    return others, of_points[0].rows.astype(np.float32) if of_points else None


class NearestOfRim:
    """Values that rims have for new points: those of the nearest point of their hole's rim, since no edges
    lead there. In the place of spread.Spread."""

    def __init__(self, bm, result):
        loops = [hole.loops for hole in result.holes]
        self.rim = np.unique(np.concatenate([np.empty(0, np.int64), *(v for own in loops for v in own)]))
        self._nearest = np.zeros(len(result.new_points), np.int64)
        for hole in set(result.new_point_holes.tolist()):
            own = np.concatenate(loops[hole])
            tree = KDTree(len(own))
            for i, v in enumerate(own.tolist()):
                tree.insert(bm.verts[v].co, i)
            tree.balance()
            for k in np.flatnonzero(result.new_point_holes == hole).tolist():
                _, i, _ = tree.find(result.new_points[k].tolist())
                self._nearest[k] = np.searchsorted(self.rim, own[i])

    def __call__(self, rows):
        rows = np.asarray(rows, float).reshape(len(self.rim), -1)
        return rows[self._nearest]

    def nearest(self):
        return self._nearest


class Fill:
    """The points that were added to a bmesh; as looks.Fill, without faces."""

    def __init__(self, bm, result, vertices):
        self.bm, self.vertices, self.faces = bm, vertices, []
        self.spread = NearestOfRim(bm, result)
        self.rim = [bm.verts[i] for i in self.spread.rim]


def add(bm, result, carried, missed):
    """The new points, selected."""
    vertices = [bm.verts.new(co) for co in result.new_points.tolist()]
    bm.verts.index_update()
    bm.verts.ensure_lookup_table()
    fill = Fill(bm, result, vertices)
    looks.copy_from_rim(fill)
    rows = values.rows_of(carried.asked, result.new_point_values)
    if carried.normals is not None:
        rows[NORMAL] = result.new_normals
    looks.set_values(fill, rows)
    looks.spread_weights(fill)
    looks.spread_keys(fill)
    looks.write_attributes(
        bm, vertices, vertices, result.new_point_source_points, result.new_point_confidences, missed
    )
    for vertex in vertices:
        vertex.select_set(True)
