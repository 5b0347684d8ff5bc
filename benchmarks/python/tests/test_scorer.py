# SPDX-License-Identifier: Apache-2.0
"""The program from the command line, the adapter, and the scorer against the program lucerna."""
import csv
import json
import pathlib
import struct
import subprocess
import sys

import numpy as np
import pytest
from lucerna_bench import Entry, Stated, cylinder_wall, extruded_profile, height_field, placed, score, tracing, write_submission
from lucerna_bench.shapes import FreeLens
from lucerna_bench.tasks import read_task

import make_sources

RAYS = 49 * 16384  # a whole number of the scorer's runs
STATED = Stated(free_parameters=1, wall_s=2.0, program="p", method="m", machine="box")
DOWN = (0.0, 0.0, -1.0)


def bowl(focal_mm, diameter_mm):
    half = 0.5 * diameter_mm
    return height_field(lambda x, y: (x * x + y * y) / (4 * focal_mm), half, half, intervals=(1, 1), degree=2,
                        trim={"kind": "circle", "diameter_mm": diameter_mm})


def paraboloid(focal_mm=20.0, shift_mm=0.0):
    return [{"name": "mirror", "role": "mirror", "bspline": bowl(focal_mm, 100.0),
             "place": placed((shift_mm, 0, focal_mm), z_axis=DOWN)}]


def disk_task(optics, target):
    return {"format": "lucerna-bench-task", "version": 1, "task": "test", "title": "test",
            "source": {"emitter": "disk", "radius_mm": 1.0, "place": placed(), "blocks": False}, "optics": optics,
            "limits": [], "target": target, "headline": "error_48"}


MIRROR = {"roles": ["mirror"], "reflectance": 1.0}


def plane(z_mm, up, side_mm, cells=48):
    return {"kind": "plane", "place": placed((0, 0, z_mm), z_axis=(0, 0, up)), "function": "uniform_rectangle",
            "size_mm": [side_mm, side_mm], "cells": [cells, cells]}


def boxes_of(scorer, folder, task, surfaces, *options, rays=RAYS):
    """Shares and their standard errors in 48 x 48 boxes, and the score."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "task.json").write_text(json.dumps(task))
    file = write_submission(folder, task["task"], "n", "a", surfaces, STATED)
    subprocess.run([scorer, str(folder / "task.json"), str(file), "--rays", str(rays), "--json", str(folder / "s.json"),
                    "--boxes", str(folder / "b.csv"), *options], check=True, capture_output=True)
    with open(folder / "b.csv", encoding="ascii") as text:
        rows = list(csv.DictReader(text))
    column = lambda name: np.array([float(r[name]) for r in rows])
    return column("share"), column("standard_error"), json.loads((folder / "s.json").read_text())


def lucerna_plane(lucerna, folder, scene, side_mm, z_mm, up, cells=48):
    """Shares by cell on a plane, by the program lucerna with independent random rays."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    project = folder / "p.toml"
    project.write_text(f'[[source]]\nkind = "disk"\nradius_mm = 1.0\nflux_lm = 1000\n{scene}'
                       f'[[detector]]\nname = "floor"\nkind = "plane"\nposition_mm = [0, 0, {z_mm}]\n'
                       f'normal = "{up}"\nsize_mm = [{side_mm}, {side_mm}]\ncells = [{cells}, {cells}]\n')
    subprocess.run([lucerna, "trace", str(project), "-o", str(folder / "out"), "--rays", str(RAYS), "--sequence", "random",
                    "--quiet"], check=True, capture_output=True)
    with open(folder / "out" / "floor.csv", encoding="ascii") as text:
        rows = list(csv.DictReader(text))
    share = 1e-6 * (side_mm / cells) ** 2 / 1000.0  # lx to a share of 1000 lm
    return (np.array([float(r["illuminance_lx"]) for r in rows]) * share,
            np.array([float(r["standard_error_lx"]) for r in rows]) * share)


