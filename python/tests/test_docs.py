# SPDX-License-Identifier: Apache-2.0
"""The tutorial, the notebooks and the reference page: what they show is what happens."""
import contextlib
import io
import json
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
from run_tutorial import blocks, faults, prints_as  # noqa: E402


def test_lines_are_compared():
    assert prints_as("flux 316.9 +- 0.03 lm\n", "flux 317.5 +- 0.02 lm\n")
    assert not prints_as("flux 316.9 +- 0.03 lm\n", "flux 216.9 +- 0.03 lm\n")
    assert not prints_as("flux 316.9 +- 0.03 lm\n", "flux 316.9 +- 0.09 lm\n")
    assert not prints_as("a\nb\n", "a\n") and prints_as("a (...)\n", "a (1, 2)\n")
    assert not prints_as("True\n", "False\n")
    assert prints_as("a\n  ...\nz 1 ... 3\n", "a\nb\nc\nz 1 2 3\n") and not prints_as("a\n...\nz\n", "a\nb\n")
    assert prints_as("0.002 %\n", "0.003 %\n") and not prints_as("LM-63-2002\n", "LM-63-2019\n")
    assert not prints_as("x 5 ...\n", "x 6 y\n"), "numbers of a line with dots are compared, too"


def test_the_tutorial_prints_what_it_says():
    page = (ROOT / "docs/tutorials/python.md").read_text()
    assert len(blocks(page)) > 10
    assert list(faults(page, "python.md")) == []


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted((ROOT / "python/notebooks").glob("*.ipynb")), ids=lambda p: p.stem)
def test_notebooks_run(path):
    import matplotlib.pyplot as plt

    notebook = json.loads(path.read_text())
    assert notebook["nbformat"] == 4
    names = {}
    for number, cell in enumerate(notebook["cells"]):
        assert not cell.get("outputs"), "what a notebook shows is made anew"
        if cell["cell_type"] == "code":
            with contextlib.redirect_stdout(io.StringIO()):
                exec(compile("".join(cell["source"]), f"{path.name}:{number}", "exec"), names)  # noqa: S102
    plt.close("all")


def test_the_reference_page_is_that_of_the_code():
    import write_python_reference

    assert (ROOT / "docs/reference/python.md").read_text() == write_python_reference.page(), (
        "run scripts/write_python_reference.py")
