# SPDX-License-Identifier: Apache-2.0
"""Small types that the extension and the package share."""
from __future__ import annotations

import contextlib
import os
import re
import tempfile
import threading
from typing import Any, NamedTuple


class InputError(ValueError):
    """Bad input: a file, a scene, an argument.

    Attributes
    ----------
    path : str or None
        The file.
    place : str or None
        Where in it: 'line 3', 'byte 20', 'ray 17 (byte 37468)', 'reflector[0].focal_mm'.
    found, expected : str or None
        What was found there, and what was expected.
    cause : str
        What kind of thing is wrong: 'invalid', 'out of range', 'missing', 'unknown key', 'contradiction',
        'mismatch', 'damaged', 'unsupported' or 'usage'.
    """

    def __init__(self, text: str, *, path: str | None = None, place: str | None = None,
                 found: str | None = None, expected: str | None = None, cause: str = "invalid") -> None:
        super().__init__(text)
        self.path, self.place, self.found, self.expected, self.cause = path, place, found, expected, cause

    def __reduce__(self) -> Any:
        return type(self), self.args, self.__dict__


class Estimate(NamedTuple):
    """A figure that came from rays, with its standard error.

    Attributes
    ----------
    value : float
        The best value.
    standard_error : float
        Of `value`, in its unit; not a number where it is not known.
    """

    value: float
    standard_error: float

    def __float__(self) -> float:
        return float(self.value)

    def __str__(self) -> str:
        from . import _core

        return _core.estimate_text(self.value, self.standard_error)


class Record(dict):
    """Named figures: `record.flux` is `record['flux']`."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"no figure is named '{name}'; there are {', '.join(map(str, self))}") from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *map(str, self)]

    def __str__(self) -> str:
        return "\n".join(_lines(self, ""))


def _lines(record: Record, indent: str) -> list[str]:
    width = max((len(str(key)) for key in record), default=0)
    lines = []
    for key, value in record.items():
        if isinstance(value, Record):
            lines += [f"{indent}{key}:", *_lines(value, indent + "  ")]
        else:
            lines.append(f"{indent}{key!s:{width}}  {value}")
    return lines


_BYTES = {"": 1, "b": 1, "k": 10**3, "kb": 10**3, "m": 10**6, "mb": 10**6, "kib": 2**10, "mib": 2**20}


def byte_count(size: int | str) -> int:
    """The bytes of 64000, '64k', '1MB' or '64KiB'."""
    text = str(size).strip().lower()
    match = re.fullmatch(r"([0-9.]+)\s*([a-z]*)", text)
    try:
        count = float(match[1]) * _BYTES[match[2]]  # type: ignore[index]
    except (TypeError, KeyError, ValueError):
        count = -1.0
    if not 0 <= count < 2**63 or count != int(count):
        raise InputError(f"max_bytes: found {size!r}, expected bytes, as 64000, '64k' or '64KiB'",
                         found=repr(size), expected="bytes, as 64000, '64k' or '64KiB'")
    return int(count)


def write_whole(path: os.PathLike[str] | str, data: bytes) -> None:
    """Writes a file whole or not at all."""
    temporary = f"{os.fspath(path)}.tmp{os.getpid()}-{threading.get_ident()}"
    try:
        with open(temporary, "wb") as file:
            file.write(data)
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


def make_intensity(c_deg: Any, gamma_deg: Any, cd: Any, unit: str, standard_error: Any, luminaire: Any,
                   flux: Any = None, metrics: Any = None) -> Any:
    """An IntensityDistribution of its pickle; flux and metrics where it was traced."""
    from . import _core

    values = _core.IntensityDistribution(c_deg, gamma_deg, cd, unit=unit, standard_error=standard_error,
                                         luminaire=luminaire)
    return values if flux is None else _core._with_figures(values, flux, metrics)


def read_folder(write: Any) -> tuple[list[str], dict[str, bytes]]:
    """What `write(folder)` returns, and the files that it leaves there."""
    with tempfile.TemporaryDirectory() as folder:
        names = write(folder)
        found = {}
        for place, _, files in os.walk(folder):
            for name in sorted(files):
                path = os.path.join(place, name)
                with open(path, "rb") as file:
                    found[os.path.relpath(path, folder)] = file.read()
        return names, found


def write_folder(folder: os.PathLike[str] | str, files: dict[str, bytes]) -> None:
    """Writes files into a folder, each whole or not at all."""
    for name, data in files.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        write_whole(path, data)