def deviation(a, b):
    """Of two sets of shares of RAYS rays: beyond 5 once in a million by chance."""
    return tracing.deviation(a, RAYS, b, RAYS)


def test_two_tracers_agree_on_a_mirror(scorer, lucerna, tmp_path):
    scene = ('[[reflector]]\nfamily = "revolution"\npreset = "parabola"\nfocal_mm = 20.0\ndiameter_mm = 100.0\n'
             'position_mm = [0.5, 0, 20]\naxis = "-z"\nreflectance = 1.0\n')
    task = disk_task(MIRROR, plane(-1000, 1, 120))
    ours, _, found = boxes_of(scorer, tmp_path / "a", task, paraboloid(shift_mm=0.5))
    side = found["rectangle"]["high"][0] - found["rectangle"]["low"][0]
    theirs, _ = lucerna_plane(lucerna, tmp_path / "l", scene, side, -1000, "+z")
    assert (theirs * RAYS >= 10).sum() > 500
    assert abs(deviation(ours, theirs)) < 5.0
    # What another place of the mirror would give is told apart.
    shifted, _, _ = boxes_of(scorer, tmp_path / "b", task, paraboloid(shift_mm=0.25))
    assert deviation(shifted, theirs) > 20.0


def test_two_tracers_agree_on_a_lens(scorer, lucerna, tmp_path):
    """A cylinder of glass: Fresnel, reflections within, total reflection at its wall."""
    glass = {"roles": ["interface"], "interface": {"model": "fresnel", "refractive_index": [1.5, 1.5],
                                                   "absorption_per_mm": 0.0}}
    flat = lambda x, y: 0.0 * x
    surfaces = [
        {"name": "bottom", "bspline": height_field(flat, 5.0, 5.0, intervals=(1, 1), degree=2,
                                                   trim={"kind": "circle", "diameter_mm": 10.0}),
         "place": placed((0, 0, 2.0), z_axis=DOWN)},
        {"name": "top", "bspline": height_field(flat, 5.0, 5.0, intervals=(1, 1), degree=2,
                                                trim={"kind": "circle", "diameter_mm": 10.0}),
         "place": placed((0, 0, 8.0))},
        {"name": "wall", "bspline": cylinder_wall(5.0, 2.0, 8.0)}]
    for s in surfaces:
        s.update(role="interface", refractive_index=1.5)
    ours, our_error, found = boxes_of(scorer, tmp_path / "a", disk_task(glass, plane(100, -1, 300)), surfaces)
    assert found["counts"]
    side = found["rectangle"]["high"][0] - found["rectangle"]["low"][0]
    scene = ('[[body]]\nrole = "solid"\nrefractive_index = 1.5\n'
             'outline_mm = [[0, 2], [5, 2], [5, 8], [0, 8]]\n')
    theirs, _ = lucerna_plane(lucerna, tmp_path / "l", scene, side, 100, "-z")
    total = ours.sum()
    assert 0.2 < total < 0.9
    assert abs(total - theirs.sum()) < 5.0 * np.sqrt(2.0 * total / RAYS)
    # The plane's frames differ by a turn: the scene is round, so rings are compared.
    centre = (np.arange(48) - 23.5) / 24.0
    ring = (12 * np.hypot(*np.meshgrid(centre, centre))).astype(int).ravel()
    sums = lambda share: np.bincount(ring, weights=share)
    a, b = sums(ours), sums(theirs)
    assert np.all(np.abs(a - b) < 5.0 * np.sqrt((a + b) / RAYS))


