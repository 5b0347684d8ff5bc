# SPDX-License-Identifier: Apache-2.0
"""Every result goes to another process and back without loss."""
import concurrent.futures
import inspect
import multiprocessing
import pickle

import lucerna as lu
import numpy as np
import pytest
from test_design import lamp as design_lamp

FINDINGS = ["error", "start_error", "relative_rms", "floor", "efficiency", "end", "interrupted", "zones", "limits",
            "bound", "remarks", "pareto", "advice", "tolerances", "lens", "evaluations", "rays", "checkpoint"]


@pytest.fixture(scope="module")
def found():
    return lu.design(design_lamp(restarts=0), max_rays=16384)


@pytest.fixture(scope="module")
def objective():
    return lu.Objective(design_lamp(intervals=3), rays=16384, seed=5, rim_mm=0.1)


@pytest.fixture(scope="module")
def pool():
    with concurrent.futures.ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as one:
        yield one


def same(thing):
    return thing


def evaluate(objective, x):
    return objective(x)


def report(found, path):
    found.report(path)
    return found.relative_rms, found.traced["far-field"].cd, len(found.history.rays)


FUNCTIONS = [*(getattr(lu, name) for name in lu.__all__ if inspect.isroutine(getattr(lu, name))),
             lu.RaySet.from_arrays, lu.Reflector.from_toml, lu.Scene.from_toml, lu.Scene.load]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__qualname__)
def test_functions_go_by_their_names(function):
    assert pickle.loads(pickle.dumps(function)) is function and function.__module__ == "lucerna"


def test_pools_map_functions(pool, rays, tmp_path):
    rays.save(tmp_path / "a.tm25ray")
    (back,) = pool.map(lu.read_rays, [tmp_path / "a.tm25ray"])
    np.testing.assert_array_equal(back.position_mm, rays.position_mm)


def test_a_design_keeps_its_figures_and_files(found, pool, tmp_path):
    back = pool.submit(same, found).result()
    for name in FINDINGS:
        np.testing.assert_equal(getattr(back, name), getattr(found, name), err_msg=name)
    for name, values in found.history.items():
        np.testing.assert_array_equal(back.history[name], values)
    assert back.scene == found.scene and back.traced == found.traced and back.reflector == found.reflector
    assert back.save(tmp_path / "back") == found.save(tmp_path / "found")
    names = sorted(p.name for p in (tmp_path / "found").iterdir())
    assert sorted(p.name for p in (tmp_path / "back").iterdir()) == names
    for name in names:
        if name not in {"result.json", "project.toml"}:  # the date; names that are relative to the folder
            assert (tmp_path / "back" / name).read_bytes() == (tmp_path / "found" / name).read_bytes(), name
    again = pickle.loads(pickle.dumps(back))
    assert again.error == found.error
    again.error.clear()
    assert again.error == found.error, "what is returned is a copy"
    assert lu.design(design_lamp(restarts=0), max_rays=16384, resume=again).scene == found.scene


def test_a_design_is_used_in_another_process(found, pool, tmp_path):
    rms, cd, steps = pool.submit(report, found, tmp_path / "a.html").result()
    assert rms == found.relative_rms and steps == len(found.history.rays)
    np.testing.assert_array_equal(cd, found.traced["far-field"].cd)
    assert "<html" in (tmp_path / "a.html").read_text()


def test_an_objective_is_the_same_function(objective, pool):
    x = objective.x0 + 0.01
    residuals, jacobian = objective(x)
    there = pool.submit(evaluate, objective, x).result()
    np.testing.assert_array_equal(there[0], residuals)
    np.testing.assert_array_equal(there[1], jacobian)
    back = pickle.loads(pickle.dumps(objective))
    assert type(back) is lu.Objective and back.shape == objective.shape
    assert back.reflector(x) == objective.reflector(x)


def test_images_keep_everything(traced, pool):
    floor = traced["floor"]
    back = pool.submit(same, floor).result()
    assert back == floor and back is not floor
    for name in ("name", "unit", "flux", "mean", "min", "max", "uniformity", "peak_mm", "noise", "is_luminance"):
        assert getattr(back, name) == getattr(floor, name), name
    for name in ("value", "standard_error", "x_mm", "y_mm"):
        array = getattr(back, name)
        np.testing.assert_array_equal(array, getattr(floor, name))
        assert not array.flags.writeable
    assert floor != traced["far"]


def test_luminance_images_keep_their_observer(model):
    scene = lu.Scene([model], detectors=[lu.Detector("luminance", name="eye", from_mm=[0, 0, 500],
                                                     size_mm=[4, 4], cells=[4, 4])])
    eye = scene.trace(rays=20_000)["eye"]
    back = pickle.loads(pickle.dumps(eye))
    assert back.is_luminance and back.unit == eye.unit == "cd/m2" and back == eye


def test_traced_light_keeps_its_errors(traced, pool):
    far = traced["far"]
    back = pool.submit(same, far).result()
    assert back == far and isinstance(back.flux, lu.Estimate) and back.flux == far.flux
    assert str(back.metrics()) == str(far.metrics())
    assert isinstance(back.metrics().peak_cd, lu.Estimate)


@pytest.mark.parametrize("spoil", [lambda s: s[:-1], lambda s: (None, *s[1:]), lambda s: s[::-1], lambda s: ()])
def test_damaged_states_are_refused(spoil, found, objective, traced, rays):
    for thing in (found, objective, traced["floor"], rays, traced, traced.scene):
        cls = type(thing)
        with pytest.raises((lu.InputError, TypeError, ValueError, RuntimeError, OSError)):
            cls.__new__(cls).__setstate__(spoil(thing.__getstate__()))
