# SPDX-License-Identifier: Apache-2.0
"""Scenes as text: Python's values as the tables of a project file."""
from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any

from . import _core
from ._types import InputError


class Table:
    """A table of a project file; its keys are attributes of the scene, with their units in their names."""

    name = ""

    def __init__(self, **keys: Any) -> None:
        self.keys = {key: value for key, value in keys.items() if value is not None}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={value!r}' for key, value in self.keys.items())})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and other.keys == self.keys  # type: ignore[attr-defined]


class Source(Table):
    """A [[source]]: a model, rays, a file, or (with `kind`) an analytic emitter.

    Parameters
    ----------
    of : SourceModel, RaySet or path_like, optional
        What the light comes from.
    **keys
        The keys of a [[source]] table of a project file: kind, flux_lm, position_mm, axis, turn_deg, ...
    """

    name = "source"

    def __init__(self, of: Any = None, **keys: Any) -> None:
        super().__init__(file=of, **keys) if of is not None else super().__init__(**keys)


class Body(Table):
    """A [[body]]: a housing, a lamp's body, a mirror of triangles, a cover glass, a lens.

    Parameters
    ----------
    role : str
        'absorber', 'mirror', 'lamp', 'glass' or 'solid'.
    **keys
        The keys of a [[body]] table of a project file: file, reflectance, diameter_mm, thickness_mm, ...
    """

    name = "body"

    def __init__(self, role: str = "absorber", **keys: Any) -> None:
        super().__init__(role=role, **keys)


class Detector(Table):
    """A [[detector]]: what is recorded.

    Parameters
    ----------
    kind : str
        'far-field', 'plane', 'luminance' or 'rays'.
    **keys
        The keys of a [[detector]] table of a project file: name, c_step_deg, size_mm, cells, from_mm, ...
    """

    name = "detector"

    def __init__(self, kind: str = "far-field", **keys: Any) -> None:
        super().__init__(kind=kind, **keys)


