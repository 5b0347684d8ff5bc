# SPDX-License-Identifier: Apache-2.0
"""Entries of Lucerna: projects of tasks, and the surfaces of what it designs."""
import json
import math
import re
import subprocess
import tomllib

import numpy as np
import pytest
from lucerna_bench import Entry, Stated, lucerna_entry, photometry, placed, score, write_submission
from lucerna_bench.shapes import Mirror
from lucerna_bench.surfaces import heights_at, revolved, spline_through
from lucerna_bench.tasks import intensity, read_task

from test_scorer import RAYS, boxes_of, deviation, disk_task, lucerna_plane, plane
from test_surfaces import at, de_boor

ENTERED = {"mirror": {"LB-6"}, "trough": {"LB-1"}, "lens": {"LB-3"}, "free-lens": {"LB-3", "LB-4", "LB-5"},
           "horn": {"LB-2"}}


def reflector_text(**keys):
    keys = {"family": '"bspline"', "position_mm": [0, 0, 20], "axis": '"-z"', **keys}
    return "[[reflector]]\n" + "".join(f"{k} = {v}\n" for k, v in keys.items())


def free_form(nx, ny, **keys):
    c = np.random.default_rng(3).normal(size=(nx + 3) * (ny + 3))
    text = reflector_text(focal_mm=17.0, intervals=[nx, ny], coefficients_mm=c.tolist(), **keys)
    return c.reshape(ny + 3, nx + 3), text


def even_knots(half, intervals):
    return -half + 2.0 * half / intervals * np.arange(-3, intervals + 4)


def places(half_x, half_y, count=300):
    return (np.random.default_rng(4).uniform(-1.0, 1.0, (2, count)).T * [half_x, half_y]).T


def test_free_form_is_the_very_surface():
    c, text = free_form(7, 5, aperture='"circle"', diameter_mm=100.0, hole_diameter_mm=8.0)
    (part,), free = lucerna_entry.surfaces_of(text, "mirror")
    assert free == 80 and part["place"] == placed((0, 0, 20), z_axis=(0, 0, -1))
    assert part["bspline"]["trim"] == {"kind": "circle", "diameter_mm": 100.0, "hole_diameter_mm": 8.0}
    x, y = places(50.0, 50.0)
    kx, ky = even_knots(50.0, 7), even_knots(50.0, 5)
    expected = [(a * a + b * b) / 68.0 + de_boor(ky, 3, [de_boor(kx, 3, row, a) for row in c], b) for a, b in zip(x, y)]
    assert np.abs(heights_at(part["bspline"], x, y) - expected).max() < 1e-11
    # The order of the coefficients matters.
    assert np.abs(heights_at(part["bspline"], y, x) - expected).max() > 0.1


def test_coefficients_that_a_symmetry_ties_count_once():
    c = np.random.default_rng(5).normal(size=(6, 7))
    across, along = c + c[:, ::-1], c + c[::-1]
    both = across + across[::-1]
    for table, count in ((c, 42), (across, 24), (along, 21), (both, 12)):
        found = lucerna_entry.free_coefficients({"intervals": [4, 3], "coefficients_mm": table.ravel().tolist()})
        assert found == count


def test_lucerna_itself_says_the_same_heights():
    lucerna = pytest.importorskip("lucerna")
    _, text = free_form(6, 9, aperture='"circle"', diameter_mm=100.0)
    (part,), _ = lucerna_entry.surfaces_of(text, "mirror")
    x, y = places(35.0, 35.0)
    assert np.abs(heights_at(part["bspline"], x, y) - lucerna.Reflector.from_toml(text).height_mm(x, y)).max() < 1e-11
    profile = [[0, 0], [5, 1], [11, 3], [18, 9], [25, 17], [31, 30]]
    text = reflector_text(family='"revolution"', profile_mm=profile)
    (part,), _ = lucerna_entry.surfaces_of(text, "mirror")
    mirror = lucerna.Reflector.from_toml(text)
    for v in np.linspace(0.0, 31.0, 41):
        x, y, z = at(part["bspline"], 0.7, v)
        assert z == pytest.approx(float(mirror.height_mm(x, y)), abs=1e-10)


