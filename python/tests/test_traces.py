# SPDX-License-Identifier: Apache-2.0
"""Scenes and traces: built, read, written, traced in ranges, merged, resumed, pickled."""
import concurrent.futures
import multiprocessing
import pickle

import lucerna as lu
import numpy as np
import pytest
from conftest import RAYS, parabola


def test_ranges_merge_to_the_bits_of_one_trace(lamp, traced):
    cuts = [0, 1000, 77_777, RAYS]
    parts = [lamp.trace(rays=pair) for pair in zip(cuts[:-1], cuts[1:])]
    assert lu.merge(parts[::-1]) == traced
    assert lu.merge(pickle.loads(pickle.dumps(parts))) == traced
    assert lu.merge(parts)["far"] == traced["far"]
    assert parts[0] != traced


def test_names_are_no_html():
    """A notebook shows names as they are."""
    name = "<img src=x onerror=alert(1)>"
    scene = lu.Scene([{"kind": "disk"}], detectors=[lu.Detector(name=name), lu.Detector("plane", name=name + "2",
                                                    position_mm=[0, 0, 50], size_mm=[9, 9], cells=[2, 2])])
    html = scene.trace(rays=2000)._repr_html_()
    assert "<img" not in html and html.count("&lt;img src=x onerror=alert(1)&gt;") >= 2


def test_what_does_not_belong_together_is_refused(lamp, model):
    a = lamp.trace(rays=(0, 1000))
    other = lu.Scene([model], detectors=[lu.Detector("far-field", name="far", c_step_deg=15, gamma_step_deg=2.5)])
    for bad in ([a, lamp.trace(rays=(2000, 3000))], [a, a], [a, lamp.trace(rays=(1000, 2000), seed=2)],
                [a, other.trace(rays=(1000, 2000))], []):
        with pytest.raises(lu.InputError):
            lu.merge(bad)


def test_a_trace_goes_on(lamp, traced):
    part = lamp.trace(rays=50_000)
    assert lamp.trace(rays=RAYS, resume=part) == traced
    assert lamp.trace(rays=RAYS, resume=traced) == traced
    with pytest.raises(lu.InputError, match="there already"):
        lamp.trace(rays=1000, resume=part)
    until = lamp.trace(noise=0.05)
    assert until.end == "reached" and until.noise <= 0.05
    assert lamp.trace(noise=0.05, resume=until) == until


def test_energy_closes_and_figures_have_errors(traced):
    ledger = traced.ledger
    out = ledger.out_direct.value + ledger.out_reflected.value
    lost = sum(e.value for e in [*ledger.absorbed.values(), *ledger.lost.values()])
    assert ledger.emitted == 300 and out + lost == pytest.approx(300)
    assert traced["far"].flux.value == pytest.approx(out, rel=1e-9)
    for figure in (ledger.out_direct, traced["far"].metrics().peak_cd, traced["floor"].mean):
        assert isinstance(figure, lu.Estimate) and figure.standard_error > 0
    assert traced["floor"].unit == "lx" and traced["floor"].value.shape == (20, 30)
    assert list(traced) == ["far", "floor"] and len(traced) == 2
    with pytest.raises(KeyError, match="nothing"):
        traced["nothing"]


def test_results_outlive_their_trace(lamp):
    cd = lamp.trace(rays=1000)["far"].cd
    value = lamp.trace(rays=1000)["floor"].value
    assert cd.sum() > 0 and value.sum() > 0 and not value.flags.writeable


def test_rays_that_leave_are_a_source(model):
    scene = lu.Scene([model], reflectors=[parabola()], detectors=[lu.Detector("rays", name="out")])
    out = scene.trace(rays=10_000)["out"]
    assert 0 < len(out) <= 10_000 and out.flux_lm == pytest.approx(300, rel=0.1)
    again = lu.Scene([out]).trace(rays=5000)
    assert again.ledger.emitted == pytest.approx(out.flux_lm)


def test_scenes_go_to_text_and_back(tmp_path, lamp, model, traced):
    text = lamp.to_toml()
    again = lu.Scene.from_toml(text, memory=lamp.memory)
    assert again == lamp and again.to_toml() == text
    lamp.save(tmp_path / "lamp.toml")
    loaded = lu.Scene.load(tmp_path / "lamp.toml")
    assert loaded.trace(rays=RAYS) == traced
    assert pickle.loads(pickle.dumps(lamp)) == lamp
    assert [r.keys for r in again.reflectors] == [r.keys for r in lamp.reflectors]
    assert lamp.flux == 300 and lamp.detectors == ["far", "floor"]