def _value(value: Any) -> str:
    """A value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return _text(os.fspath(value))
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + "}"
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return _value(value.tolist())
    if isinstance(value, int):
        return int.__repr__(value)  # not the name of an enumeration's member
    if isinstance(value, float):
        return float.__repr__(value)
    if isinstance(value, Iterable):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    raise TypeError(f"expected a number, text, path, sequence or mapping, found {type(value).__name__}")


def _text(text: str) -> str:
    """A text as TOML."""
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError(f"found the name {text!a}, expected text that is UTF-8, as project files are",
                         found=ascii(text), expected="text that is UTF-8") from None
    # The strings of JSON are strings of TOML but for DEL.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")


def _key(key: Any) -> str:
    if not isinstance(key, str):
        raise TypeError(f"expected keys that are text, found {key!r}")
    bare = key.isascii() and key.replace("_", "a").replace("-", "a").isalnum()
    return key if bare else _text(key)


def _lines(keys: Mapping[str, Any]) -> str:
    return "".join(f"{_key(key)} = {_value(value)}\n" for key, value in keys.items())


def _with_absolute_file(keys: Mapping[str, Any]) -> dict[str, Any]:
    keys = dict(keys)
    if isinstance(keys.get("file"), (str, os.PathLike)):
        keys["file"] = os.path.abspath(keys["file"])
    return keys


def reflector_text(family: str, **keys: Any) -> str:
    """The [[reflector]] table of a mirror."""
    given = {"family": family, **{key: value for key, value in keys.items() if value is not None}}
    return "[[reflector]]\n" + _lines(_with_absolute_file(given))


def absolute_reflector(text: str, folder: Any) -> str:
    """The text of a reflector whose file, if it has one, is found from any folder; `text` has been read."""
    keys = tomllib.loads(text)["reflector"][0]
    if "file" not in keys or os.path.isabs(keys["file"]):
        return text
    return reflector_text(**{**keys, "file": os.path.join(os.path.abspath(folder), keys["file"])})


def _keys_of(table: Any, kind: type[Table]) -> dict[str, Any]:
    if isinstance(table, kind):
        return table.keys
    if isinstance(table, Mapping):
        return dict(table)
    raise TypeError(f"expected a {kind.__name__} or a mapping, found {type(table).__name__}")


_FOLDER = "/in-memory/"
_FORMS = {_core.SourceModel: "model-{}.nfl", _core.RaySet: "rays-{}.tm25ray",
          _core.IntensityDistribution: "target-{}.ldt"}
_NUMBER = re.compile(f"{_FOLDER}[a-z]+-([0-9]+)[.]")


class _Memory:
    """Objects that a scene names as files."""

    def __init__(self) -> None:
        self.objects: dict[str, Any] = {}

    def name(self, thing: Any) -> str:
        for name, known in self.objects.items():
            if known is thing:
                return name
        # The same from any folder, so that a design can be resumed from any.
        form = next(form for cls, form in _FORMS.items() if isinstance(thing, cls))
        # Above all that are there, as some may have gone: another object never gets the name of one that has.
        numbers = [int(found[1]) for found in map(_NUMBER.search, self.objects) if found]
        name = _FOLDER + form.format(max([len(self.objects), *numbers]) + 1)
        self.objects[name] = thing
        return name

    def keys(self, keys: Mapping[str, Any]) -> dict[str, Any]:
        """Keys whose file may be an object."""
        keys = dict(keys)
        if isinstance(keys.get("file"), tuple(_FORMS)):
            keys["file"] = self.name(keys["file"])
        return _with_absolute_file(keys)


def _target_keys(target: Any) -> dict[str, Any]:
    keys = dict(target) if isinstance(target, Mapping) else {"file": target}
    if not isinstance(keys.get("file", ""), (_core.IntensityDistribution, str, os.PathLike)):
        raise TypeError("target: expected an IntensityDistribution, a path or a mapping, found "
                        f"{type(keys['file']).__name__}")
    return keys


def _design_lines(design: Any) -> str:
    if not isinstance(design, Mapping):
        raise TypeError(f"design: expected a mapping, found {type(design).__name__}")
    return "[design]\n" + _lines(design)


def scene_text(sources: Iterable[Any], reflectors: Iterable[Any], bodies: Iterable[Any],
               detectors: Iterable[Any], target: Any, design: Any) -> tuple[str, dict[str, Any]]:
    """The text of a scene, and the objects that it names as files."""
    memory = _Memory()
    parts = []
    for source in _several(sources, "sources"):
        things = (_core.SourceModel, _core.RaySet, str, os.PathLike)
        keys = {"file": source} if isinstance(source, things) else _keys_of(source, Source)
        parts.append("[[source]]\n" + _lines(memory.keys(keys)))
    for mirror in _several(reflectors, "reflectors"):
        parts.append(mirror.toml if isinstance(mirror, _core.Reflector) else reflector_text(**mirror))
    for body in _several(bodies, "bodies"):
        parts.append("[[body]]\n" + _lines(_with_absolute_file(_keys_of(body, Body))))
    for detector in _several(detectors, "detectors"):
        parts.append("[[detector]]\n" + _lines(_keys_of(detector, Detector)))
    if target is not None:
        parts.append("[target]\n" + _lines(memory.keys(_target_keys(target))))
    if design is not None:
        parts.append(_design_lines(design))
    return "\n".join(parts), memory.objects


def _several(things: Any, name: str) -> list[Any]:
    if isinstance(things, (str, os.PathLike, Mapping, Table)) or not isinstance(things, Iterable):
        raise TypeError(f"{name}: expected a sequence, found {type(things).__name__}")
    return list(things)


def tables(scene: _core.Scene) -> dict[str, Any]:
    """The tables of a scene's project file, as `tomllib` reads them."""
    return tomllib.loads(scene.to_toml())


def replaced(scene: _core.Scene, **changes: Any) -> _core.Scene:
    """The scene with other tables."""
    given = tables(scene)
    text = []
    for name in ("source", "reflector", "body", "detector"):
        text += [f"[[{name}]]\n" + _lines(keys) for keys in given.get(name, ())]
    memory = _Memory()
    memory.objects.update(scene.memory)
    target, design = (changes.get(name, given.get(name)) for name in ("target", "design"))
    if target is not None:
        target = memory.keys(target)
        text.append("[target]\n" + _lines(target))
    if design is not None:
        text.append(_design_lines(design))
    named = {keys.get("file") for keys in [*given.get("source", ()), target or {}]}
    kept = {name: thing for name, thing in memory.objects.items() if name in named}
    return _core.Scene.from_toml("\n".join(text), memory=kept)


def reflectors(scene: _core.Scene) -> list[_core.Reflector]:
    """The mirrors of a scene but those of triangles."""
    return [_core.Reflector(**keys) for keys in tables(scene).get("reflector", ()) if keys["family"] != "mesh"]