@pytest.mark.parametrize("name", ["LB-6-led-oval", "LB-6-filament-oval", "LB-3-rectangle"])
def test_frozen_rays_are_those_of_the_emitter(scorer, lucerna, tasks, tmp_path, name):
    """Files of lucerna against the scorer's own emitters, through a plain mirror."""
    given = json.loads((tasks / f"{name}.json").read_text())
    source = make_sources.read_sources()[given["frozen_source"]]
    make_sources.write_rays(lucerna, source, RAYS, tmp_path / "rays.tm25ray")
    task = {**disk_task(MIRROR, plane(-1000, 1, 600)), "source": given["source"]}
    fresh, _, _ = boxes_of(scorer, tmp_path / "a", task, paraboloid(shift_mm=0.5))
    read, _, found = boxes_of(scorer, tmp_path / "b", task, paraboloid(shift_mm=0.5), "--rays-from",
                              str(tmp_path / "rays.tm25ray"))
    assert found["rays"] == RAYS and found["rays_from"].endswith("rays.tm25ray")
    assert abs(deviation(fresh, read)) < 5.0
    moved, _, _ = boxes_of(scorer, tmp_path / "c", task, paraboloid(shift_mm=0.25))
    assert deviation(moved, read) > 10.0


def test_frozen_files_are_checked(tasks, tmp_path, monkeypatch, capsys):
    sources = make_sources.read_sources()
    named = {file.stem: json.loads(file.read_text()).get("frozen_source") for file in tasks.glob("*.json")}
    assert set(sources) == {name for name in named.values() if name}
    assert all((name is None) == task.startswith("LB-1") for task, name in named.items())
    files = make_sources.ray_files(sources)
    assert {frozen["rays"] for _, frozen in files.values()} == {10**6, 10**7} and len(files) == 2 * len(sources)
    (tmp_path / "led-1M.tm25ray").write_bytes(b"TM25" + bytes(100))
    monkeypatch.setattr("sys.argv", ["make_sources.py", "--out", str(tmp_path), "--files", "[lf]*-1M*"])
    assert make_sources.main() == 1
    said = capsys.readouterr().err
    monkeypatch.setattr("sys.argv", ["make_sources.py", "--out", str(tmp_path), "--files", "led-2M*"])
    assert make_sources.main() == 1
    assert "--files: found no file by led-2M*, expected some of" in capsys.readouterr().err
    monkeypatch.setattr("sys.argv", ["make_sources.py", "--out", str(tmp_path), "--freeze"])
    assert make_sources.main() == 1 and "--freeze: found no --lucerna" in capsys.readouterr().err
    assert "led-1M.tm25ray: rays: found SHA-256" in said and "filament-1M.tm25ray: file: found nothing, expected" in said


def test_frozen_led_has_its_hash(lucerna, tmp_path):
    source, frozen = make_sources.ray_files(make_sources.read_sources())["led-1M.tm25ray"]
    make_sources.write_rays(lucerna, source, frozen["rays"], tmp_path / "led.tm25ray")
    wrong, _ = make_sources.check(tmp_path / "led.tm25ray", frozen)
    assert wrong is None


def test_frozen_models_are_those_of_the_repository(tmp_path):
    for name, source in make_sources.read_sources().items():
        assert make_sources.check_model(name, source) is None
        (tmp_path / f"{name}.nfl").write_bytes(b"another")
        assert f"{name}.nfl: file: found SHA-256" in make_sources.check_model(name, source, tmp_path)


@pytest.mark.parametrize("name", ["led", "disk-5", "filament", "rectangle-1x1", "rectangle-2x2", "rectangle-3x3"])
def test_frozen_models_draw_the_light_of_the_emitter(scorer, lucerna, tasks, tmp_path, name):
    """Rays of the model against the scorer's own emitter, through a plain mirror that is not in focus."""
    task = next(d for file in sorted(tasks.glob("*.json")) if (d := json.loads(file.read_text())).get("frozen_source") == name)
    subprocess.run([lucerna, "sample", str(make_sources.SOURCES.parent / f"{name}.nfl"), "-n", str(RAYS), "--sequence",
                    "random", "--quiet", "-o", str(tmp_path / "rays.tm25ray")], check=True)
    scene = {**disk_task(MIRROR, plane(-1000, 1, 600)), "source": task["source"]}
    fresh, _, _ = boxes_of(scorer, tmp_path / "a", scene, paraboloid(shift_mm=0.5))
    drawn, _, _ = boxes_of(scorer, tmp_path / "b", scene, paraboloid(shift_mm=0.5), "--rays-from",
                           str(tmp_path / "rays.tm25ray"))
    moved, _, _ = boxes_of(scorer, tmp_path / "c", scene, paraboloid(shift_mm=0.25))
    assert abs(deviation(fresh, drawn)) < 5.0 < deviation(moved, drawn)


