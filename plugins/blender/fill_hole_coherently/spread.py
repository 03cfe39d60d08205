# SPDX-License-Identifier: GPL-3.0-or-later
"""Values that the rim has (weights, texture coordinates without a source, labels), for the vertices of the
fill."""

import numpy as np

TOLERANCE = 1e-5
MAX_STEPS = 2000


class Spread:
    """Spreads values from rims over fills: at each new vertex the mean of its neighbours, so that
    they run evenly from rim to rim. Laplace's equation with uniform weights, by conjugate
    gradients on all columns at once."""

    def __init__(self, new_faces, first_new, new_count):
        faces = np.asarray(new_faces, np.int64)
        self.rim = np.unique(faces[faces < first_new])
        """The input vertices that the fills are joined to, ascending: the rows of the values."""
        self.count = new_count
        # New vertices first, the rim after them.
        local = np.where(
            faces >= first_new, faces - first_new, new_count + np.searchsorted(self.rim, faces)
        )
        sides = np.concatenate([local[:, [0, 1]], local[:, [1, 2]], local[:, [2, 0]]])
        pairs = np.unique(np.concatenate([sides, sides[:, ::-1]]), axis=0)
        pairs = pairs[pairs[:, 0] < new_count]
        self._neighbours = pairs[:, 1]
        self._starts = np.searchsorted(pairs[:, 0], np.arange(new_count))
        self._degrees = np.bincount(pairs[:, 0], minlength=new_count)[:, None].astype(float)

    def __call__(self, values):
        """(len(rim), columns) to (new vertices, columns)."""
        values = np.asarray(values, float).reshape(len(self.rim), -1)
        shape = (self.count, values.shape[1])
        if not self.count or not values.shape[1]:
            return np.zeros(shape)
        # Around the mean, so that a constant comes out exactly.
        middle = values.mean(axis=0)
        right = self._sum(np.zeros(shape), values - middle)
        x, rest = np.zeros(shape), right.copy()
        step, size = rest.copy(), (rest**2).sum(axis=0)
        goal = TOLERANCE**2 * np.maximum(size, 1e-30)
        for _ in range(MAX_STEPS):
            if (size <= goal).all():
                break
            moved = self._degrees * step - self._sum(step, np.zeros_like(values))
            length = size / np.maximum((step * moved).sum(axis=0), 1e-300)
            x += length * step
            rest -= length * moved
            before, size = size, (rest**2).sum(axis=0)
            step = rest + size / np.maximum(before, 1e-300) * step
        return x + middle

    def nearest(self):
        """(new vertices,): the rim vertex that is the fewest edges away, an index into rim; for
        labels: between 3 and 7 there is no 5."""
        found, rim = np.full(self.count, -1), np.arange(len(self.rim))
        while self.count:
            around = np.maximum.reduceat(np.concatenate([found, rim])[self._neighbours], self._starts)
            reached = (found < 0) & (around >= 0)
            if not reached.any():
                break
            found[reached] = around[reached]
        return found

    def _sum(self, new, rim):
        """For each new vertex the sum over its neighbours."""
        return np.add.reduceat(np.concatenate([new, rim])[self._neighbours], self._starts, axis=0)