def test_sources_are_objects_files_tables(tmp_path, rays, model):
    rays.save(tmp_path / "a.tm25ray")
    model.save(tmp_path / "b.nfl")
    scene = lu.Scene([rays, model, "a.tm25ray", tmp_path / "b.nfl", lu.Source(model, flux_lm=10, axis="-z"),
                      lu.Source(kind="disk", radius_mm=2, flux_lm=5), {"kind": "point", "flux_lm": 1}])
    assert scene.flux == pytest.approx(4 * 300 + 16)
    assert len(scene.memory) == 2 and len(scene.inputs) == 2


@pytest.mark.parametrize("build, place, text", [
    (lambda: lu.Scene([]), "source", "missing"),
    (lambda: lu.Scene([{"kind": "disk", "radius_m": 3}]), "source[0].radius_m", "radius_mm"),
    (lambda: lu.Scene([{"kind": "disk"}], reflectors=[dict(family="revolution", preset="parabola", focal_mm=-1)]),
     "reflector[0].focal_mm", "-1"),
    (lambda: lu.Scene([{"kind": "disk"}], detectors=[lu.Detector("far-field", c_step_deg=7)]), None, "divides"),
    (lambda: lu.Scene([{"kind": "disk"}], detectors=[lu.Detector("camera")]), "detector[0].kind", "camera"),
    (lambda: lu.Reflector("revolution", preset="parabola", focal_mm=float("nan"), diameter_mm=3),
     "reflector[0].focal_mm", "finite"),
    (lambda: lu.Reflector("mesh", file="x.stl"), None, "x.stl"),
])
def test_bad_scenes_name_the_place(build, place, text):
    with pytest.raises((lu.InputError, OSError), match=text) as caught:
        build()
    if place is not None:
        assert caught.value.place.endswith(place)


@pytest.mark.parametrize("build", [lambda: lu.Scene("lamp.toml"), lambda: lu.Scene(None), lambda: lu.Scene([3]),
                                   lambda: lu.Scene([{"kind": object()}]), lambda: lu.Scene(),
                                   lambda: lu.Reflector(), lambda: lu.Scene([{"kind": "disk"}], reflectors=[3])])
def test_wrong_types_are_refused(build):
    with pytest.raises(TypeError):
        build()


@pytest.mark.parametrize("keys", [dict(rays=-1), dict(rays=0), dict(rays=(5, 3)), dict(rays=(1, 2, 3)),
                                  dict(noise=-1), dict(time_s=0), dict(sequence="x"), dict(device="x"),
                                  dict(device="cuda"), dict(isa="x"), dict(max_bounces=0), dict(rays=np.nan)])
def test_bad_calls_are_refused(lamp, keys):
    if keys == dict(device="cuda") and lu.build_info().cuda_unavailable is None:
        pytest.skip("there is a CUDA device")
    with pytest.raises(lu.InputError):
        lamp.trace(**{"rays": 1000, **keys})


def test_reflectors_have_their_shape(tmp_path):
    mirror = parabola()
    assert mirror.height_mm(20, [0, 15]) == pytest.approx([400 / 60, 625 / 60])
    assert np.isnan(mirror.height_mm([0, 41], 0)).all()
    assert mirror.slope(20, 0) == pytest.approx([40 / 60, 0])
    vertices, triangles = mirror.mesh(chord_mm=0.05)
    assert vertices[:, 2] == pytest.approx((vertices[:, :2] ** 2).sum(axis=1) / 60, abs=1e-9)
    assert triangles.dtype == np.uint32 and triangles.max() == len(vertices) - 1
    profile = mirror.profile()
    assert profile[0] == pytest.approx([4, 16 / 60]) and profile[-1] == pytest.approx([40, 1600 / 60])
    for ending in ("step", "stp", "stl", "obj", "dxf", "csv"):
        mirror.save(tmp_path / f"mirror.{ending}")
        assert (tmp_path / f"mirror.{ending}").stat().st_size > 100
    assert (tmp_path / "mirror.step").read_text().startswith("ISO-10303-21")
    assert pickle.loads(pickle.dumps(mirror)) == mirror == lu.Reflector.from_toml(mirror.toml)
    with pytest.raises(lu.InputError, match="xyz"):
        mirror.save(tmp_path / "mirror.xyz")
    with pytest.raises(lu.InputError):
        mirror.mesh(chord_mm=0)