def test_trough_is_its_profile():
    """Lucerna's troughs take the y^2 / (4 f) of their paraboloid away."""
    c, text = free_form(6, 4, aperture='"rectangle"', size_mm=[40.0, 400.0])
    (part,), free = lucerna_entry.surfaces_of(text, "trough")
    x = np.linspace(-20.0, 20.0, 101)
    kx, ky = even_knots(20.0, 6), even_knots(200.0, 4)
    expected = [a * a / 68.0 + de_boor(ky, 3, [de_boor(kx, 3, row, a) for row in c], 0.0) for a in x]
    assert free == 9
    assert np.abs(heights_at(part["bspline"], x, 0.0 * x) - expected).max() < 1e-11


def test_other_reflectors_are_refused():
    with pytest.raises(ValueError, match="reflector: found faceted along -z, expected bspline or revolution along -z"):
        lucerna_entry.surfaces_of(reflector_text(family='"faceted"'), "mirror")


@pytest.mark.parametrize("flat,natural", [(True, False), (False, True), (False, False)])
def test_splines_hold_their_conditions(flat, natural):
    x, y = np.array([0.0, 1.0, 2.5, 3.0, 4.5, 5.0]), np.array([0.0, 2.0, -1.0, 0.5, 3.0, 1.0])
    knots, c = spline_through(x, y, flat_start=flat, natural_start=natural)
    value = lambda a: de_boor(knots, 3, c, a)
    assert np.allclose([value(a) for a in x], y, atol=1e-12)
    h = 1e-3
    slope = (-3 * value(0) + 4 * value(h) - value(2 * h)) / (2 * h)
    bend = (2 * value(0) - 5 * value(h) + 4 * value(2 * h) - value(3 * h)) / h**2
    assert (abs(slope) < 1e-4) == flat and (abs(bend) < 1e-2) == natural
    # Not-a-knot: one cubic goes through the last two intervals.
    cubic = np.polynomial.Polynomial.fit(np.linspace(3.0, 5.0, 9), [value(a) for a in np.linspace(3.0, 5.0, 9)], 3)
    assert np.abs([cubic(a) - value(a) for a in np.linspace(3.0, 5.0, 50)]).max() < 1e-10
    with pytest.raises(ValueError, match="ascending numbers or more"):
        spline_through([0.0, 0.0, 1.0, 2.0], [0.0, 0.0, 1.0, 2.0])


def test_swept_curves_are_round_and_look_to_the_right():
    surface = revolved([0, 0, 1, 1], [(2.0, 0.0), (3.0, 1.0)], degree=1)
    for u in np.linspace(0.0, 4.0, 17):
        x, y, z = at(surface, u, 0.5)
        assert np.hypot(x, y) == pytest.approx(2.5, abs=1e-12) and z == 0.5
    p, du, dv = at(surface, 0.0, 0.5), at(surface, 1e-5, 0.5), at(surface, 0.0, 0.5 + 1e-5)
    normal = np.cross(du - p, dv - p)
    assert normal[0] > 0.0 and normal[2] < 0.0


def lens_body(bottom):
    r = np.linspace(8.0, 0.0, 7)
    outline = [*bottom, *([float(a), 7.0 - a * a / 20.0 + 1e-3 * a**3] for a in r)]
    return outline, f'[[body]]\nrole = "solid"\nrefractive_index = 1.5\nsmooth_below_deg = 25\noutline_mm = {outline}\n'


FLAT = [[0.0, 2.0], [8.0, 2.0]]
DOME = [[float(r), 3.0 - r * r / 64.0] for r in np.linspace(0.0, 8.0, 6)]


