#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the code of tutorials with the Lucerna that is installed, and compares what is printed with the page.

Each page begins in a fresh folder. Blocks of `sh` are run by a shell that ends with the first command that
fails, blocks of `python` one after another in this interpreter; the block of `text` after one is what it
prints. Blocks of `cpp` and `cmake` become the file that the text before them names. The rules are those of
tests/tutorials_test.cpp.

Usage: scripts/run_tutorial.py PAGE...; ends with 1 if a page is not right
"""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"(?<![\w.-])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def blocks(page):
    """Language, text, line and file name of each fenced block."""
    found = []
    for m in re.finditer(r"^```(\w+)\n(.*?)^```$", page, re.M | re.S):
        named = re.findall(r"`([\w.-]+\.\w+)`", page[: m.start()])
        found.append((m[1], m[2], page[: m.start()].count("\n") + 1, named[-1] if named else ""))
    return found


def near(expected, printed, after_error):
    x, y = float(expected), float(printed)
    if after_error:
        return x <= 2 * y and y <= 2 * x
    last = 10.0 ** -len(expected.partition(".")[2]) if "." in expected and "e" not in expected else 0.0
    return abs(x - y) <= max(0.05 * max(abs(x), abs(y)), 1.001 * last)


def same_line(expected, printed):
    """`...` is any text within the line; numbers that stand by themselves are near; all else is exact."""
    if "..." in expected:
        head, _, rest = expected.partition("...")
        for end in range(len(printed) + 1):
            if same_line(head, printed[:end]):
                return any(same_line(rest, printed[start:]) for start in range(end, len(printed) + 1))
        return False
    if NUMBER.sub("#", expected).rstrip() != NUMBER.sub("#", printed).rstrip():
        return False
    return all(near(a[0], b[0], expected[: a.start()].endswith("+- "))
               for a, b in zip(NUMBER.finditer(expected), NUMBER.finditer(printed)))


def same_lines(expected, printed):
    if not expected:
        return not printed
    if expected[0].strip() == "...":
        return any(same_lines(expected[1:], printed[k:]) for k in range(len(printed) + 1))
    return bool(printed) and same_line(expected[0], printed[0]) and same_lines(expected[1:], printed[1:])


def prints_as(expected, printed):
    """Whether `printed` is what `expected` says; `...` alone on a line is any number of lines."""
    return same_lines(expected.rstrip().split("\n"), printed.rstrip().split("\n"))


def run_python(text, place, names):
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(text, place, "exec"), names)  # noqa: S102
    return out.getvalue()


def run_shell(text):
    done = subprocess.run(["sh", "-ec", text], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    return done.stdout + (f"\nends with {done.returncode}" if done.returncode else "")


def faults(page, name):
    """What is wrong with a page, one entry a block; runs it in the working folder."""
    found, names = blocks(page), {}
    for i, (language, text, line, file) in enumerate(found):
        if language in ("cpp", "cmake"):
            pathlib.Path(file).write_text(text)
            continue
        if language == "text":
            if i == 0 or found[i - 1][0] not in ("sh", "python"):
                yield f"line {line}: text that nothing prints"
            continue
        if language not in ("sh", "python"):
            yield f"line {line}: a block of '{language}' that nothing runs"
            continue
        printed = run_shell(text) if language == "sh" else run_python(text, f"{name}:{line}", names)
        expected = found[i + 1][1] if i + 1 < len(found) and found[i + 1][0] == "text" else ""
        if not prints_as(expected, printed):
            yield f"line {line} prints\n{printed}"


def main(pages):
    wrong = 0
    for page in map(pathlib.Path, pages):
        text, home = page.read_text(), os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for fault in faults(text, page.name):
                    print(f"{page.name}: {fault}")
                    wrong += 1
            finally:
                os.chdir(home)
        print(f"{page.name}: {len(blocks(text))} blocks run", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
