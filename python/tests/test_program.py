# SPDX-License-Identifier: Apache-2.0
"""The same bits as the program, and the program by way of the module."""
import hashlib
import json
import os
import subprocess
import sys

import lucerna as lu
import numpy as np
import pytest
from conftest import RAYS, SANITIZED


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def test_make_source_compress_and_sample(tmp_path, program):
    program("make-source", "filament", "-o", "a.tm25ray", "-n", "30000", "--seed", "4", "--flux-lm", "500")
    mine = lu.make_source("filament", 30_000, seed=4, flux_lm=500)
    theirs = lu.read_rays("a.tm25ray")
    for name in ("x_mm", "y_mm", "z_mm", "kx", "ky", "kz"):
        np.testing.assert_array_equal(getattr(theirs, name), getattr(mine, name))
    program("compress", "a.tm25ray", "-o", "a.nfl", "--max-bytes", "20k", "--seed", "2")
    model = lu.compress("a.tm25ray", max_bytes="20k", seed=2)
    model.save("b.nfl")
    assert digest(tmp_path / "a.nfl") == digest(tmp_path / "b.nfl")
    assert lu.compress(theirs, max_bytes="20k", seed=2) == model
    program("sample", "a.nfl", "-n", "20000", "-o", "a.speos", "--to", "speos", "--seed", "9")
    model.sample_file("b.speos", 20_000, seed=9, format="speos")
    assert digest(tmp_path / "a.speos") == digest(tmp_path / "b.speos")
    program("sample", "a.nfl", "-n", "1000", "-o", "a.tm25ray", "--seed", "9")
    model.sample_file("b.tm25ray", 1000, seed=9)
    theirs, mine = lu.read_rays("a.tm25ray"), lu.read_rays("b.tm25ray")
    assert (theirs.texts.pop("light_source"), mine.texts.light_source) == ("sampled from a.nfl", "sampled from a model")
    for name in ("position_mm", "direction", "weight"):
        np.testing.assert_array_equal(getattr(theirs, name), getattr(mine, name))
    assert "'a model' here" in lu.SourceModel.sample_file.__doc__


def test_trace_and_merge(tmp_path, lamp, traced, program):
    lamp.save("lamp.toml")
    program("trace", "lamp.toml", "-o", "theirs", "--rays", RAYS)
    mine = lu.Scene.load("lamp.toml").trace(rays=RAYS)
    mine.save("mine")
    assert mine == traced == lu.read_trace("theirs")
    for name in ("far.ldt", "far.ies", "far.csv", "floor.csv", "floor.png", "trace.sums", "project.toml"):
        assert digest(tmp_path / "mine" / name) == digest(tmp_path / "theirs" / name), name
    detectors = [json.loads((tmp_path / who / "result.json").read_text())["detectors"] for who in ("mine", "theirs")]
    assert detectors[0] == detectors[1]
    # Half of the light each, either way round.
    half = RAYS // 2
    program("trace", "lamp.toml", "-o", "first", "--rays", f"0:{half}")
    lamp_file = lu.Scene.load("lamp.toml")
    lamp_file.trace(rays=(half, RAYS)).save("second")
    program("merge", "first", "second", "-o", "sum")
    assert lu.read_trace("sum") == traced
    assert lu.merge([lu.read_trace("second"), lu.read_trace("first")]) == traced


def test_until_a_noise(tmp_path, lamp, program):
    lamp.save("lamp.toml")
    program("trace", "lamp.toml", "-o", "theirs", "--noise", "5%")
    assert lu.Scene.load("lamp.toml").trace(noise=0.05) == lu.read_trace("theirs")


@pytest.mark.slow
def test_design(tmp_path, program):
    gamma = np.arange(0, 181, 1.0)
    spot = np.where(gamma < 40, 1000 * np.exp2(-((gamma / 10) ** 2)), 0)
    lu.IntensityDistribution([0], gamma, [spot]).save("spot.ldt", digits=17)
    scene = lu.Scene([{"kind": "disk", "radius_mm": 1}], reflectors=[lu.Reflector(
        "revolution", preset="parabola", focal_mm=8, diameter_mm=60, position_mm=[0, 0, 8], axis="-z")],
        target="spot.ldt", design=dict(restarts=0, time_s=1000))
    scene.save("lamp.toml")
    program("design", "lamp.toml", "-o", "theirs", "--rays", "16384")
    found = lu.design(lu.Scene.load("lamp.toml"), max_rays=16384)
    found.save("mine")
    assert found.end == "converged"
    for name in ("reflector.toml", "reflector.step", "reflector.stl", "reflector.csv", "far-field.ldt", "checkpoint"):
        assert digest(tmp_path / "mine" / name) == digest(tmp_path / "theirs" / name), name


@pytest.mark.skipif(SANITIZED, reason="program and module have a sanitizer each")
def test_python_m_is_the_program(capfd, program):
    place = os.path.dirname(os.environ.get("LUCERNA_PROGRAM", ""))
    path = os.pathsep.join([place, os.environ["PATH"]])
    for arguments in (["--version"], ["info", "nothing.file"], ["trace"]):
        direct = subprocess.run(["lucerna", *arguments], capture_output=True, text=True, env={**os.environ, "PATH": path},
                                check=False)
        through = subprocess.run([sys.executable, "-m", "lucerna", *arguments], capture_output=True, text=True,
                                 env={**os.environ, "PATH": path}, check=False)
        assert (through.returncode, through.stdout, through.stderr) == (
            direct.returncode, direct.stdout, direct.stderr)
    bare = subprocess.run([sys.executable, "-m", "lucerna"], capture_output=True, text=True, check=False,
                          env={**os.environ, "PATH": "/nowhere"})
    assert bare.returncode != 0