def stl_of(focal_mm, radius_mm, rings, sectors):
    """A paraboloid as a binary STL without stored normals."""
    def point(i, j):
        r, a = radius_mm * i / rings, 2 * np.pi * j / sectors
        return (r * np.cos(a), r * np.sin(a), r * r / (4 * focal_mm))

    facets = []
    for i in range(rings):
        for j in range(sectors):
            a, b, c, d = point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)
            facets += [(a, b, c)] + ([(a, c, d)] if i > 0 else [])
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in facets)
    return bytes(80) + struct.pack("<I", len(facets)) + body


def test_stl_with_interpolated_normals_is_the_spline(scorer, tmp_path):
    task = disk_task(MIRROR, plane(-1000, 1, 300))
    exact, _, _ = boxes_of(scorer, tmp_path / "a", task, paraboloid())
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "m.stl").write_bytes(stl_of(20.0, 50.0, 100, 300))
    part = {"name": "mirror", "role": "mirror", "stl": "m.stl", "place": placed((0, 0, 20), z_axis=DOWN)}
    smooth, _, _ = boxes_of(scorer, tmp_path / "b", task, [{**part, "normals": "interpolated"}], "--seed", "2")
    flat, _, _ = boxes_of(scorer, tmp_path / "b", task, [{**part, "normals": "facet"}], "--seed", "2")
    assert abs(deviation(exact, smooth)) < 5.0
    assert deviation(exact, flat) > 5.0  # facets of 0.6 degrees blur the beam


def run(scorer, *words):
    return subprocess.run([scorer, *map(str, words)], capture_output=True, text=True, check=False)


def test_same_bits_on_any_number_of_threads(scorer, tasks, tmp_path):
    file = write_submission(tmp_path, "LB-6-led-oval", "n", "a", paraboloid(), STATED)
    found = [score(scorer, tasks / "LB-6-led-oval.json", file, rays=200_000, threads=t) for t in (1, 2)]
    for f in found:
        assert f.pop("run")["threads"] in (1, 2)
    assert found[0] == found[1]
    assert found[0] != score(scorer, tasks / "LB-6-led-oval.json", file, rays=200_000, seed=2, threads=1)


def test_exit_codes_and_messages(scorer, tasks, tmp_path):
    task = tasks / "LB-6-led-oval.json"
    file = write_submission(tmp_path, "LB-6-led-oval", "n", "a", paraboloid(), STATED)
    good = run(scorer, task, file, "--rays", 20000)
    assert good.returncode == 0 and "error, 48 boxes a side" in good.stdout
    assert run(scorer, task).returncode == 2
    assert run(scorer, task, file, "--rays", "many").returncode == 2
    assert "found the unknown option --fast" in run(scorer, task, file, "--fast", "1").stderr
    outside = write_submission(tmp_path / "far", "LB-6-led-oval", "n", "a", paraboloid(focal_mm=45.0), STATED)
    does_not_count = run(scorer, task, outside, "--rays", 20000)
    assert does_not_count.returncode == 1
    assert "DOES NOT COUNT: limit inside_cylinder: found radius 50, z 31.1111, 45 mm" in does_not_count.stdout
    text = file.read_text()
    file.write_text(text.replace('"mirror"', '"miror"'))
    refused = run(scorer, task, file)
    assert refused.returncode == 1
    assert f'{file}: /surfaces/0/role: found "miror", expected one of mirror' in refused.stderr


