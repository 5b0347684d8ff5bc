# SPDX-License-Identifier: Apache-2.0
"""How far one set of rays is from another, in five views. All follows from the rays of the reference. The definitions
are in benchmarks/README.md, "LB-F2"; this is code of its own, which knows nothing of the compression."""
import dataclasses
import math

import numpy as np

from .rays import Rays

HELD = 0.99
# Along a side of a square window.
MOST_CELLS = 64
NAMES = ("far", "near", "focus", "beam", "four_d")


def weighted_quantile(values, weight, share):
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weight[order], dtype=float)
    return float(values[order[np.searchsorted(below, share * below[-1], side="left").clip(0, len(values) - 1)]])


@dataclasses.dataclass(frozen=True)
class Window:
    """A square in two coordinates."""
    centre: np.ndarray
    half: float

    @staticmethod
    def of(xy, weight):
        """About the medians; it holds 99 % of the flux."""
        seen = np.isfinite(xy).all(axis=1)
        xy, weight = xy[seen], weight[seen]
        centre = np.array([weighted_quantile(xy[:, k], weight, 0.5) for k in (0, 1)])
        half, least = (weighted_quantile(np.abs(xy - centre).max(axis=1), weight, HELD),
                       1e-4 * max(1.0, np.abs(centre).max()))
        # Rays through one point differ by the rounding of floats, and must not lie on the edge of two cells.
        return Window(centre, half) if half > least else Window(centre - least / MOST_CELLS, least)

    def cells(self, xy, n):
        """The cell of each place, row by row; n * n is outside."""
        with np.errstate(invalid="ignore"):
            at = np.floor((xy - self.centre + self.half) / (2.0 * self.half) * n)
        inside = np.isfinite(at).all(axis=1) & (at >= 0).all(axis=1) & (at < n).all(axis=1)
        at = np.where(inside[:, None], at, 0).astype(np.int64)
        return np.where(inside, at[:, 0] * n + at[:, 1], n * n)


