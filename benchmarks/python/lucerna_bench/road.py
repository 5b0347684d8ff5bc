# SPDX-License-Identifier: Apache-2.0
"""Luminance of a road under a row of equal lamps, as benchmarks/README.md defines it: how bright light that comes to a
place is for the observers, and where a lamp's light should come to."""
import numpy as np

OBSERVER_MM = 60_000.0


class Road:
    """x along the road, y across it from the edge under the lamps, both in mm from the lamp's foot."""

    def __init__(self, target):
        self.height_mm = float(target["place"]["origin_mm"][2])
        self.spacing_mm, self.lanes, self.lane_mm = target["spacing_mm"], target["lanes"], target["lane_width_mm"]
        table = target["reflection"]
        self.tan_gamma, self.beta_deg = (np.array(table[name], float) for name in ("tan_gamma", "beta_deg"))
        self.reduced = 1e-4 * np.array(table["r_1e4"], float)
        # Over so much of the way to the next lamp a lamp's light falls as that one's rises.
        self.ramp_mm = 0.25 * self.spacing_mm

    @property
    def size_mm(self):
        """The rectangle that a lamp lights."""
        return [self.spacing_mm + self.ramp_mm, self.lanes * self.lane_mm]

    def luminance_coefficient(self, x, y, observer):
        """Luminance, for the observer in the middle of a lane, of illuminance from the lamp."""
        along = x % self.spacing_mm
        view = np.hypot(OBSERVER_MM + along, y - (observer + 0.5) * self.lane_mm)
        across = np.hypot(x, y)
        towards = -(x * (OBSERVER_MM + along) + y * (y - (observer + 0.5) * self.lane_mm))
        beta = np.degrees(np.arccos(np.clip(towards / np.maximum(1e-9, across * view), -1.0, 1.0)))
        tangent = across / self.height_mm
        i, s = _interval(self.tan_gamma, tangent)
        j, b = _interval(self.beta_deg, beta)
        r = ((1 - s) * ((1 - b) * self.reduced[i, j] + b * self.reduced[i, j + 1])
             + s * ((1 - b) * self.reduced[i + 1, j] + b * self.reduced[i + 1, j + 1]))
        return np.where(tangent > self.tan_gamma[-1], 0.0, r) * (1.0 + tangent**2) ** 1.5

    def share(self, x):
        """What of a place's luminance a lamp is to make: all of them together make 1."""
        return np.clip((0.5 * self.size_mm[0] - np.abs(x)) / self.ramp_mm, 0.0, 1.0)

    def illuminance(self, x, y):
        """Of the lamp, relative to that below it, that makes an even luminance for the mean of the observers."""
        coefficient = sum(self.luminance_coefficient(x, y, k) for k in range(self.lanes)) / self.lanes
        within = (coefficient > 0.0) & (y >= 0.0) & (y <= self.size_mm[1])
        return np.where(within, self.reduced[0, 0] * self.share(x) / np.where(within, coefficient, 1.0), 0.0)


def _interval(places, x):
    i = np.clip(np.searchsorted(places, x, side="right") - 1, 0, len(places) - 2)
    return i, np.clip((x - places[i]) / (places[i + 1] - places[i]), 0.0, 1.0)