@pytest.mark.parametrize("bottom,count", [(FLAT, 6), (DOME, 12)], ids=["flat", "dome"])
def test_lens_is_the_one_that_lucerna_traces(scorer, lucerna, tmp_path, bottom, count):
    outline, text = lens_body(bottom)
    outer = outline[len(bottom):]
    surfaces, free = lucerna_entry.surfaces_of(text, "lens")
    assert free == count and [s["name"] for s in surfaces] == ["bottom", "wall", "outer"]
    curve = np.array(surfaces[2]["bspline"]["points_mm"])[0][:, [0, 2]]
    assert np.allclose(curve[0], outer[0]) and np.allclose(curve[-1], outer[-1])
    glass = {"roles": ["interface"], "interface": {"model": "fresnel", "refractive_index": [1.5, 1.5],
                                                   "absorption_per_mm": 0.0}}
    ours, _, found = boxes_of(scorer, tmp_path / "a", disk_task(glass, plane(100, -1, 300)), surfaces)
    assert found["counts"], found["faults"]
    side = found["rectangle"]["high"][0] - found["rectangle"]["low"][0]
    theirs, _ = lucerna_plane(lucerna, tmp_path / "l", text, side, 100, "-z")
    centre = (np.arange(48) - 23.5) / 24.0
    ring = (24 * np.hypot(*np.meshgrid(centre, centre))).astype(int).ravel()

    def off(a, b):
        a, b = (np.bincount(ring, weights=x) for x in (a, b))
        return np.max(np.abs(a - b) / np.sqrt((a + b) / RAYS + 1e-12))

    assert ours.sum() > 0.4 and off(ours, theirs) < 5.0
    # A tenth of a millimetre in the middle of the lens is seen.
    other = [json.loads(json.dumps(s)) for s in surfaces]
    for row in other[2]["bspline"]["points_mm"]:
        for p in row[-3:]:
            p[2] += 0.1
    moved, _, _ = boxes_of(scorer, tmp_path / "b", disk_task(glass, plane(100, -1, 300)), other)
    assert off(moved, theirs) > 10.0


def free_lens_body(nx=3, ny=4, entry=([0.0, 2.0],), bottom=""):
    """A dome of another curvature along x than along y, leaning to one side. `bottom`: the text of a bottom face."""
    half = 8.5
    x, y = ((np.arange(n + 3) - 1.0) * 2.0 * half / n - half for n in (nx, ny))
    c = 6.0 - x**2 / 22.0 - y[:, None] ** 2 / 38.0 + 0.04 * x + 0.03 * y[:, None]
    outline = [*entry, [8.0, 2.0], [8.0, 3.0]]
    return (f'[[body]]\nrole = "solid"\nrefractive_index = 1.5\noutline_mm = {outline}\n[body.face]\nhalf_mm = {half}\n'
            f"intervals = [{nx}, {ny}]\ncoefficients_mm = {c.ravel().tolist()}\n{bottom}")


def hollow_bottom(n=4, half=4.5):
    x = (np.arange(n + 3) - 1.0) * 2.0 * half / n - half
    c = 4.0 - x**2 / 14.0 - x[:, None] ** 2 / 20.0 + 0.05 * x
    return f"[body.bottom_face]\nhalf_mm = {half}\nintervals = [{n}, {n}]\ncoefficients_mm = {c.ravel().tolist()}\n"


CAVITY = [[3.0 * math.sin(a), 2.0 + 2.0 * math.cos(a)] for a in np.linspace(0.0, 0.5 * math.pi, 10)]


@pytest.mark.parametrize("entry, bottom, more, names",
                         [([[0.0, 2.0]], "", 0, []), ([*CAVITY[:-1], [3.0, 2.0]], "", 2, ["cavity"]),
                          ([[4.0, 2.5], [4.0, 2.0]], hollow_bottom(), 28, ["entry", "inner wall"])],
                         ids=["flat", "cavity", "free"])
