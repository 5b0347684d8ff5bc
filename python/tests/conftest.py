# SPDX-License-Identifier: Apache-2.0
"""What the tests share: a small source, its model and a lamp."""
import os
import shutil
import subprocess

import lucerna as lu
import matplotlib
import pytest

matplotlib.use("Agg")

# No test needs more, and a lost callback or lock shows as a test that hangs.
RAYS = 200_000

# Whether the module is under the address sanitizer, whose library is preloaded then: not into the program, which has its own.
SANITIZED = "asan" in os.environ.get("LD_PRELOAD", "")
BARE = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: takes longer than some seconds")
    config.addinivalue_line("markers", "mpi: starts ranks of MPI (make test-mpi)")


@pytest.fixture(autouse=True)
def in_own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture(autouse=True)
def nothing_is_printed(capfd):
    yield
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")


@pytest.fixture(scope="session")
def rays():
    return lu.make_source("led", 50_000, seed=3, flux_lm=300)


@pytest.fixture(scope="session")
def model(rays):
    return lu.compress(rays, max_bytes="16k")


def parabola(**keys):
    given = dict(preset="parabola", focal_mm=15, diameter_mm=80, hole_diameter_mm=8, position_mm=[0, 0, 15],
                 axis="-z", reflectance=0.9)
    return lu.Reflector("revolution", **{**given, **keys})


@pytest.fixture(scope="session")
def lamp(model):
    return lu.Scene([model], reflectors=[parabola()],
                    detectors=[lu.Detector("far-field", name="far", c_step_deg=15, gamma_step_deg=2.5),
                               lu.Detector("plane", name="floor", position_mm=[0, 0, -1000],
                                           size_mm=[600, 400], cells=[30, 20])])


@pytest.fixture(scope="session")
def traced(lamp):
    return lamp.trace(rays=RAYS)


@pytest.fixture(scope="session")
def program():
    found = os.environ.get("LUCERNA_PROGRAM") or shutil.which("lucerna")
    if not found:
        pytest.skip("no program: LUCERNA_PROGRAM is not set")

    def run(*arguments):
        done = subprocess.run([found, *map(str, arguments)], capture_output=True, text=True, check=False,
                              env=BARE)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
