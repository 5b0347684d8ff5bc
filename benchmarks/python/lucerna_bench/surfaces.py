# SPDX-License-Identifier: Apache-2.0
"""Surfaces of submissions: functions become B-spline surfaces (see "Surfaces" in benchmarks/README.md)."""
import numpy as np


def _knots(low, high, intervals, degree):
    inner = np.linspace(low, high, intervals + 1)
    return np.concatenate([np.full(degree, low), inner, np.full(degree, high)])


def _basis(knots, degree, x):
    """Row k has the values of all B-splines at x[k] (Cox and de Boor)."""
    x = np.clip(np.asarray(x, float), knots[degree], knots[-degree - 1])
    count = len(knots) - degree - 1
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, count - 1)
    rows = np.zeros((len(x), len(knots) - 1))
    rows[np.arange(len(x)), span] = 1.0
    for q in range(1, degree + 1):
        raised = np.zeros_like(rows)
        for i in range(len(knots) - q - 1):
            left, right = knots[i + q] - knots[i], knots[i + q + 1] - knots[i + 1]
            if left > 0.0:
                raised[:, i] += (x - knots[i]) / left * rows[:, i]
            if right > 0.0:
                raised[:, i] += (knots[i + q + 1] - x) / right * rows[:, i + 1]
        rows = raised
    return rows[:, :count]


def _greville(knots, degree):
    count = len(knots) - degree - 1
    return np.array([knots[i + 1 : i + degree + 1].mean() for i in range(count)])


def _surface(degrees, knots_u, knots_v, points, **more):
    return {"format": "lucerna-bench-surface", "version": 1, "degree": list(degrees),
            "knots_u": [float(k) for k in knots_u], "knots_v": [float(k) for k in knots_v],
            "points_mm": np.asarray(points, float).tolist(), **more}


def height_field(height_mm, half_x_mm, half_y_mm, intervals=(16, 16), degree=3, trim=None):
    """The surface z = height_mm(x, y) over |x| <= half_x_mm, |y| <= half_y_mm, as a B-spline that goes through
    the function at its Greville points. `height_mm` takes numpy arrays. Its normal looks towards +z. `trim` is
    what is kept of it: {"kind": "circle", "diameter_mm": 100, "hole_diameter_mm": 8} or {"kind": "rectangle",
    "size_mm": [80, 60]}; without it all is. Polynomials of the degree in x and y come out exactly."""
    ku, kv = _knots(-half_x_mm, half_x_mm, intervals[0], degree), _knots(-half_y_mm, half_y_mm, intervals[1], degree)
    gx, gy = _greville(ku, degree), _greville(kv, degree)
    x, y = np.meshgrid(gx, gy, indexing="ij")
    z = np.asarray(height_mm(x, y), float) + np.zeros_like(x)
    if not np.all(np.isfinite(z)):
        raise ValueError("height_mm: found a height that is not finite, expected finite heights over the rectangle")
    over_x = np.linalg.solve(_basis(ku, degree, gx), z)
    heights = np.linalg.solve(_basis(kv, degree, gy), over_x.T).T
    # x and y themselves are splines whose coefficients are the Greville points.
    points = np.stack([x, y, heights], axis=-1)
    return _surface((degree, degree), ku, kv, points, **({"trim": trim} if trim else {}))


def extruded_profile(height_mm, half_x_mm, half_y_mm=1.0, intervals=32, degree=3):
    """The trough z = height_mm(x) over |x| <= half_x_mm, straight along y: two-dimensional tasks (LB-1)."""
    ku = _knots(-half_x_mm, half_x_mm, intervals, degree)
    gx = _greville(ku, degree)
    z = np.linalg.solve(_basis(ku, degree, gx), np.asarray(height_mm(gx), float) + np.zeros_like(gx))
    rows = [[[x, y, h] for y in (-half_y_mm, half_y_mm)] for x, h in zip(gx, z)]
    return _surface((degree, 1), ku, _knots(-half_y_mm, half_y_mm, 1, 1), rows)


