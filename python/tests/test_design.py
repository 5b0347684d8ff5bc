# SPDX-License-Identifier: Apache-2.0
"""Designs and the objective: found, watched, stopped, resumed, handed to scipy."""
import os
import signal

import lucerna as lu
import numpy as np
import pytest


def spot(half_deg=10.0):
    gamma = np.arange(0, 181, 1.0)
    return lu.IntensityDistribution([0], gamma, [np.where(gamma < 4 * half_deg,
                                                          1000 * np.exp2(-((gamma / half_deg) ** 2)), 0)])


def lamp(family="revolution", **design):
    mirror = dict(preset="parabola") if family == "revolution" else {}
    return lu.Scene([{"kind": "disk", "radius_mm": 1}], reflectors=[lu.Reflector(
        family, focal_mm=8, diameter_mm=60, position_mm=[0, 0, 8], axis="-z", **mirror)],
        target=spot(), design={"time_s": 1000, **design})


@pytest.fixture(scope="module")
def found():
    return lu.design(lamp(restarts=0), max_rays=16384)


def test_a_design_is_better_than_its_start(found):
    assert found.end == "converged" and not found.interrupted
    assert found.relative_rms.value < 0.2 * found.start_error.c48.excess.value
    assert found.relative_rms == found.error.c48.excess and found.floor == found.error.c48.floor
    assert isinstance(found.efficiency, lu.Estimate) and 0.9 < found.efficiency.value <= 1.001
    assert found.history.rays[-1] <= found.rays and len(found.history.relative_rms) == len(found.history.accepted)
    light = found.traced["far"] if "far" in found.traced else found.traced[found.traced.detectors[0]]
    assert lu.compare(spot(), light.scaled(1)).overlap.value > 0.8


