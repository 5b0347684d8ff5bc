# SPDX-License-Identifier: Apache-2.0
"""Writes docs/reference/python.md from the documentation of the package, which must be importable."""
import inspect
import pathlib
import re
import textwrap

import lucerna

PAGE = pathlib.Path(__file__).resolve().parents[1] / "docs/reference/python.md"
HEAD = """# Python

What `import lucerna` has. [Tutorial 5](../tutorials/python.md) shows how it is used. This page is
written by `scripts/write_python_reference.py` from the documentation of the package. A test fails
when it is not what the package has.

Lengths are in mm, angles in degrees, flux in lm or W. Options are given by name. A path is text or
any `os.PathLike`. `array_like` is what `numpy.asarray` takes; it is copied only where its type or
order asks for it. Arrays that are returned are read-only and keep alive what they belong to; the
values of an `Objective` may be written. Numbers of rays may be written as `1e6`. Nothing prints.

Objects may be shared between threads. Calls that compute release the interpreter's lock; what only
copies arrays, compares or pickles holds it. Ctrl-C stops a call that takes a callback, and is
raised behind any other: sampling into memory, comparing in memory and the figures of a trace are
not cut short. A callback is called ten times a second at most, and at the end; an exception of it
stops the call and is raised. Processes have to be started by the method `spawn` or `forkserver`. In
one that was forked, scenes, mirrors, traces and designs raise when they are used.

Errors are `lucerna.InputError` for bad input, `OSError` for files and `TypeError` for arguments of
a wrong type.
"""
FUNCTIONS = ["read_rays", "make_source", "compress", "read_model", "read_intensity", "compare", "compare_held_out", "merge", "read_trace",
             "design", "write_report", "build_info"]
CLASSES = ["RaySet", "SourceModel", "IntensityDistribution", "PlaneImage", "Reflector", "Source", "Body", "Detector",
           "Scene", "TraceResult", "DesignResult", "Objective", "Estimate", "Record", "InputError"]


def paragraphs(text):
    """Text of a docstring as wrapped lines."""
    parts = [" ".join(part.split()) for part in text.strip().split("\n\n")]
    return "\n\n".join(textwrap.fill(part, 98, break_long_words=False, break_on_hyphens=False) for part in parts)


def cell(text):
    return " ".join(text.split()).replace("|", "\\|")


def entries(text):
    """`name : type` with the indented meaning below, as rows."""
    rows = []
    for line in text.split("\n"):
        if line.startswith("    "):
            rows[-1][2] += " " + line.strip()
        elif line.strip():
            name, _, kind = line.partition(" : ")
            rows.append([name.strip(), kind.strip(), ""])
    return rows


def document(text):
    """A numpy docstring as Markdown."""
    parts = re.split(r"^(Parameters|Attributes|Returns|Raises)\n-+\n", text, flags=re.M)
    out = [paragraphs(parts[0])]
    for title, body in zip(parts[1::2], parts[2::2]):
        rows = entries(inspect.cleandoc(body))
        if title in ("Parameters", "Attributes"):
            lines = ["| name | type | meaning |", "|---|---|---|"]
            lines += [f"| `{cell(n)}` | {cell(kind)} | {cell(meaning)} |" for n, kind, meaning in rows]
        else:
            lines = [f"| {title.lower()} | |", "|---|---|"]
            lines += [f"| {cell(n + (': ' + kind if kind else ''))} | {cell(meaning)} |" for n, kind, meaning in rows]
        out.append("\n".join(lines))
    return "\n\n".join(part for part in out if part)


def plain(member):
    return getattr(member, "__func__", member)


def call(name, thing):
    """Name and signature as a block of code."""
    signature = inspect.signature(thing)
    kept = [p.replace(annotation=inspect.Parameter.empty) for p in signature.parameters.values() if p.name != "self"]
    text = f"{name}{signature.replace(parameters=kept, return_annotation=inspect.Signature.empty)}"
    return "```python\n" + "\n".join(textwrap.wrap(text, 96, subsequent_indent="    ")) + "\n```"


def members(cls):
    found = {}
    for base in reversed(cls.__mro__[:-1]):
        if base.__module__.startswith("lucerna"):
            found.update({key: value for key, value in vars(base).items() if not key.startswith("_")})
    return found


def class_section(name):
    cls = getattr(lucerna, name)
    out = [f"## {name}", document(inspect.getdoc(cls))]
    own = {} if name in ("Estimate", "Record", "InputError") else members(cls)
    facts = {key: value for key, value in own.items() if not callable(plain(value))}
    if name in ("Source", "Body", "Detector"):
        facts = {}
    if facts:
        rows = [f"| `{key}` | {cell(inspect.getdoc(value))} |" for key, value in facts.items()]
        out.append("\n".join(["| property | meaning |", "|---|---|", *rows]))
    for key, value in own.items():
        if key not in facts and callable(plain(value)):
            out += [f"### {name}.{key}", call(key, getattr(cls, key)), document(inspect.getdoc(plain(value)))]
    return out


def page():
    out = [HEAD.strip(), "## Functions"]
    for name in FUNCTIONS:
        thing = getattr(lucerna, name)
        out += [f"### {name}", call(name, thing), document(inspect.getdoc(thing))]
    for name in CLASSES:
        out += class_section(name)
    assert sorted([*FUNCTIONS, *CLASSES, "__version__"]) == sorted(lucerna.__all__)
    return "\n\n".join(out) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