def test_free_lens_is_the_one_that_lucerna_traces(scorer, lucerna, tmp_path, entry, bottom, more, names):
    text = free_lens_body(entry=entry, bottom=bottom)
    surfaces, free = lucerna_entry.surfaces_of(text, "free-lens")
    assert free == 42 + more
    assert [s["name"] for s in surfaces] == ["bottom", "wall", "outer", *names]
    glass = {"roles": ["interface"], "interface": {"model": "fresnel", "refractive_index": [1.5, 1.5],
                                                   "absorption_per_mm": 0.0}}
    ours, _, found = boxes_of(scorer, tmp_path / "a", disk_task(glass, plane(100, -1, 250)), surfaces)
    # Closed along the rim, too, whose height changes by millimetres.
    assert found["counts"], found["faults"]
    assert found["absorbed"]["wrong_side"]["value"] < 1e-5
    side = found["rectangle"]["high"][0] - found["rectangle"]["low"][0]
    theirs, _ = lucerna_plane(lucerna, tmp_path / "l", text, side, 100, "-z")
    assert ours.sum() > 0.4 and abs(deviation(ours, theirs)) < 5.0
    # The same lens turned by 180 degrees is seen.
    for s in surfaces:
        s["place"] = placed(x_axis=(-1, 0, 0))
    turned, _, _ = boxes_of(scorer, tmp_path / "b", disk_task(glass, plane(100, -1, 250)), surfaces)
    assert deviation(turned, theirs) > 20.0


@pytest.mark.parametrize("name, both", [("LB-4-2x2", True), ("LB-3-rectangle", True), ("LB-5b", False)])
def test_symmetric_tasks_ask_for_symmetric_lenses(tasks, tmp_path, name, both):
    lucerna_entry.project(read_task(tasks / f"{name}.json"), tmp_path)
    assert ('symmetry = "both"' in (tmp_path / "project.toml").read_text()) == both


def test_even_light_fills_its_cells():
    rectangle = photometry.lit_cells({"function": "uniform_rectangle", "size_mm": [30, 8]}, [20.0, 10.0], 10)
    assert rectangle.shape == (10, 10) and rectangle.sum() * 4.0 * 2.0 == pytest.approx(240.0)
    # Rows are along y: the light is wider along x.
    assert rectangle[5, 1] > 0.0 and rectangle[1, 5] == 0.0
    disk = photometry.lit_cells({"function": "uniform_disk", "radius_mm": 8.0}, [10.0, 10.0], 50)
    assert disk.sum() * 0.16 == pytest.approx(64.0 * np.pi, rel=1e-3)


def test_tasks_that_are_entered(tasks):
    kinds = {}
    for file in sorted(tasks.glob("*.json")):
        task = read_task(file)
        kinds.setdefault(task.kind, set()).add(task.family)
    assert kinds == ENTERED


def test_a_road_is_aimed_at_by_light_that_makes_its_luminance_even(tasks, tmp_path):
    task = read_task(tasks / "LB-5b.json")
    assert task.lit["size_mm"] == [35000, 7000]
    road = task.lit["road"]
    # CIE 144, R3: r below the lamp; at tan gamma 1 towards the observer, across and away.
    assert road.luminance_coefficient(0.0, 0.0, 0) == pytest.approx(0.0294)
    for x, y, r in [(-8000.0, 0.0, 0.0362), (0.0, 8000.0, 0.0100), (8000.0, 0.0, 0.0100)]:
        assert road.luminance_coefficient(x, y, 0) / 2.0**1.5 == pytest.approx(r, rel=0.02)
    x, y = np.meshgrid(np.linspace(-13900.0, 14100.0, 57), np.linspace(100.0, 6900.0, 18))
    luminance = sum(road.illuminance(x + shift, y) * road.luminance_coefficient(x + shift, y, k)
                    for shift in (-28000.0, 0.0, 28000.0) for k in (0, 1))
    assert luminance == pytest.approx(luminance.mean())
    even = sum(np.where(road.share(x + shift) > 0.0, road.luminance_coefficient(x + shift, y, 0), 0.0)
               for shift in (-28000.0, 0.0, 28000.0))
    assert even.min() < 0.3 * even.max(), "even light makes an uneven luminance"
    # The road's y axis is the task's -y: z looks up to the lamp, x along the road.
    assert task.lit["place"]["origin_mm"] == [0.0, -3500.0, 8000.0]
    lucerna_entry.project(task, tmp_path)
    target = tomllib.loads((tmp_path / "project.toml").read_text())["target"]
    assert target["position_mm"] == [0.0, -3500.0, 8000.0] and target["normal"] == "-z"
    assert target["size_mm"] == [43750.0, 8750.0]
    # Less light where it comes towards the observers, from -x; none beside the road. The file begins at the highest y.
    cells = np.loadtxt(tmp_path / "target.csv", delimiter=",")[::-1]
    before, behind = cells[:, 60:80].sum(), cells[:, 170:190].sum()
    assert 0.0 < before < 0.5 * behind
    assert cells[:20].max() == cells[-20:].max() == 0.0
    assert cells[215, 72] > 2.0 * cells[35, 72], "and more in the far lane, for it is aside of their way"


