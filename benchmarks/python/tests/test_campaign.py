# SPDX-License-Identifier: Apache-2.0
"""Campaigns: what is made is kept, what is printed is what was scored, what is wrong is said."""
import json
import re
import subprocess
import sys

import pytest

import run_entries
from lucerna_bench import campaign, methods, tables
from lucerna_bench.tasks import read_task

RAYS = 16384


@pytest.fixture
def task(tasks):
    return read_task(tasks / "LB-1a-cos4-free.json")


@pytest.fixture
def run(scorer, tmp_path):
    def made(**other):
        means = methods.Means(scorer, "/bin/false", time_s=other.pop("time_s", 3.0), fit_rays=RAYS, threads=1)
        return campaign.Campaign(tmp_path / "out", means, other.pop("rays", RAYS), "abc", say=lambda _: None, **other)
    return made


def test_nothing_is_made_or_scored_twice(run, task, tmp_path, monkeypatch):
    assert run().run([task], ["plain"]) == []
    folder = tmp_path / "out" / task.name / "plain"
    first = {f.name: (f.read_bytes(), f.stat().st_mtime_ns) for f in folder.iterdir()}
    assert set(first) == {"submission.json", "made.json", "score.json"}
    monkeypatch.setattr(campaign, "make", lambda *_: pytest.fail("made twice"))
    monkeypatch.setattr(campaign, "score", lambda *_: pytest.fail("scored twice"))
    assert run().run([task], ["plain"]) == []
    assert {f.name: (f.read_bytes(), f.stat().st_mtime_ns) for f in folder.iterdir()} == first


def test_more_rays_score_again_but_make_nothing_again(run, task, tmp_path):
    run().run([task], ["plain"])
    folder = tmp_path / "out" / task.name / "plain"
    entry = (folder / "submission.json").stat().st_mtime_ns
    before = json.loads((folder / "score.json").read_text())
    run(rays=4 * RAYS).run([task], ["plain"])
    after = json.loads((folder / "score.json").read_text())
    assert (folder / "submission.json").stat().st_mtime_ns == entry
    assert (before["rays"], after["rays"]) == (RAYS, 4 * RAYS) and before["seed"] != after["seed"]
    (folder / "score.json").unlink()
    run().run([task], ["plain"])
    assert json.loads((folder / "score.json").read_text())["rays"] == RAYS


def test_other_settings_are_not_mixed_and_force_makes_again(run, task, tmp_path):
    run().run([task], ["plain"])
    wrong = run(time_s=4.0).run([task], ["plain"])
    assert len(wrong) == 1 and "--force" in wrong[0]
    assert "made.json: /settings/time_s: found 3.0, expected 4.0" in wrong[0]
    assert run(time_s=4.0, force=True).run([task], ["plain"]) == []
    record = json.loads((tmp_path / "out" / task.name / "plain" / "made.json").read_text())
    assert record["settings"]["time_s"] == 4.0 and 0.0 < record["cpu_s"]


def test_an_entry_that_was_interrupted_is_not_there(run, task, tmp_path, monkeypatch):
    def broken(*_):
        raise KeyboardInterrupt
    monkeypatch.setattr(campaign, "make", broken)
    with pytest.raises(KeyboardInterrupt):
        run().run([task], ["plain"])
    assert not (tmp_path / "out" / task.name / "plain").exists()
    monkeypatch.undo()
    assert run().run([task], ["plain"]) == []
    assert [p.name for p in (tmp_path / "out" / task.name).iterdir()] == ["plain"]


def test_one_that_fails_does_not_stop_the_others(run, task, tmp_path):
    wrong = run().run([task], ["lucerna", "plain"])
    assert len(wrong) == 1 and wrong[0].startswith(f"{task.name}, lucerna: ")
    assert "found exit 1 and no result" in wrong[0]
    assert (tmp_path / "out" / task.name / "plain" / "score.json").exists()


def test_searches_are_not_worse_than_the_plain_optic(run, task, tmp_path):
    assert run(time_s=4.0, rays=4 * RAYS).run([task], ["plain", "point-source", "cma-es", "tree"]) == []
    scores = {method: s for _, method, s in tables.read_scores(tmp_path / "out")}
    assert set(scores) == {"plain", "point-source", "cma-es", "tree"}
    for s in scores.values():
        assert s["counts"]
        assert s["error_48"]["excess"] < scores["plain"]["error_48"]["excess"] + 0.1
    assert scores["point-source"]["error_48"]["excess"] < 0.5 * scores["plain"]["error_48"]["excess"]


def error(excess, standard_error=0.0, floor=0.0):
    return {"excess": excess, "standard_error": standard_error, "floor": floor}


def fake_score(**changed):
    share = lambda x: {"value": x, "standard_error": 0.0}
    s = {"counts": True, "headline": "error_48", "faults": [], "rays": 1000, "light_table": False, "seed": 77, "road": None,
         "error_48": error(0.0123, 0.0004, 0.0056), "nmae": share(0.0789), "efficiency_with_losses": share(0.8111), "efficiency_without_losses": share(0.9222),
         "outside_rectangle": share(0.0333), "run": {"machine": "scoring box"},
         "stated": {"free_parameters": 44, "wall_s": 60.25, "cpu_s": 118.5, "machine": "a box",
                    "program": "p, commit abc", "method": "m"}}
    return {**s, **changed}


