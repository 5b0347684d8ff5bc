# SPDX-License-Identifier: Apache-2.0
"""Zero-étendue solutions: with a point source they give the light that is asked for, with a wide one they do not."""
import json

import numpy as np
import pytest
from lucerna_bench import Entry, placed, point_source, shapes
from lucerna_bench.point_source import NoSolution
from lucerna_bench.tasks import read_task, source_directions

RAYS = 12 * 16384
# All of its light goes to the mirror: what falls on the target by itself is wrong whatever the mirror does.
POINT = {"emitter": "disk", "radius_mm": 0.01}
ROUND = {"kind": "far_field", "axis": "-z", "function": "round_gaussian_beam", "beam_deg": 40}
OVAL = {"kind": "far_field", "axis": "-z", "function": "gaussian_beam", "beam_x_deg": 60, "beam_y_deg": 35}

GLASS = {"roles": ["interface"], "interface": {"model": "fresnel", "refractive_index": [1.4925, 1.4925],
                                               "absorption_per_mm": 0.0}}


def task_of(folder, source, target, optics=None, limits=None):
    file = folder / "test.json"
    file.write_text(json.dumps({
        "format": "lucerna-bench-task", "version": 1, "task": "test", "title": "test",
        "source": {**source, "place": placed(), "blocks": False},
        "optics": optics or {"roles": ["mirror"], "reflectance": 1.0},
        "limits": limits or [{"kind": "inside_cylinder", "radius_mm": 50, "z_mm": [-30, 40]},
                             {"kind": "outside_sphere", "centre_mm": [0, 0, 0], "radius_mm": 3}],
        "target": target, "headline": "error_48"}))
    return read_task(file)


def figures(scorer, task, surfaces, rays=RAYS):
    found = Entry(task.file, lambda _: surfaces, scorer).figures([0], rays)
    assert found["counts"], found["faults"]
    return found


def error(scorer, task, surfaces):
    return figures(scorer, task, surfaces)["error_48"]["excess"]


def test_round_mirror_of_a_point(scorer, tmp_path):
    task = task_of(tmp_path, POINT, ROUND)
    mirror = point_source.round_mirror(task, 0, 20.0)
    found = figures(scorer, task, mirror)
    assert found["error_48"]["excess"] < 0.03
    # A plain paraboloid sends all of it to the middle; one that is moved by 1.5 mm is worse, too.
    assert error(scorer, task, shapes.Mirror(task, 20.0).surfaces()) > 0.5
    mirror[0]["place"] = placed((0.0, 0.0, 1.5))
    assert error(scorer, task, mirror) > 2.0 * found["error_48"]["excess"]


def test_free_mirror_of_a_point(scorer, tmp_path):
    """Soft paraboloids blur the light by a few degrees: 10 % at 48 boxes, against more than half for the plain one."""
    task = task_of(tmp_path, POINT, OVAL)
    assert error(scorer, task, point_source.free_mirror(task, 1, 30.0)) < 0.12
    assert error(scorer, task, shapes.Mirror(task, 30.0).surfaces()) > 0.5


def test_trough_of_a_narrow_strip(scorer, tmp_path):
    strip = {"emitter": "strip", "half_width_mm": 0.01, "right_to_left_luminance": 1.0}
    target = {"kind": "angle", "axis": "-z", "function": "cosine_power", "power": 4, "edge_deg": 40}
    room = [{"kind": "inside_box", "low_mm": [-20, -1, 12], "high_mm": [20, 1, 30]}]
    task = task_of(tmp_path, strip, target, limits=room)
    narrow = error(scorer, task, point_source.trough(task, 0, 16.0))
    assert narrow < 0.02
    wide = task_of(tmp_path, {**strip, "half_width_mm": 4.0}, target, limits=room)
    assert error(scorer, wide, point_source.trough(wide, 0, 16.0)) > narrow + 0.02


def test_lens_of_a_small_disk(scorer, tmp_path):
    target = {"kind": "plane", "place": placed((0, 0, 1000), z_axis=(0, 0, -1)), "function": "uniform_disk",
              "radius_mm": 1000, "cells": [50, 50]}
    room = [{"kind": "inside_cylinder", "radius_mm": 20, "z_mm": [0.01, 20]}]
    task = task_of(tmp_path, {"emitter": "disk", "radius_mm": 0.02}, target, GLASS, room)
    found = figures(scorer, task, point_source.round_lens(task, 0, 9.0))
    # Light that was reflected within the lens goes elsewhere: some per cent.
    assert found["error_48"]["excess"] < 0.08
    assert found["absorbed"]["wrong_side"]["value"] < 1e-4
    wide = task_of(tmp_path, {"emitter": "disk", "radius_mm": 5.0}, target, GLASS, room)
    assert error(scorer, wide, point_source.round_lens(wide, 0, 9.0)) > 0.2


