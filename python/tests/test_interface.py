# SPDX-License-Identifier: Apache-2.0
"""The stubs against the live signatures, the documentation of every public name, what loads when."""
import ast
import inspect
import pathlib
import re
import subprocess
import sys

import lucerna as lu
import pytest

STUBS = pathlib.Path(lu.__file__).with_name("__init__.pyi")
PUBLIC = [name for name in lu.__all__ if not name.startswith("_")]
# The page of a project file's keys has those of these.
TABLES = {"Source", "Body", "Detector"}


def stub_tree():
    return {node.name: node for node in ast.parse(STUBS.read_text()).body
            if isinstance(node, (ast.ClassDef, ast.FunctionDef))}


def parameters(node):
    """Name, kind and default of each parameter of a stub, but self."""
    given = node.args
    found = []
    plain = [(a.arg, "positional-only") for a in given.posonlyargs] + [(a.arg, "positional") for a in given.args]
    defaults = [None] * (len(plain) - len(given.defaults)) + given.defaults
    found += [(name, kind, default) for (name, kind), default in zip(plain, defaults)]
    found += [(a.arg, "keyword", d) for a, d in zip(given.kwonlyargs, given.kw_defaults)]
    if given.kwarg:
        found.append((given.kwarg.arg, "keywords", None))
    return [(name, kind, None if default is None else eval(ast.unparse(default)))  # noqa: S307
            for name, kind, default in found if name != "self"]


KINDS = {inspect.Parameter.POSITIONAL_ONLY: "positional-only", inspect.Parameter.POSITIONAL_OR_KEYWORD: "positional",
         inspect.Parameter.KEYWORD_ONLY: "keyword", inspect.Parameter.VAR_KEYWORD: "keywords"}


def live_parameters(thing):
    return [(p.name, KINDS[p.kind], None if p.default is inspect.Parameter.empty else p.default)
            for p in inspect.signature(thing).parameters.values() if p.name != "self"]


def members(cls):
    return {name: member for base in reversed(cls.__mro__[:-1]) if base.__module__.startswith("lucerna")
            for name, member in vars(base).items()}


def functions():
    for name, node in stub_tree().items():
        if isinstance(node, ast.FunctionDef):
            yield pytest.param(getattr(lu, name), node, id=name)
        else:
            for item in node.body:
                if isinstance(item, ast.FunctionDef) and not item.decorator_list and not item.name.startswith("__"):
                    yield pytest.param(getattr(getattr(lu, name), item.name), item, id=f"{name}.{item.name}")
                elif isinstance(item, ast.FunctionDef) and "staticmethod" in ast.dump(item)[-200:]:
                    yield pytest.param(getattr(getattr(lu, name), item.name), item, id=f"{name}.{item.name}")


@pytest.mark.parametrize("thing, node", functions())
def test_stubs_have_the_live_signatures(thing, node):
    assert parameters(node) == live_parameters(thing)


@pytest.mark.parametrize("name", ["Scene", "IntensityDistribution", "Reflector", "Source", "Body", "Detector",
                                  "Objective", "InputError"])
def test_stubs_have_the_signatures_of_classes(name):
    (node,) = (item for item in stub_tree()[name].body if getattr(item, "name", "") == "__init__")
    assert parameters(node) == live_parameters(getattr(lu, name))


@pytest.mark.parametrize("thing, node", [p for p in functions() if not inspect.isfunction(inspect.unwrap(p.values[0]))])
def test_signatures_are_those_of_the_extension(thing, node):
    """What the documentation says against what the extension takes, as its own TypeError has it."""
    with pytest.raises(TypeError) as caught:
        thing(__no_such_argument=1)
    text = re.search(r"1\. (?:\w*)\((.*)\) ->", str(caught.value))[1]
    taken = re.findall(r"(?:^|, )(\w+): ", re.sub(r"\[[^\[\]]*\]", "", re.sub(r"\[[^\[\]]*\]", "", text)))
    assert [name for name in taken if name != "self"] == [name for name, *_ in parameters(node)]


def test_stubs_and_module_have_the_same_names():
    tree = stub_tree()
    assert sorted(tree) == sorted(PUBLIC)
    for name, node in tree.items():
        if not isinstance(node, ast.ClassDef) or name in {"Estimate", "Record", "InputError"}:
            continue
        stubs = {item.name if isinstance(item, ast.FunctionDef) else item.target.id for item in node.body}
        live = {key for key in members(getattr(lu, name)) if not key.startswith("_")}
        if name in TABLES:
            live = live - {"name"} | {"keys"}  # of each object, not of the class
        assert {s for s in stubs if not s.startswith("_")} == live, name


def public_things():
    for name in PUBLIC:
        thing = getattr(lu, name)
        yield pytest.param(thing, id=name)
        if inspect.isclass(thing):
            for key, member in members(thing).items():
                if not key.startswith("_") and name != "Estimate" and not (name in TABLES and key == "name"):
                    yield pytest.param(member, id=f"{name}.{key}")


@pytest.mark.parametrize("thing", public_things())
def test_every_public_name_is_documented(thing):
    text = inspect.getdoc(getattr(thing, "__func__", thing)) or ""
    assert len(text) > 15 and text.split("\n")[0].endswith((".", ":")), text
    if callable(thing) and not inspect.isclass(thing):
        names = [name for name, kind, _ in live_parameters(getattr(thing, "__func__", thing))]
        for name in names:
            assert re.search(rf"\b{name}\b.*( : |$)|{name}, \w+ : |, {name}( :|$)", text, re.M), f"{name} in\n{text}"


def test_units_are_in_names_or_texts():
    for stub in stub_tree().values():
        for item in getattr(stub, "body", ()):
            assert not re.search(r"_(m|cm|rad|degrees)$", getattr(item, "name", ""))


def test_matplotlib_and_xarray_are_loaded_late():
    code = ("import sys, lucerna\n"
            "assert not {'matplotlib', 'xarray', 'scipy'} & set(sys.modules), sys.modules\n")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_typed():
    assert STUBS.with_name("py.typed").exists()