def test_score_raises_with_the_words_of_the_program(scorer, tasks, tmp_path):
    file = write_submission(tmp_path, "LB-2a", "n", "a", paraboloid(), STATED)
    with pytest.raises(ValueError, match='/task: found "LB-2a", expected one of LB-6-led-oval'):
        score(scorer, tasks / "LB-6-led-oval.json", file, rays=20_000)


def test_an_optimiser_can_enter(scorer, tasks, tmp_path):
    """A flat trough is nearer to a wide beam than one that collimates; what is written scores what was found."""
    def surfaces(p):
        profile = extruded_profile(lambda x: 15.0 + p[0] * x * x, 20.0, intervals=4)
        return [{"name": "trough", "role": "mirror", "bspline": profile, "flip": True}]

    entry = Entry(tasks / "LB-1a-cos4-free.json", surfaces, scorer)
    flat, deep = (entry.cost([p], rays=100_000) for p in (0.0, -1 / 60))
    assert flat < deep / 2
    file = entry.write(tmp_path, [0.0], name="n", author="a", program="p", method="m")
    found = score(scorer, tasks / "LB-1a-cos4-free.json", file, rays=100_000)
    assert found["counts"] and found["stated"]["free_parameters"] == 1
    assert found["rsd"] is None and found["nmae"]["value"] > 0.0
    assert found["error_48"]["excess"] == pytest.approx(flat, abs=5 * found["error_48"]["standard_error"] + 0.01)


def test_costs_count_missing_light_and_faults(scorer, tasks):
    entry = Entry(tasks / "LB-6-led-oval.json", lambda p: paraboloid(focal_mm=p[0]), scorer)
    found = entry.figures([20.0], 20_000)
    error, missing = found["error_48"]["excess"], 1.0 - found["in_rectangle"]["value"]
    assert missing > 0.05
    assert entry.cost([20.0], 20_000) == error
    assert entry.cost([20.0], 20_000, light_weight=0.3) == pytest.approx((error**2 + 0.3 * missing**2) ** 0.5, rel=1e-12)
    assert not entry.figures([45.0], 20_000)["counts"] and entry.cost([45.0], 20_000) > 1.0


def test_costs_of_roads_see_the_way_to_their_limits(scorer, tasks):
    file = tasks / "LB-5b.json"
    entry = Entry(file, lambda p: FreeLens(read_task(file), p[0]).surfaces(), scorer)
    found = entry.figures([3.0], 20_000)
    assert [limit["held"] for limit in found["road"]["limits"]] == [False, False, True]
    road = {name: figure["value"] for name, figure in found["road"].items() if name != "limits"}
    assert not found["counts"] and found["error_48"] is None
    missed = (max(0.0, 1.0 - road["overall_uniformity"] / 0.4) + max(0.0, 1.0 - road["lengthwise_uniformity"] / 0.6)
              + max(0.0, road["threshold_increment"] / 0.15 - 1.0))
    assert missed > 0.1
    assert entry.cost([3.0], 20_000) == pytest.approx(1.0 - found["efficiency_with_losses"]["value"] + missed)
    # A lens that is too high is one more fault.
    assert entry.cost([13.5], 20_000) > 2.0 - entry.figures([13.5], 20_000)["efficiency_with_losses"]["value"]


def test_example_enters_the_plain_paraboloid(scorer, tasks, tmp_path):
    example = pathlib.Path(__file__).resolve().parents[1] / "examples" / "plain_paraboloid.py"
    task = tasks / "LB-6-led-oval.json"
    subprocess.run([sys.executable, str(example), "--scorer", scorer, "--task", str(task), "--out", str(tmp_path), "--rays",
                    "50000", "--steps", "3"], check=True, capture_output=True)
    found = score(scorer, task, tmp_path / "submission.json", rays=100_000)
    assert found["counts"] and found["stated"]["free_parameters"] == 1
    assert found["efficiency_with_losses"]["value"] <= 0.92