def spline_through(at, values, flat_start=False, natural_start=False):
    """Knots and coefficients of the C2 cubic spline through `values` at the ascending places `at`. The end, and the
    start where nothing else is asked for, is not-a-knot: the second place is no knot (C. de Boor, A Practical
    Guide to Splines, 1978, chapter IV). `flat_start`: slope 0 there; `natural_start`: no curvature. Three places or
    more, four where both ends are not-a-knot."""
    at, values = np.asarray(at, float), np.asarray(values, float)
    held = flat_start or natural_start
    if len(at) < (3 if held else 4) or np.any(np.diff(at) <= 0.0):
        raise ValueError(f"at: found {at.tolist()}, expected {3 if held else 4} ascending numbers or more")
    inner = at[1:-2] if held else at[2:-2]
    knots = np.concatenate([np.full(4, at[0]), inner, np.full(4, at[-1])])
    system, right = _basis(knots, 3, at), values
    if held:
        # At a clamped end the slope is 3 (c1 - c0) / (t4 - t1), the curvature the same of the slope's coefficients.
        first = np.zeros((2, len(at) + 1))
        for i in range(2):
            first[i, [i, i + 1]] = np.array([-3.0, 3.0]) / (knots[i + 4] - knots[i + 1])
        row = first[0] if flat_start else 2.0 * (first[1] - first[0]) / (knots[4] - knots[2])
        system, right = np.vstack([row, system]), np.concatenate([[0.0], values])
    return knots, np.linalg.solve(system, right)


def revolved(knots, points_rz_mm, degree=3):
    """The surface that a curve in the half plane (r, z) sweeps about the z axis: exact circles, four rational
    quarters. The curve is a B-spline of these knots and points. The normal looks to the right of the curve as it
    goes: outwards where it rises."""
    turn = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    weight = [1.0 if k % 2 == 0 else np.sqrt(0.5) for k in range(9)]
    points = [[[r * x, r * y, z] for r, z in points_rz_mm] for x, y in turn]
    weights = [[w] * len(points_rz_mm) for w in weight]
    return _surface((2, degree), [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], knots, points, weights=weights)


def heights_at(surface, x, y):
    """Heights of a surface that `height_field` or `extruded_profile` made, or any whose x is u and whose y is v,
    at the places (x[k], y[k])."""
    (p, q), z = surface["degree"], np.asarray(surface["points_mm"], float)[:, :, 2]
    over_x = _basis(np.asarray(surface["knots_u"], float), p, np.ravel(x)) @ z
    return np.sum(over_x * _basis(np.asarray(surface["knots_v"], float), q, np.ravel(y)), axis=1).reshape(np.shape(x))


def cylinder_wall(radius_mm, low_mm, high_mm):
    """The wall of a round solid about z from low_mm to high_mm: an exact circle as a rational B-spline of degree
    2 in four quarters. Its normal looks outwards."""
    return revolved([0, 0, 1, 1], [(radius_mm, low_mm), (radius_mm, high_mm)], degree=1)


def wall_below(face, radius_mm, low_mm, places=480):
    """The wall of a solid about z from low_mm up to the rim of a height field that is trimmed to this radius. Its
    normal looks outwards. Circle and rim are cubic splines through as many places: within 1e-7 of the radius, and of
    the rim's height where the field is smooth."""
    turn = np.linspace(0.0, 2.0 * np.pi, places + 1)
    x, y = radius_mm * np.cos(turn), radius_mm * np.sin(turn)
    knots, x_points = spline_through(turn, x)
    (_, y_points), (_, z_points) = (spline_through(turn, values) for values in (y, heights_at(face, x, y)))
    rows = [[[a, b, low_mm], [a, b, c]] for a, b, c in zip(x_points, y_points, z_points)]
    return _surface((3, 1), knots, _knots(0.0, 1.0, 1, 1), rows)


def placed(origin_mm=(0.0, 0.0, 0.0), z_axis=(0.0, 0.0, 1.0), x_axis=(1.0, 0.0, 0.0)):
    """Where a surface's own frame is in that of the task."""
    return {"origin_mm": list(origin_mm), "x_axis": list(x_axis), "z_axis": list(z_axis)}
