# SPDX-License-Identifier: Apache-2.0
"""B-spline surfaces from functions, evaluated here by de Boor's algorithm, which the package does not use."""
import numpy as np
import pytest
from lucerna_bench import cylinder_wall, extruded_profile, height_field, stl


def de_boor(knots, degree, coefficients, x):
    k = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, len(coefficients) - 1)
    d = [np.asarray(coefficients[k - degree + i], float) for i in range(degree + 1)]
    for r in range(1, degree + 1):
        for i in range(degree, r - 1, -1):
            low, high = knots[k - degree + i], knots[k + 1 + i - r]
            share = (x - low) / (high - low)
            d[i] = (1.0 - share) * d[i - 1] + share * d[i]
    return d[degree]


def at(surface, u, v):
    points = np.asarray(surface["points_mm"], float)
    if "weights" in surface:
        w = np.asarray(surface["weights"], float)[:, :, None]
        points = np.concatenate([points * w, w], axis=-1)
    rows = np.array([de_boor(np.asarray(surface["knots_v"], float), surface["degree"][1], row, v) for row in points])
    p = de_boor(np.asarray(surface["knots_u"], float), surface["degree"][0], rows, u)
    return p[:3] / p[3] if "weights" in surface else p


PLACES = [(-20.0, -10.0), (-3.3, 7.7), (0.0, 0.0), (11.0, -9.99), (20.0, 10.0)]


def test_polynomials_are_exact():
    surface = height_field(lambda x, y: 1 + x - 0.02 * x * y + 1e-3 * x**3 + y**2, 20.0, 10.0, intervals=(3, 5))
    for x, y in PLACES:
        expected = [x, y, 1 + x - 0.02 * x * y + 1e-3 * x**3 + y**2]
        assert np.allclose(at(surface, x, y), expected, rtol=0, atol=1e-10)


def test_other_functions_converge_with_the_fourth_power():
    def worst(n):
        surface = height_field(lambda x, y: np.sin(0.2 * x) * np.cos(0.1 * y), 20.0, 10.0, intervals=(n, n))
        return max(abs(at(surface, x, y)[2] - np.sin(0.2 * x) * np.cos(0.1 * y))
                   for x in np.linspace(-19, 19, 23) for y in np.linspace(-9, 9, 17))

    assert worst(40) < worst(20) / 10


def test_extruded_profile_is_straight_along_y():
    surface = extruded_profile(lambda x: 15.0 - x**2 / 60.0, 20.0, intervals=8)
    for y in (-1.0, 0.3, 1.0):
        assert np.allclose(at(surface, 7.0, y), [7.0, y, 15.0 - 49.0 / 60.0], rtol=0, atol=1e-12)


def test_wall_is_round():
    surface = cylinder_wall(5.0, 1.0, 3.0)
    for u in np.linspace(0.0, 4.0, 33):
        p = at(surface, u, 0.25)
        assert np.hypot(p[0], p[1]) == pytest.approx(5.0, abs=1e-12)
        assert p[2] == pytest.approx(1.5)


def test_heights_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="not finite"):
        height_field(lambda x, y: np.where(x < 0, np.nan, x), 1.0, 1.0)


def test_triangles_cover_a_disk_with_normals_up(tmp_path):
    t = stl.disk_triangles(lambda x, y: 0.01 * (x * x + y * y), 30.0, rings=20, sectors=40)
    normals = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    # The area of a regular polygon of 40 corners.
    assert np.sum(normals[:, 2]) / 2 == pytest.approx(0.5 * 40 * 30.0**2 * np.sin(2 * np.pi / 40), rel=1e-12)
    assert np.all(normals[:, 2] > 0.0)
    assert np.allclose(t[..., 2], 0.01 * (t[..., 0] ** 2 + t[..., 1] ** 2))
    stl.write_stl(tmp_path / "disk.stl", t)
    data = (tmp_path / "disk.stl").read_bytes()
    assert len(data) == 84 + 50 * len(t) and int.from_bytes(data[80:84], "little") == len(t)
    assert np.frombuffer(data[84 + 50 * 7 + 12:84 + 50 * 7 + 48], "<f4") == pytest.approx(t[7].ravel(), rel=1e-6)
