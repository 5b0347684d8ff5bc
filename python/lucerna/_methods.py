# SPDX-License-Identifier: Apache-2.0
"""Methods of the extension's classes that need nothing but Python."""
from __future__ import annotations

import functools
import html
import os
import tempfile
from collections.abc import Callable
from typing import Any

from . import _core, _plots, _toml


def _method(cls: type, name: str | None = None) -> Callable[[Any], Any]:
    """Makes a function a method (or a property) of a class of the extension."""

    def attach(function: Any) -> Any:
        plain = function.fget if isinstance(function, property) else function
        plain.__qualname__ = f"{cls.__name__}.{name or plain.__name__}"
        setattr(cls, name or plain.__name__, function)
        return function

    return attach


def _pickled_by_name(function: Any, name: str) -> Any:
    """A function of the extension as one of Python, which pickles; the extension's do not."""

    @functools.wraps(function)
    def call(*arguments: Any, **keys: Any) -> Any:
        return function(*arguments, **keys)

    call.__module__, call.__qualname__ = "lucerna", name
    return call


(build_info, compare_held_out, compress, make_source, merge, read_intensity, read_model, read_rays, read_trace,
 write_report) = (
    _pickled_by_name(_function, _function.__name__)
    for _function in (_core.build_info, _core.compare_held_out, _core.compress, _core.make_source, _core.merge,
                      _core.read_intensity, _core.read_model, _core.read_rays, _core.read_trace,
                      _core.write_report))

for _class, _name in ((_core.RaySet, "from_arrays"), (_core.Reflector, "from_toml"), (_core.Scene, "from_toml"),
                      (_core.Scene, "load")):
    _class_name = f"{_class.__name__}.{_name}"
    setattr(_class, _name, staticmethod(_pickled_by_name(getattr(_class, _name), _class_name)))


def compare(reference: Any, test: Any, *, rays: float = 4e6, seed: int = 1, callback: Any = None) -> Any:
    """How far two light sources, or two light distributions, are apart.

    Parameters
    ----------
    reference, test : RaySet or SourceModel; IntensityDistribution; or path_like
        Two of a kind. Files are ray files, models, IES and EULUMDAT files and folders of traces.
    rays : int
        Rays drawn from a model.
    seed : int
        Of these rays.
    callback : callable, optional
        For files: gets a Record with phase, done and total, ten times a second at most.

    Returns
    -------
    Record
        Of sources, for each view (far, near, focus, beam, four_d): error, floor (counting noise), excess (an
        Estimate: the test's own error), raw. Of distributions: relative_rms, bergen_fit, flux_ratio,
        peak_ratio, wasserstein_deg, overlap, noise_floor, excess; Estimates where errors are known.
    """
    if isinstance(reference, _core.IntensityDistribution) and isinstance(test, _core.IntensityDistribution):
        return _core._compare_intensities(reference, test)
    if isinstance(reference, (str, os.PathLike)) and isinstance(test, (str, os.PathLike)):
        return _core._compare_files(reference, test, rays, seed, callback)
    # Models are drawn from with seeds of their own, as their rays must not be the same.
    sets = [side.sample(rays, seed=seed + i) if isinstance(side, _core.SourceModel) else side
            for i, side in enumerate((reference, test))]
    if not all(isinstance(side, _core.RaySet) for side in sets):
        raise TypeError(f"expected two sources, two light distributions or two files, found "
                        f"{type(reference).__name__} and {type(test).__name__}")
    return _core._compare_rays(*sets)


def _report(thing: Any, path: Any) -> None:
    with tempfile.TemporaryDirectory() as folder:
        thing.save(folder)
        _core.write_report(folder, path)


@_method(_core.TraceResult)
def report(self: Any, path: Any) -> None:
    """Writes the trace as one self-contained HTML file.

    Parameters
    ----------
    path : path_like
    """
    _report(self, path)