def test_tables_hold_what_the_scores_say():
    worse = fake_score(error_48=error(0.5, 0.1), counts=False, faults=["too wide"])
    scores = [("LB-9-x", "lucerna", fake_score()), ("LB-9-x", "tree", worse)]
    text = tables.table(scores)
    lines = [line for line in text.splitlines() if line.startswith("| LB-9-x")]
    rows = [[c.strip() for c in line.strip("|").split(" | ")] for line in lines]
    assert rows[0] == ["LB-9-x", "lucerna", "**1.23 % +- 0.04 %**", "0.56 %", "7.89 %", "81.11 %", "92.22 %", "3.33 %",
                       "44", "60.2", "118.5", "a box", "p, commit abc", "1,000 rays, seed 77"]
    assert len(rows[0]) == len(tables.COLUMNS)
    assert rows[1][1] == "tree (does not count: too wide)" and rows[1][2] == "50.00 % +- 10.00 %"
    assert "seed 77" in text and "scoring box" in text
    assert "| tree (light table) |" in tables.table([("LB-9-x", "tree", fake_score(light_table=True))])
    unknown = fake_score()
    unknown["stated"]["cpu_s"] = None
    assert "not stated" in tables.table([("LB-9-x", "plain", unknown)])


def test_plots_put_marks_where_the_errors_are():
    svg = tables.plot([("LB-9-x", "lucerna", fake_score(error_48=error(0.01, 0.001))),
                       ("LB-9-x", "plain", fake_score(error_48=error(0.1))),
                       ("LB-9-<y>", "tree", fake_score(counts=False))], "title")
    mark = r'<circle cx="([\d.]+)"[^>]*>\s*<title>([a-z]+):'
    tick = r'<text x="([\d.]+)" y="[\d.]+" text-anchor="middle">([\d.]+) %'
    marks, ticks = ({name: float(x) for x, name in re.findall(pattern, svg)} for pattern in (mark, tick))
    assert marks["lucerna"] < marks["tree"] < marks["plain"]
    assert marks["lucerna"] == ticks["1"] and marks["plain"] == ticks["10"]
    assert "LB-9-&lt;y&gt;" in svg and svg.count('fill="#ffffff" stroke') == 1


def test_the_headline_decides_what_is_best():
    """Of étendue transfer the light that arrives counts, whatever the error."""
    more = fake_score(headline="efficiency_with_losses", efficiency_with_losses={"value": 0.9, "standard_error": 0.01},
                      error_48=error(0.5))
    less = fake_score(headline="efficiency_with_losses", efficiency_with_losses={"value": 0.7, "standard_error": 0.01})
    text = tables.table([("LB-2a", "cma-es", more), ("LB-2a", "plain", less)])
    assert "| **90.00 %** |" in text and text.count("**") == 2
    svg = tables.plot([("LB-2a", "cma-es", more)], "title")
    assert "cma-es: 10.00 % +- 1.00 %" in svg


def fake_road(**changed):
    share = lambda x: {"value": x, "standard_error": 0.001}
    road = {"lm_per_cd_m2": share(8123.4), "overall_uniformity": share(0.4567), "lengthwise_uniformity": share(0.7891),
            "threshold_increment": share(0.0654), "limits": []}
    return fake_score(headline="efficiency_with_losses", road=road, error_48=None, nmae=None, outside_rectangle=None, **changed)


def test_roads_have_figures_of_their_own():
    text = tables.table([("LB-5a", "plain", fake_score()), ("LB-5b", "plain", fake_road())])
    assert ("| LB-5b | plain | Uo 0.457, Ul 0.789, TI 6.5 %, 8123 lm for 1 cd/m2 | - | - | **81.11 %** | 92.22 % | - | 44 |"
            in text)
    assert "| LB-5b | **81.1 % light** |" in tables.overview([("LB-5b", "plain", fake_road())])
    both = [("LB-5a", "plain", fake_score()), ("LB-5b", "plain", fake_road())]
    assert tables.plot_title("LB-5", both) == ("LB-5: error at 48 boxes a side, noise taken out; of LB-5b light that does not "
                                               "arrive")
    assert tables.plot_title("LB-2", both[1:]) == "LB-2: light that does not arrive"


def test_horns_have_their_target_at_their_end(run, tasks, tmp_path):
    assert run(time_s=2.0).run([read_task(tasks / "LB-2a.json")], ["plain", "cma-es"]) == []
    scores = {method: s for _, method, s in tables.read_scores(tmp_path / "out")}
    assert set(scores) == {"plain", "cma-es"} and all(s["counts"] for s in scores.values())
    assert scores["cma-es"]["efficiency_with_losses"]["value"] > 0.3


