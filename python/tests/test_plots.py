# SPDX-License-Identifier: Apache-2.0
"""Plots: each kind draws what it should, with its units."""
import re

import lucerna as lu
import matplotlib.pyplot as plt
import numpy as np
import pytest
from conftest import parabola


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def draw(ax):
    ax.figure.canvas.draw()
    return ax


@pytest.mark.parametrize("kind", ["polar", "cartesian", "isocandela", "false-colours"])
def test_light(traced, kind):
    for light in (traced["far"], traced["far"].scaled(0)):
        ax = draw(light.plot(kind))
        assert "cd" in ax.get_title() + ax.get_ylabel()


def test_curves_are_the_values(traced):
    light = traced["far"]
    ax = light.plot("cartesian")
    x, y = ax.lines[0].get_data()
    at = np.searchsorted(x, 10.0)
    assert y[at] == pytest.approx(float(light.at(0, x[at])))
    assert len(ax.collections) == 2, "bands of 95 %"


def test_planes_models_and_mirrors(traced, model):
    assert draw(traced["floor"].plot()).get_xlabel() == "x, mm"
    assert "mm² sr" in draw(model.plot()).get_xlabel()
    draw(model.plot("luminance"))
    for kind in ("sag", "curvature", "profile"):
        assert "mm" in draw(parabola().plot(kind)).get_xlabel()


def test_every_kind_that_is_documented_is_drawn(traced, model):
    for thing, count in (traced["far"], 4), (model, 2), (parabola(), 3):
        kinds = re.findall(r"'([\w-]+)'", re.search(r"kind : str(.*)ax :", thing.plot.__doc__, re.S)[1])
        assert len(set(kinds)) == count
        for kind in kinds:
            draw(thing.plot(kind))


def test_a_luminance_image_is_drawn(model):
    lamp = lu.Scene([model], reflectors=[parabola()], detectors=[
        lu.Detector("luminance", name="seen", **{"from": [0, 0, -1]}, size_mm=[90, 90], cells=[20, 20])])
    ax = draw(lamp.trace(rays=50_000)["seen"].plot())
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x, mm", "y, mm")
    assert "cd/m" in "".join(a.get_ylabel() + a.get_title() for a in ax.figure.axes)


def test_curvature_of_a_sphere():
    # Equal focal lengths of 10 mm make a sphere of radius 20 mm... of a parabola: 1 / (2 f) at its vertex.
    image = parabola(hole_diameter_mm=0).plot("curvature").collections[0].get_array()
    assert np.nanmax(np.asarray(image.filled(np.nan))) == pytest.approx(1 / 30, rel=1e-3)


def test_axes_are_taken_and_kinds_checked(traced, model):
    ax = plt.figure().add_subplot()
    assert traced["floor"].plot(ax=ax) is ax
    for thing in (traced["far"], model, parabola()):
        with pytest.raises(lu.InputError, match="kind"):
            thing.plot("nonsense")