def test_a_collector_images_its_source_onto_the_target(scorer, tasks, tmp_path):
    """The mirror that Lucerna begins with is the ellipsoid from the source to the target."""
    task = read_task(tasks / "LB-2a.json")
    lucerna_entry.project(task, tmp_path)
    text = (tmp_path / "project.toml").read_text()
    surfaces, free = lucerna_entry.surfaces_of(text, "horn")
    place = lucerna_entry.target_place(task)
    down, vertex = -place["origin_mm"][2], surfaces[0]["place"]["origin_mm"][2]
    assert free == 23 * 23 and down == pytest.approx(50.0 * np.sqrt(3.0))
    # The way from focus to focus by any place of the mirror: twice the half axis.
    x, y = places(50.0, 50.0, 2000)
    x, y = x[np.hypot(x, y) < 50.0], y[np.hypot(x, y) < 50.0]
    z = vertex - heights_at(surfaces[0]["bspline"], x, y)
    way = np.sqrt(x * x + y * y + z * z) + np.sqrt(x * x + y * y + (z + down) ** 2)
    assert np.abs(way - 150.0).max() < 0.01
    stated = Stated(free_parameters=free, wall_s=0, program="p", method="m")
    found = score(scorer, task.file, write_submission(tmp_path / "s", task.name, "n", "a", surfaces, stated, place), 200_000)
    assert found["counts"], found["faults"]
    # No mirror of one reflection has it all: the middle magnifies more than the rim.
    assert 0.45 < found["efficiency_with_losses"]["value"] < 0.6


@pytest.mark.parametrize("name,goal", [("LB-6-led-spot10", 5e-4), ("LB-6-led-wallwasher", 5e-4),
                                       ("LB-1a-cos4-free", 0.01)])
def test_tables_are_the_targets(tasks, name, goal):
    task = read_task(tasks / f"{name}.json")
    table, error = photometry.sampled(task.target, task.is_round)
    assert error < goal
    coarse = photometry.Table(task.target, 0.0 if task.is_round else 10.0, 5.0)
    assert photometry.sampling_error(task.target, coarse) > 3.0 * goal
    # Independent of the error's own sums: values between the nodes. The wall washer tells +x from -x.
    u, v = np.array([0.03, 0.3, -0.3, 0.1]), np.array([0.01, -0.2, 0.1, 0.4])
    wanted = intensity(task.target, u, v)
    assert np.allclose(table.at(u, v) / table.at(u, v)[0], wanted / wanted[0], atol=2e-3)


def test_a_light_table_is_an_entry(scorer, lucerna, tasks, tmp_path):
    """The target itself, as the LDT file of another program, is off by its sampling alone."""
    task = read_task(tasks / "LB-1a-cos4-free.json")
    table, off = photometry.sampled(task.target, task.is_round)
    (tmp_path / "t.ies").write_text(table.ies(task.name), newline="")
    subprocess.run([lucerna, "convert", tmp_path / "t.ies", tmp_path / "t.ldt"], check=True)
    stated = Stated(free_parameters=0, wall_s=0, program="p", method="m")
    file = write_submission(tmp_path, task.name, "n", "a", None, stated, light_table="t.ldt")
    found = score(scorer, task.file, file, 1 << 20)
    assert found["counts"] and found["light_table"] and found["limits"] == []
    assert found["error_48"]["excess"] < off + 5.0 * found["error_48"]["standard_error"]
    for both in ({"surfaces": None}, {"surfaces": [], "light_table": "t.ldt"}):
        with pytest.raises(ValueError, match="of surfaces and light_table, expected one"):
            write_submission(tmp_path, task.name, "n", "a", stated=stated, **both)
    with pytest.raises(ValueError, match="/light_table: found a light table with --rays-from, expected surfaces"):
        score(scorer, task.file, file, 1 << 20, rays_from=tmp_path / "none.tm25ray")


