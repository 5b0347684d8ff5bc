# SPDX-License-Identifier: Apache-2.0
"""Designing a scene's mirror, and the design problem as a function for other optimisers."""
from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from . import _core, _toml


def _changed(scene: _core.Scene, target: Any, keys: Mapping[str, Any]) -> _core.Scene:
    """The scene with another target, and with `keys` of [design] besides those that it has."""
    if not isinstance(scene, _core.Scene):
        raise TypeError(f"scene: found a {type(scene).__name__}, expected a Scene; Scene.load reads a project file")
    keys = {key: value for key, value in keys.items() if value is not None}
    changes: dict[str, Any] = {}
    if target is not None:
        changes["target"] = _toml._target_keys(target)
    if keys:
        changes["design"] = {**_toml.tables(scene).get("design", {}), **keys}
    return _toml.replaced(scene, **changes) if changes else scene


def design(scene: _core.Scene, *, target: Any = None, limits: Mapping[str, Any] | None = None,
           time_s: float | None = None, seed: int = 1, max_rays: float = 2**23, device: str = "auto",
           tolerances: bool = False, pareto: bool = False, advise: bool = False,
           resume: _core.DesignResult | bytes | os.PathLike[str] | str | None = None, callback: Any = None,
           **keys: Any) -> _core.DesignResult:
    """Shapes a scene's mirror, or faces of its lens, until its light is the target's, as well as it can be.

    Parameters
    ----------
    scene : Scene
    target : IntensityDistribution, path_like or mapping, optional
        Instead of the scene's own; a mapping has the keys of [target].
    limits : mapping, optional
        Instead of the scene's own: the keys of [design.limits], as max_height_mm and symmetry.
    time_s : float, optional
        Seconds after which to have stopped; the scene's own where it is not given.
    seed : int
        Of all random numbers: the same design for the same seed, unless the time stops it.
    max_rays : int
        Rays of the finest evaluations, at least 8192; up to four times as many validate.
    device : str
        'cpu', 'cuda' or 'auto'.
    tolerances : bool
        Tries what a misplaced source and an inexact mirror change, too.
    pareto, advise : bool
        The trade between error and light, and what other outlines and families would bring, too; after the
        time.
    resume : DesignResult, bytes or path_like, optional
        A design of the same scene, its checkpoint, or its folder, to go on from.
    callback : callable, optional
        Gets a Record with phase and, once there are steps, evaluations, rays, relative_rms, floor, efficiency
        and in_rectangle of the best so far; ten times a second at most.
    **keys
        Other keys of [design]: free_sides, family, entry, intervals, optimizer, restarts, light_weight.

    Returns
    -------
    DesignResult
        After Ctrl-C the best so far, with `interrupted` true.

    Raises
    ------
    InputError
        On a scene that cannot be designed, and on a checkpoint of another one.
    """
    scene = _changed(scene, target, {"limits": limits, **keys})
    if isinstance(resume, _core.DesignResult):
        checkpoint = resume.checkpoint
    elif isinstance(resume, (str, os.PathLike)):
        with open(os.path.join(resume, "checkpoint"), "rb") as file:
            checkpoint = file.read()
    else:
        checkpoint = resume or b""
    return _core._design(scene, seed=seed, time_s=time_s, max_rays=max_rays, device=device, tolerances=tolerances,
                         pareto=pareto, advise=advise, checkpoint=checkpoint, callback=callback)


class Objective(_core._Objective):
    """A design problem as a function for any least-squares solver.

    `objective(x)` returns the residuals of a mirror's light against the target and their exact Jacobian,
    through all reflections, by the same rays each time. Parameters are heights in mm of the mirror's
    coefficients over its paraboloid. The sum of the squares of the first residuals, one a bin, is the squared
    relative error; one more is for light that misses the target's window (in shape mode), one for the limits.
    It never changes, so threads may share it. It pickles as its scene and options, and draws its rays anew.

    Parameters
    ----------
    scene : Scene
        With a mirror that can be designed: a paraboloid, a profile, a B-spline.
    target : IntensityDistribution, path_like or mapping, optional
        Instead of the scene's own.
    rays : int
        Of every evaluation.
    seed : int
        Of these rays.
    rim_mm : float, optional
        Width of the strip within the rims from which the Jacobian estimates light that crosses them, mm. With
        0 it is exactly that of the sums over the rays; 2 % of the mirror's radius where it is not given.
    callback : callable, optional
        Gets a Record with phase, done and total while the rays are drawn, ten times a second at most.

    Raises
    ------
    InputError
        On a scene that cannot be designed.
    """

    def __init__(self, scene: _core.Scene, target: Any = None, *, rays: float = 262144, seed: int = 1,
                 rim_mm: float | None = None, callback: Any = None) -> None:
        super().__init__(_changed(scene, target, {}), rays=rays, seed=seed, rim_mm=rim_mm, callback=callback)

    def reflector(self, x: Any) -> _core.Reflector:
        """The mirror of given parameters.

        Parameters
        ----------
        x : array_like (n,)
            Parameters, mm.

        Returns
        -------
        Reflector
        """
        return _toml.reflectors(self.scene(x))[0]
