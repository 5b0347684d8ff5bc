# SPDX-License-Identifier: Apache-2.0
"""A plain model of a source, as a baseline: a uniform four-dimensional table of light over the sphere that holds the
starts, a byte a cell."""
import numpy as np

from .rays import Rays

# A byte is a step of 4.4 % on a logarithmic scale; 0 is dark.
STEP = 1.044
# Of a file: eight numbers.
HEADER_BYTES = 64


def _sphere_from(across, around):
    """Points of the unit sphere from two numbers in [0, 1), even over its area."""
    z, turn = 2.0 * across - 1.0, 2.0 * np.pi * around
    s = np.sqrt(np.maximum(0.0, 1.0 - z * z))
    return np.stack([s * np.cos(turn), s * np.sin(turn), z], axis=-1)


def _axes_at(normal):
    """Two axes across each normal: along and across the meridian."""
    east = np.stack([-normal[:, 1], normal[:, 0], np.zeros(len(normal))], axis=-1)
    length = np.linalg.norm(east, axis=1, keepdims=True)
    east = np.where(length > 1e-12, east / np.maximum(length, 1e-12), [[0.0, 1.0, 0.0]])
    return east, np.cross(normal, east)


class Sphere:
    """The sphere that holds the starts of rays. A ray is four numbers in [0, 1) there, even over étendue: where it leaves
    the sphere, and its direction cosines at that place."""

    # Two of the numbers are angles.
    CYCLIC = (1, 3)

    def __init__(self, rays):
        start = np.asarray(rays.start, float)
        self.centre = 0.5 * (start.min(axis=0) + start.max(axis=0))
        self.radius = 1.0001 * np.linalg.norm(start - self.centre, axis=1).max() + 1e-9

    def numbers(self, rays):
        """A row a ray."""
        start, direction = (np.asarray(x, float) for x in (rays.start, rays.direction))
        o = (start - self.centre) / self.radius
        b = np.sum(o * direction, axis=1)
        out = o + (np.sqrt(np.maximum(0.0, b * b - np.sum(o * o, axis=1) + 1.0)) - b)[:, None] * direction
        east, north = _axes_at(out)
        # The disk of direction cosines by radius squared and angle: even over its area.
        u, v = np.sum(direction * east, axis=1), np.sum(direction * north, axis=1)
        return np.stack([0.5 * (out[:, 2] + 1.0), np.arctan2(out[:, 1], out[:, 0]) / (2.0 * np.pi) % 1.0,
                         u * u + v * v, np.arctan2(v, u) / (2.0 * np.pi) % 1.0], axis=-1)

    def rays(self, numbers):
        """The other way, of equal flux."""
        out = _sphere_from(numbers[:, 0], numbers[:, 1])
        east, north = _axes_at(out)
        r, turn = np.sqrt(numbers[:, 2]), 2.0 * np.pi * numbers[:, 3]
        direction = ((r * np.cos(turn))[:, None] * east + (r * np.sin(turn))[:, None] * north
                     + np.sqrt(np.maximum(0.0, 1.0 - r * r))[:, None] * out)
        return Rays(self.centre + self.radius * out, direction, np.ones(len(numbers)))


class LightField:
    """Cells of equal étendue, `n` along each of the four numbers of a sphere."""

    def __init__(self, rays, n):
        self.n, self.sphere = n, Sphere(rays)
        at = np.minimum((self.sphere.numbers(rays) * n).astype(np.int64), n - 1)
        light = np.bincount(np.ravel_multi_index(at.T, 4 * (n,)), rays.weight, n**4)
        level = np.log(np.maximum(light / light.max(), 1e-300)) / np.log(STEP) + 255.0
        self.table = np.where(light > 0.0, np.maximum(1.0, np.rint(level)), 0.0).astype(np.uint8)

    @property
    def size_bytes(self):
        return self.table.nbytes + HEADER_BYTES

    def sample(self, count, seed):
        random = np.random.default_rng(seed)
        light = np.where(self.table > 0, STEP ** self.table.astype(float), 0.0)
        below = np.cumsum(light)
        cell = np.searchsorted(below, random.random(count) * below[-1], side="right").clip(0, len(below) - 1)
        return self.sphere.rays((np.stack(np.unravel_index(cell, 4 * (self.n,)), axis=-1) + random.random((count, 4)))
                                / self.n)
