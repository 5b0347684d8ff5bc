# SPDX-License-Identifier: Apache-2.0
"""Targets as files that Lucerna reads: IES LM-63 tables for directions, cells of a plane as CSV."""
import numpy as np

from .tasks import illuminance, intensity

BOXES = 48


def target_rectangle(target, cut=0.0025, fine=1024):
    """Low and high direction cosines that leave out a quarter of a per cent of the target's light at each side."""
    at = (np.arange(fine) + 0.5) * 2.0 / fine - 1.0
    u, v = np.meshgrid(at, at, indexing="ij")
    w2 = 1.0 - u * u - v * v
    light = np.where(w2 > 0.0, intensity(target, u, v) / np.sqrt(np.where(w2 > 0.0, w2, 1.0)), 0.0)
    ends = []
    for axis in (1, 0):
        below = np.concatenate([[0.0], np.cumsum(light.sum(axis=axis))])
        ends.append(np.interp([cut, 1.0 - cut], below / below[-1], np.linspace(-1.0, 1.0, fine + 1)))
    return np.array(ends).T


class Table:
    """Intensities by C plane and gamma, bilinear between them. The target's axis is nadir: u along C0, v along C270."""

    def __init__(self, target, c_step_deg, gamma_step_deg):
        # An axial table has one plane.
        self.c_deg = np.arange(0.0, 360.0 + 0.5 * c_step_deg, c_step_deg) if c_step_deg else np.zeros(1)
        self.gamma_deg = np.linspace(0.0, 90.0, round(90.0 / gamma_step_deg) + 1)
        c, gamma = np.meshgrid(np.radians(self.c_deg), np.radians(self.gamma_deg), indexing="ij")
        # At hard edges (cosine_power) a value is the mean about its place, so that light is neither lost nor added.
        parts = (np.arange(5) - 2.0) / 5.0 if target["function"] == "cosine_power" else np.zeros(1)
        values = np.zeros_like(c)
        for dc in np.radians(c_step_deg) * parts:
            for dg in (gamma[0, 1] - gamma[0, 0]) * parts:
                sine = np.sin(np.abs(gamma + dg))
                values += intensity(target, sine * np.cos(c + dc), -sine * np.sin(c + dc)) / len(parts) ** 2
        values[:, 0] = values[:, 0].mean()
        self.cd = 1000.0 * values / values.max()

    def at(self, u, v):
        gamma = np.degrees(np.arcsin(np.minimum(1.0, np.hypot(u, v)))) / (self.gamma_deg[1] - self.gamma_deg[0])
        j = np.minimum(gamma.astype(int), len(self.gamma_deg) - 2)
        t = gamma - j
        if len(self.c_deg) == 1:
            return (1.0 - t) * self.cd[0, j] + t * self.cd[0, j + 1]
        c = np.degrees(np.arctan2(-v, u)) % 360.0 / (self.c_deg[1] - self.c_deg[0])
        i = np.minimum(c.astype(int), len(self.c_deg) - 2)
        s = c - i
        return ((1.0 - s) * ((1.0 - t) * self.cd[i, j] + t * self.cd[i, j + 1])
                + s * ((1.0 - t) * self.cd[i + 1, j] + t * self.cd[i + 1, j + 1]))

    def ies(self, name):
        """The text of an LM-63-2002 file."""
        rows = [*_lines(self.gamma_deg), *_lines(self.c_deg)]
        for plane in self.cd:
            rows += _lines(plane)
        head = ["IESNA:LM-63-2002", f"[TEST] {name}", "[TESTLAB] Lucerna Bench", "[ISSUEDATE] unknown",
                "[MANUFAC] unknown", "TILT=NONE", f"1 -1 1 {len(self.gamma_deg)} {len(self.c_deg)} 1 2 0 0 0", "1 1 0"]
        return "\r\n".join(head + rows) + "\r\n"


def _lines(values, a_line=10):
    return [" ".join(f"{v:.7g}" for v in values[k:k + a_line]) for k in range(0, len(values), a_line)]


def sampling_error(target, table, points=8):
    """Relative l2 error in 48 x 48 boxes, as of a score, of a table against the target's definition."""
    low, high = target_rectangle(target)
    share = (np.arange(BOXES * points) + 0.5) / (BOXES * points)
    u, v = np.meshgrid(*(low[k] + share * (high[k] - low[k]) for k in (0, 1)), indexing="ij")
    w2 = 1.0 - u * u - v * v
    solid = np.where(w2 > 0.0, 1.0 / np.sqrt(np.where(w2 > 0.0, w2, 1.0)), 0.0)
    box = lambda x: x.reshape(BOXES, points, BOXES, points).sum(axis=(1, 3))
    f, t, area = box(table.at(u, v) * solid), box(intensity(target, u, v) * solid), box(solid)
    there = area > 0.01 * area.max()
    f, t = (x[there] / np.sqrt(area[there]) for x in (f, t))
    scale = (f @ t) / (f @ f)
    return float(np.linalg.norm(scale * f - t) / np.linalg.norm(t))


def sampled(target, is_round, goal=5e-4):
    """The coarsest of a row of tables that is as near to the target as `goal`, else the finest; and its error."""
    if target["function"] == "table":
        table = Table(target, target["c_step_deg"], target["gamma_step_deg"])
        return table, sampling_error(target, table)
    steps = [(0.0, 0.1)] if is_round else [(2.0, 1.0), (2.0, 0.5), (1.0, 0.5), (1.0, 0.25), (0.5, 0.25)]
    for c_step_deg, gamma_step_deg in steps:
        table = Table(target, c_step_deg, gamma_step_deg)
        error = sampling_error(target, table)
        if error <= goal:
            break
    return table, error


def lit_cells(target, half_mm, cells, parts=8):
    """Mean illuminance of the cells of a window (half its sides, as many cells along each). Rows are along y, their cells
    along x."""
    x, y = ((np.arange(cells * parts) + 0.5) * 2.0 * half / (cells * parts) - half for half in half_mm)
    return illuminance(target, x, y[:, None]).reshape(cells, parts, cells, parts).mean(axis=(1, 3))


def csv(cells):
    """Lucerna's table of a plane, whose first row is that of the highest y."""
    return "".join(",".join(f"{x:.6g}" for x in row) + "\n" for row in cells[::-1])