@_method(_core.DesignResult, "report")
def _design_report(self: Any, path: Any) -> None:
    """Writes the design as one self-contained HTML file.

    Parameters
    ----------
    path : path_like
    """
    _report(self, path)


@_method(_core.SourceModel, "report")
def _model_report(self: Any, path: Any, *, ray_files: Any = ()) -> None:
    """Writes the model as one self-contained HTML file.

    Parameters
    ----------
    path : path_like
    ray_files : list of path_like
        Ray files that it is compared with.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "model.nfl")
        self.save(file)
        _core.write_report(file, path, ray_files=list(ray_files))


@_method(_core.Scene)
def replace(self: Any, *, target: Any = None, design: Any = None) -> Any:
    """The scene with another target or other keys of [design].

    Parameters
    ----------
    target : IntensityDistribution, path_like or mapping, optional
        What a design is to reach, with the keys of [target].
    design : mapping, optional
        All keys of [design].

    Returns
    -------
    Scene
    """
    changes = {} if target is None else {"target": _toml._target_keys(target)}
    return _toml.replaced(self, **changes, **({} if design is None else {"design": design}))


@_method(_core.Scene)
@property
def reflectors(self: Any) -> list[Any]:
    """The scene's mirrors, as Reflectors, but those of triangles."""
    return _toml.reflectors(self)


@_method(_core.Scene)
@property
def tables(self: Any) -> dict[str, Any]:
    """The tables of the scene's project file, as `tomllib` reads them."""
    return _toml.tables(self)


@_method(_core.DesignResult)
@property
def reflector(self: Any) -> Any:
    """The mirror that was found, a Reflector; None for a lens."""
    shaped = _toml.tables(self.scene).get("design", {}).get("reflector", 0)
    mirrors = _toml.reflectors(self.scene)
    return mirrors[int(shaped)] if mirrors else None


@_method(_core.Reflector)
@property
def keys(self: Any) -> dict[str, Any]:
    """The keys of its [[reflector]] table."""
    import tomllib

    return tomllib.loads(self.toml)["reflector"][0]


@_method(_core.Reflector, "replace")
def _reflector_replace(self: Any, **keys: Any) -> Any:
    """The mirror with other keys.

    Parameters
    ----------
    **keys
        Keys of the [[reflector]] table; None takes one away.

    Returns
    -------
    Reflector
    """
    return _core.Reflector(**{**self.keys, **keys})


@_method(_core.IntensityDistribution)
def to_xarray(self: Any) -> Any:
    """The distribution as an xarray.DataArray with dimensions C and gamma; units are in attrs.

    Returns
    -------
    xarray.DataArray
        In cd (or W/sr); the standard errors, where they are known, are its coordinate standard_error.
    """
    import xarray

    coordinates: dict[str, Any] = {"C": ("C", self.c_deg, {"units": "degrees"}),
                                   "gamma": ("gamma", self.gamma_deg, {"units": "degrees"})}
    if self.standard_error is not None:
        coordinates["standard_error"] = (("C", "gamma"), self.standard_error, {"units": self.unit})
    return xarray.DataArray(self.cd, coordinates, ("C", "gamma"), "intensity", {"units": self.unit})


@_method(_core.PlaneImage, "to_xarray")
def _plane_to_xarray(self: Any) -> Any:
    """The image as an xarray.DataArray with dimensions y and x; units are in attrs.

    Returns
    -------
    xarray.DataArray
        In `unit`; the standard errors are its coordinate standard_error.
    """
    import xarray

    coordinates = {"y": ("y", self.y_mm, {"units": "mm"}), "x": ("x", self.x_mm, {"units": "mm"}),
                   "standard_error": (("y", "x"), self.standard_error, {"units": self.unit})}
    return xarray.DataArray(self.value, coordinates, ("y", "x"), self.name, {"units": self.unit})


@_method(_core.IntensityDistribution)
def _repr_html_(self: Any) -> str:
    return self.polar_svg()


