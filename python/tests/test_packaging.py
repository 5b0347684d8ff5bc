# SPDX-License-Identifier: Apache-2.0
"""The wheel: built by the back end without a network, installed by pip, used in an environment of its own."""
import os
import pathlib
import subprocess
import sys
import zipfile

import pytest

ROOT = pathlib.Path(__file__).parents[2]


def run(*arguments, **keys):
    done = subprocess.run([str(a) for a in arguments], capture_output=True, text=True, check=False, **keys)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
def test_pip_installs_the_package_without_a_network(tmp_path):
    run(sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "venv")
    python = tmp_path / "venv/bin/python"
    bare = {**os.environ, "PIP_NO_INDEX": "1"}
    bare.pop("PYTHONPATH", None)  # the build's own package must not be found
    run(python, "-m", "pip", "wheel", ROOT, "--no-build-isolation", "--no-index", "--no-deps", "-w", tmp_path,
        env=bare)
    (wheel,) = tmp_path.glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    assert "lucerna/py.typed" in names and "lucerna/__init__.pyi" in names
    run(python, "-m", "pip", "install", "--no-index", wheel, env=bare)
    code = ("import lucerna, os; assert os.path.dirname(lucerna.__file__).startswith('" + str(tmp_path) + "');"
            "print(lucerna.__version__, len(lucerna.make_source('disk', 10)))")
    version = run(python, "-c", code, env=bare).split()[0]
    assert run(python, "-m", "lucerna", "--version", env=bare).strip() == version
    run(python, "-m", "pip", "uninstall", "-y", "lucerna", env=bare)
    assert not list((tmp_path / "venv").rglob("lucerna*"))


def test_the_source_archive_has_every_file(tmp_path):
    if not (ROOT / ".git").exists():
        pytest.skip("no repository")
    sys.path.insert(0, str(ROOT / "python"))
    try:
        import lucerna_build

        name = lucerna_build.build_sdist(str(tmp_path))
        assert name.startswith("lucerna-") and (tmp_path / name).stat().st_size > 10**5
        assert [p.name for p in tmp_path.iterdir()] == [name]
        assert lucerna_build._metadata().startswith("Metadata-Version: 2.1")
    finally:
        sys.path.pop(0)