def test_free_lens_of_a_small_square(scorer, tmp_path):
    """Nearly all of the light of a point comes to the rectangle, evenly but for its blurred edges; a wide source does
    not do it, and a plain lens has most of its light beside it."""
    target = {"kind": "plane", "place": placed((0, 0, 1000), z_axis=(0, 0, -1)), "function": "uniform_rectangle",
              "size_mm": [1200, 800], "cells": [60, 40]}
    room = [{"kind": "inside_cylinder", "radius_mm": 20, "z_mm": [0.01, 20]}]
    square = lambda mm: {"emitter": "rectangle", "size_mm": [mm, mm]}
    task = task_of(tmp_path, square(0.02), target, GLASS, room)
    found = figures(scorer, task, point_source.free_lens(task, 1, 9.0))
    assert found["error_12"]["excess"] < 0.25 and found["in_rectangle"]["value"] > 0.8
    assert found["absorbed"]["wrong_side"]["value"] < 1e-4
    assert figures(scorer, task, shapes.FreeLens(task, 9.0).surfaces())["in_rectangle"]["value"] < 0.6
    wide = task_of(tmp_path, square(6.0), target, GLASS, room)
    light = Entry(wide.file, lambda _: point_source.free_lens(wide, 1, 9.0), scorer).figures([0], RAYS)
    assert light["in_rectangle"]["value"] < 0.6


def test_horn_of_concentrators(scorer, tasks):
    """At a widening of 2 all light leaves within 30 degrees in both planes of walls; the task's target is wider than
    that. The walls reflect inside and not outside."""
    task = read_task(tasks / "LB-2a.json")

    def arrives(walls):
        found = Entry(task.file, lambda _: walls, scorer, target_place_of=shapes.exit_place).figures([0], RAYS)
        assert found["counts"], found["faults"]
        return found["efficiency_without_losses"]["value"]

    made = point_source.compound_parabolic_horn(task, 0, 2.6)
    good = arrives(made)
    assert good > 0.77 > arrives(shapes.Horn(task, 3.0).surfaces()) > 0.7
    for wall in made:
        wall["flip"] = True
    assert arrives(made) < 0.5 * good
    # At the end of a concentrator the walls are as wide as they should be, and level.
    z, half = point_source._concentrator(0.5, 2.0)
    assert z[0] == pytest.approx(0.0, abs=1e-12) and half[0] == pytest.approx(0.5)
    assert half[-1] == pytest.approx(1.0) and half[-1] - half[-2] < 1e-4
    assert z[-1] == pytest.approx(1.5 / np.tan(np.radians(30.0)))


def test_what_does_not_fit_is_no_solution(tmp_path):
    task = task_of(tmp_path, POINT, ROUND)
    with pytest.raises(NoSolution, match="expected Room"):
        point_source.round_mirror(task, 0, 45.0)
    bent = {"kind": "plane", "place": placed((0, 0, 1000), z_axis=(0, 0, -1)), "function": "uniform_disk",
            "radius_mm": 9000, "cells": [50, 50]}
    with pytest.raises(NoSolution, match="bent"):
        point_source.round_lens(task_of(tmp_path, {"emitter": "disk", "radius_mm": 1.0}, bent), 1, 9.0)


def test_transport_moves_all_weight(tmp_path):
    random = np.random.default_rng(1)
    a, b = random.random(60), random.random(50)
    a, b = a / a.sum(), b / b.sum()
    x, y = np.sort(random.random(60)), np.sort(random.random(50))
    cost = (x[:, None] - y) ** 2
    g, entropy = point_source.transport(1.0, a, b, cost, entropies=(0.1, 0.03, 0.01, 0.003, 0.001), rounds=2000)
    plan = np.exp((g - cost) / entropy)
    plan *= (a / plan.sum(axis=1))[:, None]
    assert np.abs(plan.sum(axis=0) - b).max() < 1e-6
    # On a line the cheapest way keeps the order: means of the plan's rows rise.
    mean = (plan @ y) / plan.sum(axis=1)
    assert np.all(np.diff(mean) > -1e-9)


@pytest.mark.parametrize("name", ["LB-6-led-oval", "LB-6-filament-oval"])
def test_directions_are_those_of_the_scorer(scorer, tasks, tmp_path, name):
    """Shares of the light in rings about -z, against a score without an optic in the way."""
    task = read_task(tasks / f"{name}.json")
    task.definition["source"]["place"]["z_axis"] = [0, 0, -1]
    task.definition["target"] = {"kind": "far_field", "axis": "-z", "function": "cosine_power", "power": 1,
                                 "edge_deg": 60}
    task.definition["limits"] = []
    (tmp_path / "t.json").write_text(json.dumps(task.definition))
    away = shapes.Mirror(read_task(tasks / f"{name}.json"), 20.0).surfaces()
    away[0]["place"]["origin_mm"] = [0, 0, 500.0]
    found = Entry(tmp_path / "t.json", lambda _: away, scorer).figures([0], RAYS)
    half = found["rectangle"]["high"][0]
    d = source_directions(task.source, 200_000, seed=3)
    inside = (d[:, 2] > 0) & (np.abs(d[:, 0]) < half) & (np.abs(d[:, 1]) < half)
    # The mirror far behind takes a per cent or two of what goes there, none of what is looked at.
    assert abs(inside.mean() - found["in_rectangle"]["value"]) < 5.0 * np.sqrt(0.25 / 200_000 + 0.25 / RAYS)
