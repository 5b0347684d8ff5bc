# SPDX-License-Identifier: Apache-2.0
"""LB-F1: the mirrors of the scenes, and speeds that do not count the start of a program."""
import json

import numpy as np
import pytest

import run_forward
from lucerna_bench import lucerna_entry, stl, tracing

RAYS = 1 << 20


@pytest.fixture
def scene(tasks):
    return {s.name: s for s in tracing.scenes(tasks.parent / "forward")}


def test_both_descriptions_are_one_mirror(scene):
    assert set(scene) == {"LB-F1-para", "LB-F1-wavy", "LB-F1-deep"}
    for s in scene.values():
        given = json.loads((s.folder / "submission.json").read_text())["surfaces"]
        made, _ = lucerna_entry.surfaces_of((s.folder / "reflector.toml").read_text(), "mirror")
        assert given == json.loads(json.dumps(made))
        assert s.task["optics"]["reflectance"] == 1.0


@pytest.mark.parametrize("name", ["LB-F1-para", "LB-F1-wavy", "LB-F1-deep"])
def test_lucerna_and_the_scorer_see_the_same_light(scene, scorer, lucerna, tmp_path, name):
    one, two = (tmp_path / x for x in "ab")
    one.mkdir()
    two.mkdir()
    ours = tracing.Scorer(scorer).shares(scene[name], RAYS, 1, 2, one)
    # Rounds are traced in the same folder.
    tracing.LucernaTrace(lucerna).shares(scene[name], 1000, 1, 2, two)
    theirs = tracing.LucernaTrace(lucerna).shares(scene[name], RAYS, 1, 2, two)
    assert 0.3 < ours.sum() < 1.0 + 1e-9
    assert abs(tracing.deviation(ours, RAYS, theirs, RAYS)) < tracing.MOST_DEVIATION
    # The same light turned by 90 degrees is another, where the mirror is not round.
    turned = ours.reshape(48, 48).T.ravel()
    assert name != "LB-F1-wavy" or tracing.deviation(turned, RAYS, theirs, RAYS) > 20.0


@pytest.mark.parametrize("name", ["LB-F1-para", "LB-F1-wavy", "LB-F1-deep"])
def test_triangles_send_the_same_light(scene, scorer, tmp_path, monkeypatch, name):
    ours, entrant = tracing.Scorer(scorer).shares(scene[name], RAYS, 1, 2, tmp_path), tracing.Triangles(scorer)
    off = lambda: tracing.deviation(ours, RAYS, entrant.shares(scene[name], RAYS, 2, 2, tmp_path), RAYS)
    assert abs(off()) < tracing.MOST_DEVIATION
    # Few of them do not; the scene that was made for the entrant is not made again.
    monkeypatch.setattr(tracing, "disk_triangles", lambda *words: stl.disk_triangles(*words, rings=12, sectors=24))
    assert abs(off()) < tracing.MOST_DEVIATION
    entrant = tracing.Triangles(scorer)
    assert off() > 2.0 * tracing.MOST_DEVIATION


class Pretender:
    """Takes 0.2 s to start, then does a million rays a second; its light is even but for noise of its seed."""

    def __init__(self, clock, shift=0.0):
        self.clock, self.shift = clock, shift

    def shares(self, _scene, rays, seed, _threads, _folder):
        self.clock.now += 0.2 + rays / 1e6
        p = np.full(100, 0.01)
        p[:50] += self.shift
        return np.random.default_rng(seed).multinomial(rays, p / p.sum()) / rays


@pytest.fixture
def clock(monkeypatch):
    class Clock:
        now = 0.0
    monkeypatch.setattr(tracing.time, "monotonic", lambda: Clock.now)
    return Clock


def test_speed_does_not_count_the_start(scene, clock, tmp_path):
    runs = tracing.Clock(Pretender(clock), scene["LB-F1-para"], 1, tmp_path)
    # 0.33 s, 0.46 s, 0.72 s: the third is long enough.
    assert runs.enough(0.5, first=1 << 17) == 1 << 19
    assert runs.rays_per_s(1 << 19) == pytest.approx(1e6)