def test_a_lens_is_designed_and_read_back(found, tmp_path):
    assert found.lens is None
    keys = dict(role="solid", name="lens", outline_mm=[[0, 3], [9, 3], [9, 5], [6, 7.6], [3, 9.1], [0, 9.6]], axis="-z")
    lamp = lu.Scene([{"kind": "disk", "radius_mm": 0.5, "axis": "-z"}], bodies=[{**keys, "material": "pmma"}],
                    target=spot(), design={"free_sides": 2, "intervals": 6, "time_s": 1000, "restarts": 0})
    made = lu.design(lamp, max_rays=16384)
    assert made.relative_rms.value < made.start_error.c48.excess.value
    lens = made.lens
    assert lens.name == "lens" and not lens.has_face and 1.49 < lens.refractive_index < 1.5
    assert lens.outline_mm.shape[1] == 2 and lens.outline_mm[:, 0].max() == 9
    # Closed: every edge belongs to two triangles, once in each direction.
    edges = np.concatenate([lens.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    assert {tuple(e) for e in edges} == {tuple(e[::-1]) for e in edges} and len({tuple(e) for e in edges}) == len(edges)
    assert np.hypot(*lens.vertices_mm[:, :2].T).max() == pytest.approx(9, rel=1e-6)
    assert made.reflector is None
    np.testing.assert_allclose([*lens.axis, *lens.position_mm], [0, 0, -1, 0, 0, 0], atol=1e-12)
    assert "lens.step" in made.save(tmp_path)
    assert made.scene.tables["body"][0]["outline_mm"] == lens.outline_mm.tolist()


def test_its_convergence_is_drawn(found):
    import matplotlib.pyplot as plt

    ax = found.plot()
    ax.figure.canvas.draw()
    error, floor = ax.lines
    assert np.array_equal(error.get_ydata(), 100 * found.history.relative_rms)
    assert np.array_equal(floor.get_ydata(), 100 * found.history.floor)
    assert ax.get_yscale() == "log" and (ax.get_xlabel(), ax.get_ylabel()) == ("rays", "%")
    plt.close("all")


def test_its_mirror_is_that_of_its_scene(found, tmp_path):
    again = found.scene.trace(rays=found.traced.rays, seed=found.traced.seed)
    assert again == found.traced
    found.reflector.save(tmp_path / "mirror.step")
    found.save(tmp_path / "folder")
    names = {p.name for p in (tmp_path / "folder").iterdir()}
    assert {"reflector.step", "reflector.stl", "history.csv", "checkpoint", "result.json"} <= names
    found.report(tmp_path / "design.html")
    assert "<html" in (tmp_path / "design.html").read_text()


def test_a_design_goes_on_to_the_same_bits(found, tmp_path):
    same = lu.design(lamp(restarts=0), max_rays=16384, resume=found)
    assert same.scene.to_toml() == found.scene.to_toml()
    found.save(tmp_path / "folder")
    assert lu.design(lamp(restarts=0), max_rays=16384, resume=tmp_path / "folder").scene == same.scene
    with pytest.raises(lu.InputError):
        lu.design(lamp(restarts=0), max_rays=16384, seed=2, resume=found)
    with pytest.raises(lu.InputError):
        lu.design(lamp(restarts=0), max_rays=16384, resume=b"nonsense")


def test_limits_target_and_keys_replace_those_of_the_scene():
    found = lu.design(lamp(), target=spot(15), limits=dict(max_height_mm=25), max_rays=16384, time_s=2, restarts=0)
    (limit,) = found.limits
    assert limit.limit == "max_height_mm" and limit.held and limit.found.value <= 25.01
    assert found.scene.tables["design"]["limits"] == {"max_height_mm": 25}
    with pytest.raises(lu.InputError, match="max_height") as caught:
        lu.design(lamp(), limits=dict(max_hight_mm=25))
    assert caught.value.place.endswith("design.limits.max_hight_mm")


def test_ctrl_c_returns_the_best_so_far():
    steps = []

    def press(step):
        steps.append(step)
        if "relative_rms" in step and len(steps) < 1000:
            steps.extend([step] * 1000)
            os.kill(os.getpid(), signal.SIGINT)

    found = lu.design(lamp("bspline"), max_rays=2**16, callback=press)
    assert found.interrupted and found.end == "interrupted"
    assert found.relative_rms.value <= found.start_error.c48.excess.value + 0.01


@pytest.mark.parametrize("scene", ["lamp.toml", None, {"kind": "disk"}])
def test_what_is_no_scene_is_named(scene):
    for use in (lu.design, lu.Objective):
        with pytest.raises(TypeError, match=f"found a {type(scene).__name__}, expected a Scene"):
            use(scene)


@pytest.mark.parametrize("keys", [dict(time_s=-1), dict(max_rays=5), dict(device="x"), dict(optimizer="x"),
                                  dict(target="none.ldt"), dict(seed=-1)])
def test_bad_calls_are_refused(keys):
    with pytest.raises((lu.InputError, OSError, TypeError)):
        lu.design(lamp(), **keys)


def test_the_jacobian_is_exact():
    f = lu.Objective(lamp("bspline", intervals=3), rays=16384, rim_mm=0)
    x = np.array(f.x0)
    residuals, jacobian = f(x)
    assert f.shape == jacobian.shape == (len(residuals), len(x))
    np.testing.assert_array_equal(f.residuals(x), residuals)
    np.testing.assert_array_equal(f.jacobian(x), jacobian)
    way = np.random.default_rng(1).standard_normal(len(x))
    slope = (f.residuals(x + 1e-7 * way) - f.residuals(x - 1e-7 * way)) / 2e-7
    assert np.linalg.norm(slope - jacobian @ way) < 1e-4 * np.linalg.norm(slope)
    assert f.metrics(x).relative_rms == pytest.approx(np.sqrt((residuals[:-1] ** 2).sum()))


def test_scipy_finds_a_mirror():
    from scipy.optimize import least_squares

    f = lu.Objective(lamp(intervals=6), rays=65536)
    solution = least_squares(f.residuals, f.x0, jac=f.jacobian, max_nfev=30)
    before, after = f.metrics(f.x0).relative_rms, f.metrics(solution.x).relative_rms
    assert after < 0.2 * before
    assert f.reflector(solution.x).height_mm(0, 0) == f.scene(solution.x).reflectors[0].height_mm(0, 0)


@pytest.mark.parametrize("x", [[1.0], np.full(18, np.nan), np.zeros((18, 1)), "x", None])
def test_bad_parameters_are_refused(x):
    f = lu.Objective(lamp(), rays=8192)
    with pytest.raises((lu.InputError, TypeError)):
        f(x)


def test_objectives_refuse_what_cannot_be_designed():
    for make in (lambda: lu.Objective(lu.Scene([{"kind": "disk"}])), lambda: lu.Objective(lamp(), rays=0),
                 lambda: lu.Objective(lamp(), rim_mm=-1), lambda: lu.Objective(lamp(), "none.ldt")):
        with pytest.raises((lu.InputError, OSError)):
            make()
