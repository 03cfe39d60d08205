# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture coordinates that new faces take from where their shape was copied from, as the command line
does it for OBJ (docs/appearance.md): the image goes on, and coordinates jump only where sources change
and at the rim. All corners of a face lie in one chart: where the source's triangles are of several, or
a chart meets itself, the triangle of the first corner is continued as a plane."""

import numpy as np


class Places:
    """Where the corners of the new faces lie on one source. Arrays have a row for each of the
    faces in `faces`, those that have a source on the mesh itself."""

    def __init__(self, result, vertices, triangles):
        """`vertices`, `triangles`: the mesh that was filled."""
        n, origin = len(vertices), result.new_vertex_source_faces
        of_mesh = (origin >= 0) & (origin < len(triangles))
        source = np.where(of_mesh, result.new_vertex_sources, -1)
        new = result.new_faces.astype(np.int64) - n
        own = np.where(new >= 0, source[np.maximum(new, 0)], -1) if len(source) else np.full(new.shape, -1)
        chosen, first = _source(own)
        self.faces = np.flatnonzero(chosen >= 0)
        """(k,): indices of new faces."""
        new, own, chosen, first = (a[self.faces] for a in (new, own, chosen, first))
        self.first = origin[new[np.arange(len(new)), first]]
        """(k,): the triangle of the first corner that has a place."""
        known = own == chosen[:, None]
        at = np.maximum(new, 0)
        self.triangle = np.where(known, origin[at], -1)
        """(k, 3): the triangle of each corner; -1 where it is not known."""
        self.weights = np.where(known[:, :, None], result.new_vertex_barycentrics[at], 0.0)
        """(k, 3, 3): where on it."""
        corners = vertices[triangles].astype(float)
        own_places = (self.weights[..., None] * corners[self.triangle]).sum(axis=2)
        # Where it is not known: where the copy's motion has it from.
        whole = np.concatenate([vertices, result.new_vertices]).astype(float)
        motion = _motions(result)[result.new_face_holes[self.faces], chosen]
        inverse = np.linalg.inv(motion[:, :, :3])
        moved = whole[result.new_faces[self.faces]] - motion[:, None, :, 3]
        moved = np.einsum("kij,kcj->kci", inverse, moved)
        places = np.where(known[:, :, None], own_places, moved)
        self.extended = _feet(corners[self.first], places)
        """(k, 3, 3): each corner's weights on the plane of `first`, also outside it."""

    def coordinates(self, uv, charts):
        """(k, 3, 2): of the faces' corners. `uv`: (triangles, 3, 2) of the mesh's; `charts`: (triangles,)."""
        mine = uv[self.first]
        continued = np.einsum("kcw,kwd->kcd", self.extended, mine)
        own = np.einsum("kcw,kcwd->kcd", self.weights, uv[self.triangle])
        size = np.linalg.norm(mine - np.roll(mine, 1, axis=1), axis=2).max(axis=1)
        off = np.linalg.norm(own - continued, axis=2)
        fits = (self.triangle >= 0) & (charts[self.triangle] == charts[self.first][:, None])
        return np.where((fits & (off <= size[:, None]))[..., None], own, continued)


def _source(own):
    """For each face the source that it is taken from, -1 for none, and the first corner that has it."""
    first = (own >= 0).argmax(axis=1)
    return own[np.arange(len(own)), first], first


def _motions(result):
    """(holes, most sources, 3, 4)."""
    most = max([len(hole.sources) for hole in result.holes], default=0)
    motions = np.tile(np.eye(3, 4), (len(result.holes), max(most, 1), 1, 1))
    for hole in result.holes:
        for i, source in enumerate(hole.sources):
            motions[hole.id, i] = source.transform
    return motions


def _feet(corners, points):
    """(k, 3, 3): barycentric coordinates of the points' feet on the triangles' planes."""
    a = corners[:, None, 0]
    b, c, d = corners[:, None, 1] - a, corners[:, None, 2] - a, points - a
    normal = np.cross(b, c)
    scale = 1 / np.maximum((normal**2).sum(axis=2), np.finfo(float).tiny)
    v = (np.cross(d, c) * normal).sum(axis=2) * scale
    w = (np.cross(b, d) * normal).sum(axis=2) * scale
    return np.stack([1 - v - w, v, w], axis=2)


def charts(vertices, uv, starts):
    """(corners,): the chart of each corner, those that faces join at one place of a vertex.
    `vertices`: (corners,) of each corner; `uv`: (corners, 2); `starts`: the first corner of each face."""
    places = np.column_stack([vertices.astype(float), uv])
    _, place = np.unique(places, axis=0, return_inverse=True)
    place = place.reshape(-1)
    face = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(vertices))))
    # The least label around, over and over; labels of labels, so that long charts take few rounds.
    label = np.arange(place.max() + 1) if len(place) else place
    while True:
        least = np.minimum.reduceat(label[place], starts) if len(starts) else label
        lower = label.copy()
        np.minimum.at(lower, place, least[face])
        lower = lower[lower]
        if (lower == label).all():
            return label[place]
        label = lower
