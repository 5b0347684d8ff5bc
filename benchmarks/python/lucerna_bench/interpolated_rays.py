# SPDX-License-Identifier: Apache-2.0
"""Rays spread over the cells of a k-d tree, as a baseline: the interpolation of ray sets after Muschaweck
(TM25RaySetTools), with one ray a cell and the same flux in all."""
import numpy as np

from .light_field import Sphere
from .rays import Rays


class Plane:
    """A ray to +z is four numbers on a plane across z, even over étendue: its place and its direction cosines. The plane is
    where the rays are narrowest."""

    CYCLIC = ()

    def __init__(self, rays):
        # Not the flattest: they count by the square of their tangents.
        steep = rays.direction[:, 2] > 0.5 * rays.direction[:, 2].max()
        start, direction = (np.asarray(x[steep], float) for x in (rays.start, rays.direction))
        slope = direction[:, :2] / direction[:, 2:]
        foot = start[:, :2] - start[:, 2:] * slope
        spread = np.sum(np.var(slope, axis=0))
        covariance = np.sum(np.mean(foot * slope, axis=0) - foot.mean(axis=0) * slope.mean(axis=0))
        self.z = float(-covariance / spread) if spread > 0.0 else float(np.median(start[:, 2]))

    def numbers(self, rays):
        start, direction = (np.asarray(x, float) for x in (rays.start, rays.direction))
        way = (self.z - start[:, 2]) / direction[:, 2]
        return np.hstack([start[:, :2] + way[:, None] * direction[:, :2], direction[:, :2]])

    def rays(self, numbers):
        """Of equal flux; none where there is no such direction."""
        square = np.sum(numbers[:, 2:] ** 2, axis=1)
        start = np.column_stack([numbers[:, :2], np.full(len(numbers), self.z)])
        return Rays(start, np.column_stack([numbers[:, 2:], np.sqrt(np.maximum(0.0, 1.0 - square))]),
                    np.where(square < 1.0, 1.0, 0.0))


def cells(points, cyclic=()):
    """Halves at the median, along each axis in turn, down to one point: the low and high corner of each point's cell.
    Cyclic axes go from 0 to 1, others as far as the points do."""
    found = np.empty((len(points), 2, points.shape[1]))
    low, high = points.min(axis=0), points.max(axis=0)
    low[list(cyclic)], high[list(cyclic)] = 0.0, 1.0
    left = [(np.arange(len(points)), low, high, 0)]
    while left:
        which, low, high, axis = left.pop()
        if len(which) == 1:
            found[which[0]] = low, high
            continue
        order = which[np.argsort(points[which, axis], kind="stable")]
        middle = len(order) // 2
        cut = 0.5 * (points[order[middle - 1], axis] + points[order[middle], axis])
        below, above = high.copy(), low.copy()
        below[axis] = above[axis] = cut
        turned = (axis + 1) % points.shape[1]
        left += [(order[:middle], low, below, turned), (order[middle:], above, high, turned)]
    return found


def drawn_in(boxes, points, cyclic=()):
    """Sides at the edge of all cells end half a mean inner width beyond their points: the box of all rays has corners
    where there is no light."""
    edges = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    low_edge, high_edge = boxes[:, 0] == edges[0], boxes[:, 1] == edges[1]
    low_edge[:, list(cyclic)] = high_edge[:, list(cyclic)] = False
    inner = ~(low_edge | high_edge)
    width = np.sum((boxes[:, 1] - boxes[:, 0]) * inner, axis=0) / np.maximum(1, inner.sum(axis=0))
    reach = np.where(inner.any(axis=0), 0.5 * width, np.inf)
    return np.stack([np.where(low_edge, np.maximum(boxes[:, 0], points - reach), boxes[:, 0]),
                     np.where(high_edge, np.minimum(boxes[:, 1], points + reach), boxes[:, 1])], axis=1)


class InterpolatedRays:
    """All that is stored are four numbers a ray, of equal flux: the cells follow from them. Rays that all go to +z are on a
    plane, others on the sphere about their starts."""

    def __init__(self, rays):
        self.surface = (Plane if np.all(rays.direction[:, 2] > 0.0) else Sphere)(rays)
        numbers = self.surface.numbers(rays)
        self.cells = drawn_in(cells(numbers, self.surface.CYCLIC), numbers, self.surface.CYCLIC)

    def sample(self, count, seed):
        random = np.random.default_rng(seed)
        cell = self.cells[random.integers(len(self.cells), size=count)]
        return self.surface.rays(cell[:, 0] + random.random((count, 4)) * (cell[:, 1] - cell[:, 0]))