@_method(_core.TraceResult, "_repr_html_")
def _trace_html(self: Any) -> str:
    fields = [self[name] for name in self.detectors]
    polar = [field.polar_svg(title=name) for name, field in zip(self.detectors, fields)
             if isinstance(field, _core.IntensityDistribution)]
    return "\n".join([*polar, "<pre>", *map(html.escape, self.summary()), "</pre>"])


@_method(_core.DesignResult, "_repr_html_")
def _design_html(self: Any) -> str:
    return self.traced._repr_html_()


@_method(_core.RaySet, "__repr__")
def _rays_repr(self: Any) -> str:
    flux = self.flux_lm if self.unit == "lm" else self.flux_w
    return f"RaySet({len(self)} rays, {'flux not stated' if flux is None else f'{flux:.6g} {self.unit}'})"


@_method(_core.SourceModel, "__repr__")
def _model_repr(self: Any) -> str:
    return f"SourceModel({self.method}, {self.flux:.6g} {self.unit}, {self.leaves} leaves)"


@_method(_core.IntensityDistribution, "__repr__")
def _intensity_repr(self: Any) -> str:
    return f"IntensityDistribution({len(self.c_deg)} x {len(self.gamma_deg)}, flux {self.flux!s})"


@_method(_core.PlaneImage, "__repr__")
def _plane_repr(self: Any) -> str:
    return f"PlaneImage({self.name!r}, {self.value.shape[1]} x {self.value.shape[0]}, mean {self.mean} {self.unit})"


@_method(_core.Reflector, "__repr__")
def _reflector_repr(self: Any) -> str:
    return f"Reflector({', '.join(f'{key}={value!r}' for key, value in self.keys.items())})"


@_method(_core.Scene, "__repr__")
def _scene_repr(self: Any) -> str:
    counts = [f"{len(rows)} {name}" for name, rows in self.tables.items() if isinstance(rows, list)]
    return f"Scene({', '.join(counts)}, {self.flux:.6g} {self.unit})"


@_method(_core.TraceResult, "__repr__")
def _trace_repr(self: Any) -> str:
    return f"TraceResult(rays {self.rays[0]}:{self.rays[1]}, {', '.join(self.detectors)}, end={self.end!r})"


@_method(_core.DesignResult, "__repr__")
def _design_repr(self: Any) -> str:
    return f"DesignResult(relative_rms {self.relative_rms}, end={self.end!r})"


class _NotHere:
    """What an object becomes that was sent to a process in which it cannot be made: raises when it is used."""

    def __getattr__(self, name: str) -> Any:
        _core._check_call()  # which says why


# Their objects are read anew from what a pickle has, by parallel loops.
_PARSED = (_core.Scene, _core.Reflector, _core.TraceResult, _core.DesignResult, _core._Objective)


def _restored(cls: type, state: Any, attributes: dict[str, Any] | None) -> Any:
    """The object of a pickle. An exception here would make a pool start its workers again for ever."""
    if issubclass(cls, _PARSED) and _core._is_forked():
        return _NotHere()
    made = cls.__new__(cls)
    made.__setstate__(state)
    if attributes:
        made.__dict__.update(attributes)
    return made


def _reduce_ex(self: Any, protocol: int) -> Any:
    # The same for all protocols: the older ones would make an object of pybind11's base class.
    return _restored, (type(self), self.__getstate__(), getattr(self, "__dict__", None) or None)


for _class in (_core.RaySet, _core.SourceModel, _core.PlaneImage, *_PARSED):
    _class.__reduce_ex__ = _reduce_ex

for _class, _plot in ((_core.IntensityDistribution, _plots.plot_intensity), (_core.PlaneImage, _plots.plot_plane),
                      (_core.SourceModel, _plots.plot_model), (_core.DesignResult, _plots.plot_design),
                      (_core.Reflector, _plots.plot_reflector)):
    _method(_class, "plot")(_plot)