def test_the_overview_has_a_row_a_task_and_a_column_a_method():
    scores = [("LB-2a", "tree", fake_score(headline="efficiency_with_losses")),
              ("LB-9-x", "plain", fake_score(error_48=error(0.5))), ("LB-9-x", "mine", fake_score(counts=False)),
              ("LB-9-x", "lucerna", fake_score())]
    table_of_light = fake_score(error_48=error(0.0001), light_table=True)
    assert "| **1.23 % +- 0.04 %, 81.1 % light** | 0.01 % +- 0.00 %, 81.1 % light (light table) |" in tables.overview(
        [("LB-1a", "lucerna", fake_score()), ("LB-1a", "a|b", table_of_light)])
    assert "| a\\|b |" in tables.overview([("LB-1a", "a|b", table_of_light)])
    assert tables.overview(scores).splitlines() == [
        "| task | lucerna | plain | tree | mine |", "|---|---|---|---|---|",
        "| LB-2a | - | - | **81.1 % light** | - |",
        "| LB-9-x | **1.23 % +- 0.04 %, 81.1 % light** | 50.00 % +- 0.00 %, 81.1 % light | - | does not count |"]


def test_pages_of_results_are_no_change_of_the_program(tmp_path):
    def git(*words):
        subprocess.run(["git", "-c", "user.name=n", "-c", "user.email=e", *words], cwd=tmp_path, check=True, capture_output=True)

    git("init", "-q")
    for name in ("docs/page.md", "benchmarks/code.py"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).write_text("first")
    git("add", "-A")
    git("commit", "-qm", "first")
    clean = campaign.commit_of(tmp_path / "benchmarks")
    (tmp_path / "docs/page.md").write_text("second")
    assert campaign.commit_of(tmp_path / "benchmarks") == clean and "with changes" not in clean
    (tmp_path / "benchmarks/code.py").write_text("second")
    assert campaign.commit_of(tmp_path / "benchmarks") == f"{clean} with changes"


def test_families_have_a_page_each(tmp_path):
    for task in ("LB-8-a", "LB-9-b"):
        (tmp_path / task / "plain").mkdir(parents=True)
        (tmp_path / task / "plain" / "score.json").write_text(json.dumps(fake_score()))
    files = tables.write_all(tmp_path)
    assert sorted(f.name for f in files) == ["LB-8.md", "LB-8.svg", "LB-9.md", "LB-9.svg", "overview.md"]
    assert (tmp_path / "overview.md").read_text().endswith("| LB-9-b | **1.23 % +- 0.04 %, 81.1 % light** |\n")
    assert "LB-8-a" in (tmp_path / "LB-8.md").read_text() and "LB-9-b" not in (tmp_path / "LB-8.md").read_text()


@pytest.mark.parametrize("words,said", [
    (["--tasks", "LB-7-*"], "--tasks: found no task by LB-7-*, expected a name"),
    (["--scorer", "/none/scorer"], "/none/scorer: file: found no program, expected one"),
])
def test_bad_calls_are_refused(words, said, tmp_path, capsys):
    programs = ["--scorer", "/bin/true", "--lucerna", "/bin/true", "--commit", "x"]
    assert run_entries.main([*programs, *words, "-o", str(tmp_path)]) == 1
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("words,said", [
    (["--methods", "plain,magic"], "found magic, expected some of lucerna, plain"),
    (["--rays", "many"], "found many, expected a whole number from 16384"),
    (["--time", "0"], "found 0, expected seconds from 1"),
])
def test_bad_options_are_usage_errors(words, said, tmp_path, capsys):
    with pytest.raises(SystemExit) as stopped:
        run_entries.main([*words, "-o", str(tmp_path)])
    assert stopped.value.code == 2 and said in capsys.readouterr().err


def test_files_that_are_no_tasks_are_refused(tmp_path):
    (tmp_path / "t.json").write_text("{")
    with pytest.raises(ValueError, match=r"t.json: file: found Expecting .*, expected a task file"):
        read_task(tmp_path / "t.json")
    (tmp_path / "t.json").write_text('{"format": "x"}')
    with pytest.raises(ValueError, match="/format: found another format, expected lucerna-bench-task"):
        read_task(tmp_path / "t.json")
    (tmp_path / "t.json").write_text('{"format": "lucerna-bench-task", "limits": [{"kind": "below_moon"}]}')
    with pytest.raises(ValueError, match="/limits/0: found below_moon, expected inside_cylinder"):
        read_task(tmp_path / "t.json")


def test_one_command_makes_a_page(scorer, tmp_path, capsys):
    words = ["--tasks", "LB-[13]*flat-free", "--methods", "plain", "--time", "2", "--rays", "16384", "--fit-rays",
             "16384", "--threads", "1", "--scorer", scorer, "--lucerna", sys.executable, "--commit", "abc", "-o",
             str(tmp_path)]
    assert run_entries.main(words) == 0
    page = (tmp_path / "LB-1.md").read_text()
    assert page.count("| LB-1a-flat-free | plain |") == 1 and page.count("| LB-1b-flat-free | plain |") == 1
    assert "commit abc" in page and "LB-1.svg" in capsys.readouterr().out
