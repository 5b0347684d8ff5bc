# SPDX-License-Identifier: Apache-2.0
"""Optics of few numbers, as surfaces of submissions: plain ones, and splines over them for optimisers."""
import numpy as np

from .surfaces import _basis, _greville, _knots, extruded_profile, height_field, placed, revolved

DOWN = (0.0, 0.0, -1.0)
LENS_INDEX = 1.4925
# A lens stands this far within its room: places are checked to about a hundredth of a millimetre.
MARGIN_MM = 0.02


class Mirror:
    """A free mirror above the source: a paraboloid with its focus in the source, and a bicubic spline of heights over
    it. Parameters: the spline's coefficients, mm."""

    def __init__(self, task, focal_mm, intervals=3):
        self.room, self.focal_mm, self.intervals = task.room, focal_mm, intervals
        self.size = (intervals + 3) ** 2
        self.scale_mm = 0.02 * task.room.half_mm

    def surfaces(self, heights_mm=None):
        half = self.room.half_mm
        bowl = height_field(lambda x, y: (x * x + y * y) / (4.0 * self.focal_mm), half, half,
                            intervals=(self.intervals, self.intervals),
                            trim={"kind": "circle", "diameter_mm": 2 * half})
        if heights_mm is not None:
            points = np.asarray(bowl["points_mm"])
            points[:, :, 2] += np.reshape(heights_mm, points.shape[:2])
            bowl["points_mm"] = points.tolist()
        return [mirror(bowl, self.focal_mm)]


class Trough:
    """A trough above the source: a parabola about it, and a cubic spline of x over it."""

    def __init__(self, task, focal_mm, intervals=8):
        self.room, self.focal_mm, self.intervals = task.room, focal_mm, intervals
        self.size = intervals + 3
        self.scale_mm = 0.02 * task.room.half_mm

    def surfaces(self, heights_mm=None):
        sheet = extruded_profile(lambda x: x * x / (4.0 * self.focal_mm), self.room.half_mm, intervals=self.intervals)
        if heights_mm is not None:
            points = np.asarray(sheet["points_mm"])
            points[:, :, 2] += np.reshape(heights_mm, (-1, 1))
            sheet["points_mm"] = points.tolist()
        return [mirror(sheet, self.focal_mm)]


def mirror(sheet, vertex_mm):
    """A height field as the mirror at z = vertex_mm that opens to -z. (A trough along y may be turned so, too.)"""
    return {"name": "mirror", "role": "mirror", "bspline": sheet,
            "place": placed((0.0, 0.0, vertex_mm), z_axis=DOWN)}


class Lens:
    """A lens of revolution before a source that shines to +z: a flat face next to the source, a wall, and a cubic
    spline of the radius over a spherical cap. Parameters: the spline's coefficients from the rim to the axis; one for
    the last two, so that it is level there."""

    def __init__(self, task, cap_mm, intervals=8, wall_mm=2.0):
        self.room, self.cap_mm, self.intervals, self.wall_mm = task.room, cap_mm, intervals, wall_mm
        self.size = intervals + 2
        self.scale_mm = 0.02 * task.room.half_mm

    def surfaces(self, heights_mm=None):
        rim = self.room.half_mm - MARGIN_MM
        knots = _knots(0.0, rim, self.intervals, 3)
        # Greville points: the parameter is the way from the rim to the axis along the radius.
        way = _greville(knots, 3)
        sag = np.linalg.solve(_basis(knots, 3, way), cap_height(rim, self.cap_mm, rim - way))
        if heights_mm is not None:
            sag = sag + np.append(heights_mm, heights_mm[-1])
        sag[-2] = sag[-1]
        return lens_surfaces(self.room, knots, np.stack([rim - way, self.wall_mm + sag], axis=-1))


def cap_height(rim_mm, cap_mm, radius_mm):
    """Height over its rim of a spherical cap that is `cap_mm` high at the axis; 0 for a flat one."""
    if cap_mm == 0.0:
        return np.zeros_like(radius_mm)
    sphere = (rim_mm**2 + cap_mm**2) / (2.0 * cap_mm)
    return np.sqrt(sphere**2 - np.minimum(radius_mm, rim_mm) ** 2) - (sphere - cap_mm)


def lens_surfaces(room, knots, outer_rz_mm):
    """A closed lens: flat bottom, wall up to the first point of the outer face, outer face from the rim to the axis.
    Heights count from the bottom."""
    bottom, rim = room.low_mm + MARGIN_MM, outer_rz_mm[0][0]
    faces = {"bottom": revolved([0, 0, 1, 1], [(0.0, bottom), (rim, bottom)], degree=1),
             "wall": revolved([0, 0, 1, 1], [(rim, bottom), (rim, bottom + outer_rz_mm[0][1])], degree=1),
             "outer": revolved(knots, [(r, bottom + z) for r, z in outer_rz_mm])}
    return [{"name": name, "role": "interface", "bspline": face, "refractive_index": LENS_INDEX}
            for name, face in faces.items()]