def test_folders_and_reports(tmp_path, traced):
    traced.save(tmp_path / "out")
    assert {"result.json", "project.toml", "trace.sums", "far.ldt", "floor.csv"} <= {
        p.name for p in (tmp_path / "out").iterdir()}
    back = lu.read_trace(tmp_path / "out")
    assert back == traced and back["far"] == traced["far"]
    traced.report(tmp_path / "out.html")
    assert "<html" in (tmp_path / "out.html").read_text()
    lu.write_report(tmp_path / "out", tmp_path / "again.html")
    assert any("floor" in line for line in traced.summary())


def trace_part(scene, first, last):
    return scene.trace(rays=(first, last))


def test_processes_that_are_spawned_share_the_work(lamp, traced):
    context = multiprocessing.get_context("spawn")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as pool:
        jobs = [pool.submit(trace_part, lamp, k * RAYS // 4, (k + 1) * RAYS // 4) for k in range(4)]
        assert lu.merge([job.result() for job in jobs]) == traced


def in_a_fork(queue, scene):
    try:
        scene.trace(rays=1000)
        queue.put("traced")
    except RuntimeError as error:
        queue.put(str(error))


def test_a_forked_process_says_so(lamp):
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    process = context.Process(target=in_a_fork, args=(queue, lamp))
    process.start()
    assert "spawn" in queue.get(timeout=60)
    process.join(60)
    assert process.exitcode == 0


def test_threads_share_a_scene(lamp, traced):
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda _: lamp.trace(rays=RAYS), range(4)))
        assert all(one == traced for one in found)
        fields = list(pool.map(lambda _: traced["far"], range(8)))
    assert all(field == fields[0] for field in fields)


def test_figures_may_be_asked_for_in_any_order(lamp):
    """Arrays come without the figures, which are worked out when they are first asked for."""
    fresh, other = lamp.trace(rays=50_000), lamp.trace(rays=50_000)
    light, floor = fresh["far"], fresh["floor"]
    assert light.cd.shape == (24, 73) and floor.name == "floor" and len(floor.x_mm) == 30
    figures = light.metrics()
    assert light.flux == figures.flux and fresh["far"].metrics() == figures
    assert other.summary() == fresh.summary()
    assert other["far"].metrics() == figures and other["far"] == light and other["floor"] == floor


def test_figures_are_those_of_the_program(lamp, traced):
    """result.json has what the figures are in Python."""
    import json

    traced.save("folder")
    with open("folder/result.json") as file:
        text = json.dumps(json.load(file))
    for figure in (traced["far"].metrics().peak_cd.value, traced["floor"].max.value, traced["far"].flux.value):
        assert repr(figure) in text


def test_a_trace_of_another_scene_is_not_resumed():
    def lamp(radius_mm):
        return lu.Scene([{"kind": "disk", "radius_mm": radius_mm}])

    part = lamp(1).trace(rays=1000)
    with pytest.raises(lu.InputError, match="another scene"):
        lamp(3).trace(rays=2000, resume=part)
    assert lamp(1).trace(rays=2000, resume=part) == lamp(1).trace(rays=2000)


def test_a_mirror_of_a_file_is_the_same_from_any_folder(tmp_path, monkeypatch):
    for name, height in (("a", 4), ("b", 8)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "p.csv").write_text(f"0,0\n10,{height}\n20,{4 * height}\n")
    monkeypatch.chdir(tmp_path / "a")
    mirror = lu.Reflector.from_toml("[[reflector]]\nfamily = 'revolution'\nfile = 'p.csv'\n")
    height = float(mirror.height_mm(10, 0))
    monkeypatch.chdir(tmp_path / "b")
    for same in (pickle.loads(pickle.dumps(mirror)), mirror.replace(),
                 lu.Scene([{"kind": "disk"}], reflectors=[mirror]).reflectors[0]):
        assert float(same.height_mm(10, 0)) == height
    other = lu.Reflector.from_toml("[[reflector]]\nfamily = 'revolution'\nfile = 'p.csv'\n", folder=tmp_path / "b")
    assert float(other.height_mm(10, 0)) != height and other != mirror
