# SPDX-License-Identifier: Apache-2.0
"""Optics of few numbers, as surfaces of submissions: plain ones, and splines over them for optimisers."""
import numpy as np

from .surfaces import _basis, _greville, _knots, _surface, extruded_profile, height_field, placed, revolved, wall_below

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
        return [mirror(_raised(bowl, heights_mm), self.focal_mm)]


class Trough:
    """A trough above the source: a parabola about it, and a cubic spline of x over it."""

    def __init__(self, task, focal_mm, intervals=8):
        self.room, self.focal_mm, self.intervals = task.room, focal_mm, intervals
        self.size = intervals + 3
        self.scale_mm = 0.02 * task.room.half_mm

    def surfaces(self, heights_mm=None):
        sheet = extruded_profile(lambda x: x * x / (4.0 * self.focal_mm), self.room.half_mm, intervals=self.intervals)
        return [mirror(_raised(sheet, heights_mm), self.focal_mm)]


def _raised(sheet, heights_mm):
    """A height field with these added to its coefficients, by rows along u; a trough has one a row. None adds none."""
    if heights_mm is None:
        return sheet
    points = np.asarray(sheet["points_mm"])
    points[:, :, 2] += np.reshape(heights_mm, (len(points), -1))
    return {**sheet, "points_mm": points.tolist()}


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


class FreeLens:
    """A lens before a source that shines to +z: a flat face next to the source, a wall, and a bicubic spline of
    heights over a spherical cap. Parameters: the spline's coefficients, mm."""

    def __init__(self, task, cap_mm, intervals=3, wall_mm=2.0):
        self.room, self.cap_mm, self.intervals, self.wall_mm = task.room, cap_mm, intervals, wall_mm
        self.size = (intervals + 3) ** 2
        self.scale_mm = 0.02 * task.room.half_mm

    def surfaces(self, heights_mm=None):
        rim = self.room.half_mm - MARGIN_MM
        bottom = self.room.low_mm + MARGIN_MM
        face = height_field(lambda x, y: bottom + self.wall_mm + cap_height(rim, self.cap_mm, np.hypot(x, y)), rim, rim,
                            intervals=(self.intervals, self.intervals), trim={"kind": "circle", "diameter_mm": 2 * rim})
        return free_lens_surfaces(_raised(face, heights_mm), rim, bottom)


class Horn:
    """Four walls from the source's rectangle to the target's: ruled between splines of both half widths over the
    height. Parameters: the splines' coefficients but for the first, mm."""

    def __init__(self, task, length_mm, intervals=3):
        self.length_mm, self.intervals = length_mm, intervals
        self.ends_mm = [(0.5 * a, 0.5 * b) for a, b in zip(task.source["size_mm"], task.target["size_mm"])]
        self.size = 2 * (intervals + 2)
        self.scale_mm = 0.05

    def surfaces(self, widths_mm=None):
        knots = _knots(0.0, self.length_mm, self.intervals, 3)
        at = _greville(knots, 3)
        halves = [a + (b - a) * at / self.length_mm for a, b in self.ends_mm]
        if widths_mm is not None:
            # Walls never meet.
            halves = [np.maximum(0.1, h + np.concatenate([[0.0], more])) for h, more in
                      zip(halves, np.reshape(widths_mm, (2, -1)))]
        return horn_walls(knots, at, *halves)


def horn_walls(knots, z_mm, half_x_mm, half_y_mm):
    """Mirrors that look inwards, whose edges meet in the corners."""
    walls = []
    # Along the height, then across: so turned that the normal looks inwards.
    for name, (ax, ay), (bx, by) in (("+x", (1, -1), (1, 1)), ("-x", (-1, 1), (-1, -1)), ("+y", (1, 1), (-1, 1)),
                                     ("-y", (-1, -1), (1, -1))):
        rows = [[[ax * x, ay * y, z], [bx * x, by * y, z]] for x, y, z in zip(half_x_mm, half_y_mm, z_mm)]
        walls.append({"name": name, "role": "mirror", "bspline": _surface((3, 1), knots, _knots(0.0, 1.0, 1, 1), rows)})
    return walls


def exit_place(walls, gap_mm=0.01):
    """Where a target stands before the end of a horn."""
    top = max(p[2] for wall in walls for row in wall["bspline"]["points_mm"] for p in row)
    return placed((0.0, 0.0, top + gap_mm), z_axis=DOWN)


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
    return [_interface(name, face, LENS_INDEX) for name, face in faces.items()]


def free_lens_surfaces(face, rim_mm, bottom_mm, refractive_index=LENS_INDEX, cavity=None, entry=None):
    """A closed lens: flat bottom, wall, and a height field trimmed to a circle as its outer face. `cavity`: knots and
    control points (r, z) of a curve from the axis to the bottom. `entry`: instead, a height field trimmed to a circle,
    and its radius; a wall joins its rim to the bottom."""
    from_mm = entry[1] if entry else 0.0 if cavity is None else cavity[1][-1][0]
    faces = {"bottom": revolved([0, 0, 1, 1], [(from_mm, bottom_mm), (rim_mm, bottom_mm)], degree=1),
             "wall": wall_below(face, rim_mm, bottom_mm), "outer": face}
    if cavity is not None:
        faces["cavity"] = revolved(*cavity)
    parts = [_interface(name, surface, refractive_index) for name, surface in faces.items()]
    if entry:
        inner = {"entry": entry[0], "inner wall": wall_below(entry[0], entry[1], bottom_mm)}
        parts += [{**_interface(name, surface, refractive_index), "flip": True} for name, surface in inner.items()]
    return parts


def _interface(name, surface, refractive_index):
    return {"name": name, "role": "interface", "bspline": surface, "refractive_index": refractive_index}