def test_tables_of_hidden_mirrors_are_handed_on(tasks):
    task = read_task(tasks / "LB-6-hidden-49.json")
    table, error = photometry.sampled(task.target, task.is_round)
    assert error < 1e-9
    rows = np.asarray(task.target["rows"])
    assert np.allclose(table.cd[:-1, :rows.shape[1]], 1000.0 * rows / rows.max(), atol=1e-6)
    assert not table.cd[:, rows.shape[1]:].any()


@pytest.mark.parametrize("count", [10, 49, 400])
def test_hidden_mirrors_score_what_is_said(scorer, tasks, count):
    """Within five errors of a run of this length; another mirror is far from it."""
    name = f"LB-6-hidden-{count}"
    task = read_task(tasks / f"{name}.json")
    hidden = tasks.parent / "hidden" / name / "submission.json"
    found = score(scorer, task.file, hidden, 1 << 20)
    assert found["counts"], found["faults"]
    said = re.fullmatch(r"the hidden mirror itself: error ([\d.]+) \+- ([\d.]+) %, ([\d.]+) % of the light in the rectangle",
                        task.definition["reference"][0]["text"])
    error, spread, light = (float(x) / 100.0 for x in said.groups())
    assert abs(found["error_48"]["excess"] - error) < 5.0 * np.hypot(spread, found["error_48"]["standard_error"])
    assert found["in_rectangle"]["value"] == pytest.approx(light, abs=2e-3)
    assert error < 0.012
    plain = Entry(task.file, lambda _: Mirror(task, 9.0).surfaces(), scorer).figures([0], 1 << 18)
    assert plain["error_48"]["excess"] > 0.1


def test_projects_are_read(lucerna, tasks, tmp_path):
    """lucerna traces what a project says; keys that it does not know would be errors."""
    for name in ("LB-6-filament-batwing", "LB-1b-flat-h12", "LB-3-disk", "LB-4-2x2", "LB-2a"):
        folder = tmp_path / name
        folder.mkdir()
        task = read_task(tasks / f"{name}.json")
        lucerna_entry.project(task, folder)
        tables = tomllib.loads((folder / "project.toml").read_text())
        assert sum(s["flux_lm"] for s in tables["source"]) == pytest.approx(1000.0)
        done = subprocess.run([lucerna, "trace", str(folder / "project.toml"), "-o", str(folder / "out"), "--rays",
                               "20000", "--quiet"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_lucerna_designs_a_trough_that_scores(scorer, lucerna, tasks, tmp_path):
    """The whole way, in seconds: its light is nearer to the target than that of the parabola it began with."""
    task = read_task(tasks / "LB-1a-cos4-free.json")
    lucerna_entry.project(task, tmp_path)
    text = lucerna_entry.design(lucerna, task, tmp_path, 20)
    surfaces, free = lucerna_entry.surfaces_of(text, "trough")
    stated = Stated(free_parameters=free, wall_s=20, program="p", method="m")
    found = score(scorer, task.file, write_submission(tmp_path / "s", task.name, "n", "a", surfaces, stated), 200_000)
    assert found["counts"], found["faults"]
    assert found["error_48"]["excess"] < 0.1


def test_a_program_that_fails_is_named(tasks, tmp_path):
    task = read_task(tasks / "LB-6-led-oval.json")
    with pytest.raises(ValueError, match="none/lucerna: file: found No such file"):
        lucerna_entry.design(tmp_path / "none" / "lucerna", task, tmp_path, 1)
    with pytest.raises(ValueError, match="found exit 1 and no result, expected a design"):
        lucerna_entry.design("/bin/false", task, tmp_path, 1)
