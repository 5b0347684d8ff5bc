# SPDX-License-Identifier: Apache-2.0
"""The tutorial, the notebooks and the reference page: what they show is what happens."""
import contextlib
import io
import json
import pathlib
import re
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def blocks(page):
    """Language, text and line of each fenced block."""
    return [(m[1], m[2], page[: m.start()].count("\n") + 1)
            for m in re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S)]


def prints_as(expected, printed):
    """As the tutorials of the program are compared: `...` is any text of a line, numbers are near."""
    expected, printed = expected.rstrip().split("\n"), printed.rstrip().split("\n")
    return len(expected) == len(printed) and all(map(same_line, expected, printed))


def same_line(expected, printed):
    if "..." in expected:
        pattern = ".*".join(re.escape(part) for part in expected.split("..."))
        return re.fullmatch(pattern, printed) is not None
    if NUMBER.sub("#", expected) != NUMBER.sub("#", printed):
        return False
    previous = ""
    for a, b in zip(NUMBER.finditer(expected), NUMBER.finditer(printed)):
        previous = expected[: a.start()]
        x, y = float(a[0]), float(b[0])
        if previous.endswith("+- "):
            near = x <= 2 * y and y <= 2 * x
        else:
            near = abs(x - y) <= 0.05 * max(abs(x), abs(y))
        if not near:
            return False
    return True


def test_lines_are_compared():
    assert prints_as("flux 316.9 +- 0.03 lm\n", "flux 317.5 +- 0.02 lm\n")
    assert not prints_as("flux 316.9 +- 0.03 lm\n", "flux 216.9 +- 0.03 lm\n")
    assert not prints_as("flux 316.9 +- 0.03 lm\n", "flux 316.9 +- 0.09 lm\n")
    assert not prints_as("a\nb\n", "a\n") and prints_as("a (...)\n", "a (1, 2)\n")
    assert not prints_as("True\n", "False\n")


def test_the_tutorial_prints_what_it_says():
    page = (ROOT / "docs/tutorials/python.md").read_text()
    found = blocks(page)
    assert len(found) > 10
    names = {}
    for i, (language, text, line) in enumerate(found):
        if language == "text":
            assert found[i - 1][0] == "python", line
            continue
        assert language == "python", line
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile(text, f"python.md:{line}", "exec"), names)  # noqa: S102
        expected = found[i + 1][1] if i + 1 < len(found) and found[i + 1][0] == "text" else ""
        assert prints_as(expected, out.getvalue()), f"line {line} prints\n{out.getvalue()}"


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
    sys.path.insert(0, str(ROOT / "scripts"))
    try:
        import write_python_reference
    finally:
        sys.path.pop(0)
    assert (ROOT / "docs/reference/python.md").read_text() == write_python_reference.page(), (
        "run scripts/write_python_reference.py")