class Views:
    """The five views that a reference defines."""

    def __init__(self, reference: Rays):
        w = reference.weight
        o, d = (np.asarray(x, float) for x in (reference.start, reference.direction))
        mean = w @ d
        a = mean / np.linalg.norm(mean) if np.linalg.norm(mean) >= 0.2 else np.array([0.0, 0.0, 1.0])
        side = np.eye(3)[np.argmin(np.abs(a))]
        x = np.cross(side, a)
        x /= np.linalg.norm(x)
        self.frame = np.stack([x, np.cross(a, x), a])
        # The focus: the least sum of squared distances to the lines.
        across = w.sum() * np.eye(3) - (d * w[:, None]).T @ d
        self.focus = np.linalg.solve(across, w @ o - (d * (w * np.sum(o * d, axis=1))[:, None]).sum(axis=0))
        o, d = self._turned(reference)
        far = np.linalg.norm(o, axis=1)
        self.radius = max(weighted_quantile(far, w, 0.98), 1e-6)
        self.near_z = o[:, 2].max() + 1.0
        self.focal = max(1.25 * self.radius, 1.02 * 0.5 * (far + o[:, 2]).max())
        self.cosine_low = min(weighted_quantile(d[:, 2], w, 1.0 - HELD), 1.0 - 1e-9)
        self.near = Window(np.zeros(2), 1.2 * self.radius)
        self.on_focus = Window.of(self._crossing(o, d, 0.0), w)
        self.on_beam = Window.of(self._beam(o, d), w)
        self.across = Window.of(d[:, :2], w)

    def _turned(self, rays):
        return (np.asarray(rays.start, float) - self.focus) @ self.frame.T, np.asarray(rays.direction, float) @ self.frame.T

    @staticmethod
    def _crossing(o, d, z):
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (z - o[:, 2]) / d[:, 2]
            return o[:, :2] + t[:, None] * d[:, :2]

    def _beam(self, o, d):
        """Direction cosines after a paraboloid |X| + z = 2 f about the focus; not a number where a ray misses it."""
        reach = 2.0 * self.focal - o[:, 2]
        b, c = np.sum(o * d, axis=1) + d[:, 2] * reach, np.sum(o * o, axis=1) - reach**2
        root = np.sqrt(np.maximum(0.0, b * b - (1.0 - d[:, 2] ** 2) * c))
        with np.errstate(divide="ignore", invalid="ignore"):
            t = np.where(c < 0.0, -c / (b + root), np.nan)
            hit = o + t[:, None] * d
            normal = hit / np.linalg.norm(hit, axis=1, keepdims=True) + [0.0, 0.0, 1.0]
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            return np.where(np.isfinite(t)[:, None], (d - 2.0 * np.sum(d * normal, axis=1, keepdims=True) * normal)[:, :2],
                            np.nan)

    def _cells(self, o, d, view):
        """The cell of each ray in a view, and how many there are. A ray that the view does not see has cell -1."""
        if view == "far":
            rest = 48 * 96
            row = np.floor((d[:, 2] - self.cosine_low) / (1.0 - self.cosine_low) * 48).astype(np.int64)
            turn = np.arctan2(d[:, 1], d[:, 0]) / (2.0 * math.pi) + 0.5
            column = np.minimum(95, (turn * 96).astype(np.int64))
            return np.where(row < 0, rest, np.clip(row, 0, 47) * 96 + column), rest + 1
        if view == "near":
            return np.where(d[:, 2] > 0.0, self.near.cells(self._crossing(o, d, self.near_z), 32), -1), 32 * 32 + 1
        if view == "focus":
            return self.on_focus.cells(self._crossing(o, d, 0.0), MOST_CELLS), MOST_CELLS**2 + 1
        if view == "beam":
            beam = self._beam(o, d)
            return np.where(np.isfinite(beam[:, 0]), self.on_beam.cells(beam, MOST_CELLS), -1), MOST_CELLS**2 + 1
        place, way = self.on_focus.cells(self._crossing(o, d, 0.0), 8), self.across.cells(d[:, :2], 8)
        return np.where((place == 64) | (way == 64), 64 * 64, place * 64 + way), 64 * 64 + 1

    def shares(self, rays, block=1 << 19):
        """By view: shares of the flux by cell, and their variances by counting."""
        found = {name: (0.0, 0.0) for name in NAMES}
        total = rays.flux.sum(dtype=float)
        for k in range(0, len(rays), block):
            part = rays[k:k + block]
            o, d = self._turned(part)
            w = np.asarray(part.flux, float) / total
            for name, (share, variance) in found.items():
                cell, count = self._cells(o, d, name)
                seen = cell >= 0
                found[name] = (share + np.bincount(cell[seen], w[seen], count),
                               variance + np.bincount(cell[seen], w[seen] ** 2, count))
        return found


@dataclasses.dataclass(frozen=True)
class Difference:
    """Relative to the reference's shares: the error, its counting noise, what is left, the standard error of that, and
    the noise of the rays that were compressed."""
    error: float
    floor: float
    excess: float
    standard_error: float
    raw: float


def compare(reference, test, trained):
    """By view, from the shares of each in the views of the reference. `trained`: of the rays that the test's model was
    made from."""
    found = {}
    for name in NAMES:
        (p, vp), (q, vq), (_, vt) = reference[name], test[name], trained[name]
        size = np.linalg.norm(p)
        variance = vp + vq
        error, floor = np.linalg.norm(p - q) / size, math.sqrt(variance.sum()) / size
        excess = math.sqrt(max(0.0, error**2 - floor**2))
        # Of error^2 - floor^2; where the excess is small, the root of it is the excess's own.
        spread = math.sqrt(2.0 * np.sum(variance**2) + 4.0 * np.sum(np.maximum(0.0, (p - q) ** 2 - variance) * variance))
        spread /= size**2
        found[name] = Difference(error, floor, excess, spread / max(2.0 * excess, math.sqrt(spread)),
                                 math.sqrt(vt.sum()) / size)
    return found