def test_light_that_is_not_the_judges_does_not_count(scene, clock, tmp_path):
    entrants = {"judge": Pretender(clock), "good": Pretender(clock), "bad": Pretender(clock, 0.002)}
    found = tracing.measure(scene["LB-F1-para"], entrants, seconds=0.3, rounds=1, say=lambda _: None)
    off = {m.entrant: m.deviation for m in found}
    assert off["judge"] == 0.0 and abs(off["good"]) < 5.0 < off["bad"]
    page = tracing.write(tmp_path, found, {"threads": 1, "program": "p", "commit": "c", "machine": "m"}).read_text()
    rows = [line for line in page.splitlines() if line.startswith("| LB-F1-para")]
    assert len(rows) == 3 and "DOES NOT COUNT" in rows[2] and "DOES NOT COUNT" not in rows[1]
    assert json.loads((tmp_path / "LB-F1.json").read_text())["speeds"][2]["entrant"] == "bad"


def test_deviation_is_normal():
    """Two hundred pairs of equal sources: mean 0, standard deviation 1, each within five of its own errors."""
    random = np.random.default_rng(1)
    p = random.random(2000)
    p /= p.sum()
    draw = lambda n: random.multinomial(n, p) / n
    found = [tracing.deviation(draw(10**6), 10**6, draw(3 * 10**6), 3 * 10**6) for _ in range(200)]
    assert abs(np.mean(found)) < 5.0 / np.sqrt(200.0) and 0.75 < np.std(found) < 1.25


def test_a_folder_without_scenes_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"found no LB-F1-\*/task.json, expected scenes"):
        tracing.scenes(tmp_path)


def test_step_files_of_lucerna_are_the_same_mirror(scene, scorer, tmp_path):
    """The same rays meet the spline of the JSON and the one that OpenCASCADE reads, box by box."""
    lucerna = pytest.importorskip("lucerna")
    wavy = scene["LB-F1-wavy"]
    given = json.loads((wavy.folder / "submission.json").read_text())
    lucerna.Reflector.from_toml((wavy.folder / "reflector.toml").read_text()).save(tmp_path / "mirror.step")
    given["surfaces"] = [{"name": "mirror", "role": "mirror", "step": "mirror.step",
                          "place": given["surfaces"][0]["place"]}]
    (tmp_path / "submission.json").write_text(json.dumps(given))
    (tmp_path / "task.json").write_text(json.dumps(wavy.task))
    rays = 1 << 17
    try:
        step = tracing.Scorer(scorer).shares(tracing.Scene(tmp_path), rays, 1, 2, tmp_path)
    except ValueError as e:
        assert "built without OpenCASCADE" in str(e)
        pytest.skip("the scorer was built without OpenCASCADE")
    json_shares = tracing.Scorer(scorer).shares(wavy, rays, 1, 2, tmp_path)
    # A ray at the edge of a box, or at the rim, may go to the other side.
    assert np.abs(step - json_shares).sum() < 1e-3 < 0.3 < json_shares.sum()


def test_one_command_measures_a_scene(scorer, lucerna, tmp_path, capsys):
    words = ["tracing", "--only", "LB-F1-para", "--seconds", "1", "--rounds", "1", "--scorer", scorer, "--lucerna", lucerna,
             "--commit", "abc", "-o", str(tmp_path)]
    assert run_forward.main(words) == 0
    page = (tmp_path / "LB-F1.md").read_text()
    assert page.count("| LB-F1-para |") == 3 and "commit abc" in page and "LB-F1.md" in capsys.readouterr().out


@pytest.mark.parametrize("words,said", [
    (["tracing", "--only", "LB-F1-moon"], "--only: found LB-F1-moon, expected some of LB-F1-deep, LB-F1-para"),
    (["compression", "--only", "moon"], "--only: found moon, expected some of disk, led"),
    (["tracing", "--scorer", "/none/scorer"], "/none/scorer: file: found no program, expected one"),
])
def test_bad_calls_are_refused(words, said, tmp_path, capsys):
    programs = ["--scorer", "/bin/true", "--lucerna", "/bin/true", "--commit", "x", "-o", str(tmp_path)]
    assert run_forward.main([words[0], *programs, *words[1:]]) == 1
    assert said in capsys.readouterr().err
