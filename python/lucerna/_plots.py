# SPDX-License-Identifier: Apache-2.0
"""Plots on matplotlib, which is loaded when the first one is drawn."""
from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._types import InputError

# Standard errors to either side of a 95 % interval: Student's t for the 15 degrees of freedom of 16 replicates.
_INTERVAL = 2.131


def _kind(kind: str, known: dict[str, Any]) -> Any:
    if kind not in known:
        raise InputError(f"kind: found {kind!r}, expected {', '.join(map(repr, known))}",
                         found=repr(kind), expected=", ".join(map(repr, known)))
    return known[kind]


def _axes(ax: Any, projection: str | None = None) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.figure().add_subplot(projection=projection)


def _great_circle(light: Any, c_deg: float) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Angle from nadir (positive in C, negative in C + 180), intensity and its error."""
    gamma = light.gamma_deg
    angle = np.concatenate([-gamma[::-1], gamma])
    near, far = light.at(c_deg, gamma), light.at(c_deg + 180.0, gamma)
    values = np.concatenate([far[::-1], near])
    if light.standard_error is None:
        return angle, values, None
    error = _core.IntensityDistribution(light.c_deg, gamma, light.standard_error, unit=light.unit)
    return angle, values, np.concatenate([error.at(c_deg + 180.0, gamma)[::-1], error.at(c_deg, gamma)])


def _curves(light: Any, draw: Any) -> None:
    for c_deg, style in ((0.0, "-"), (90.0, "--")):
        draw(*_great_circle(light, c_deg), style, f"C{c_deg:.0f}-C{c_deg + 180:.0f}")


def _polar(light: Any, ax: Any) -> Any:
    ax = _axes(ax, "polar")

    def draw(angle: Any, values: Any, error: Any, style: str, label: str) -> None:
        radians = np.radians(angle)
        (line,) = ax.plot(radians, values, style, label=label)
        if error is not None:
            low, high = np.maximum(values - _INTERVAL * error, 0), values + _INTERVAL * error
            ax.fill_between(radians, low, high, color=line.get_color(), alpha=0.25, linewidth=0)

    _curves(light, draw)
    ax.set_theta_zero_location("S")
    ax.set_title(f"Intensity, {light.unit}")
    ax.legend(loc="upper left")
    return ax


def _cartesian(light: Any, ax: Any) -> Any:
    ax = _axes(ax)

    def draw(angle: Any, values: Any, error: Any, style: str, label: str) -> None:
        (line,) = ax.plot(angle, values, style, label=label)
        if error is not None:
            low, high = np.maximum(values - _INTERVAL * error, 0), values + _INTERVAL * error
            ax.fill_between(angle, low, high, color=line.get_color(), alpha=0.25, linewidth=0)

    _curves(light, draw)
    ax.set_xlabel("angle from nadir, degrees")
    ax.set_ylabel(f"intensity, {light.unit}")
    ax.legend()
    return ax


def _window(light: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Intensity over the angles from nadir along C0 and C90, as far as 1 % of the peak reaches."""
    bright = light.gamma_deg[(light.cd > 0.01 * light.cd.max()).any(axis=0)]
    reach = float(min(90.0, bright.max() if bright.size else 90.0))
    along = np.linspace(-reach, reach, 241)
    x, y = np.meshgrid(along, along)
    gamma = np.hypot(x, y)
    values = light.at(np.degrees(np.arctan2(y, x)), np.minimum(gamma, 180.0))
    return x, y, np.where(gamma <= reach, values, np.nan)


def _isocandela(light: Any, ax: Any) -> Any:
    ax = _axes(ax)
    x, y, values = _window(light)
    levels = np.nanmax(values) * np.array([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8])
    if levels[-1] > 0:
        lines = ax.contour(x, y, values, levels=levels)
        ax.clabel(lines, fmt="%.3g")
    return _angles(ax, light)


def _angles(ax: Any, light: Any) -> Any:
    ax.set_aspect("equal")
    ax.set_xlabel("angle from nadir along C0, degrees")
    ax.set_ylabel("angle from nadir along C90, degrees")
    ax.set_title(f"Intensity, {light.unit}")
    return ax


def _false_colours(light: Any, ax: Any) -> Any:
    ax = _axes(ax)
    x, y, values = _window(light)
    image = ax.pcolormesh(x, y, values, shading="auto", cmap="viridis")
    ax.figure.colorbar(image, ax=ax)
    return _angles(ax, light)


def plot_intensity(self: Any, kind: str = "polar", *, ax: Any = None) -> Any:
    """Draws the distribution; 95 % intervals are bands where the errors are known.

    Parameters
    ----------
    kind : str
        'polar', 'cartesian', 'isocandela' (lines at shares of the peak, over the lower hemisphere) or
        'false-colours'.
    ax : matplotlib.axes.Axes, optional
        Where to draw; polar for 'polar'.

    Returns
    -------
    matplotlib.axes.Axes
    """
    known = {"polar": _polar, "cartesian": _cartesian, "isocandela": _isocandela, "false-colours": _false_colours}
    return _kind(kind, known)(self, ax)


def plot_plane(self: Any, *, ax: Any = None) -> Any:
    """Draws the image in false colours.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    image = ax.pcolormesh(self.x_mm, self.y_mm, self.value, shading="nearest", cmap="viridis")
    ax.figure.colorbar(image, ax=ax, label=self.unit)
    ax.set_aspect("equal")
    ax.set_xlabel("x, mm")
    ax.set_ylabel("y, mm")
    ax.set_title(self.name)
    return ax


def _etendue(model: Any, ax: Any) -> Any:
    ax = _axes(ax)
    shares = np.linspace(0.0, 1.0, 101)
    ax.plot(model.etendue_mm2sr(shares), 100 * shares)
    ax.set_xlabel("étendue, mm² sr")
    ax.set_ylabel("brightest flux, %")
    return ax


def _luminance(model: Any, ax: Any) -> Any:
    """As seen from +z: along parallel rays that go to +z."""
    ax = _axes(ax)
    rays = model.sample(10_000, seed=1)
    facing = rays.kz > 0.1
    if not facing.any():
        facing = np.ones(len(rays), bool)
    # Where the rays cross the plane of the virtual focus.
    focus = rays.statistics().virtual_focus_mm
    z = float(rays.z_mm[facing].mean()) if focus is None else focus[2]
    t = (z - rays.z_mm[facing]) / np.maximum(rays.kz[facing], 0.1)
    x, y = rays.x_mm[facing] + t * rays.kx[facing], rays.y_mm[facing] + t * rays.ky[facing]
    reach = 1.1 * max(np.abs(np.quantile(v, q)) for v in (x, y) for q in (0.01, 0.99)) + 1e-6
    along = np.linspace(-reach, reach, 160)
    points = np.stack([*np.meshgrid(along, along), np.full((160, 160), z)], axis=-1)
    image = ax.pcolormesh(along, along, model.luminance(points, [0.0, 0.0, 1.0]), shading="nearest", cmap="viridis")
    ax.figure.colorbar(image, ax=ax, label="cd/m²" if model.unit == "lm" else "W/(m² sr)")
    ax.set_aspect("equal")
    ax.set_xlabel("x, mm")
    ax.set_ylabel("y, mm")
    return ax


def plot_model(self: Any, kind: str = "etendue", *, ax: Any = None) -> Any:
    """Draws the source.

    Parameters
    ----------
    kind : str
        'etendue' (brightest share of the flux over the étendue that holds it, mm2 sr) or 'luminance' (as seen
        from far away on the +z axis).
    ax : matplotlib.axes.Axes, optional

    Returns
    -------
    matplotlib.axes.Axes
    """
    return _kind(kind, {"etendue": _etendue, "luminance": _luminance})(self, ax)


def plot_design(self: Any, *, ax: Any = None) -> Any:
    """Draws how the design converged: relative error and noise floor over the rays traced.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    history = self.history
    ax.plot(history.rays, 100 * history.relative_rms, label="relative error")
    ax.plot(history.rays, 100 * history.floor, "--", label="noise floor")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlabel("rays")
    ax.set_ylabel("%")
    ax.legend()
    return ax


def _places(mirror: Any) -> tuple[np.ndarray, np.ndarray]:
    width, depth = mirror.aperture.size_mm
    return np.meshgrid(np.linspace(-width / 2, width / 2, 201), np.linspace(-depth / 2, depth / 2, 201))


def _sag(mirror: Any, ax: Any) -> Any:
    x, y = _places(mirror)
    return _map(ax, x, y, mirror.height_mm(x, y), "height, mm")


def _curvature(mirror: Any, ax: Any) -> Any:
    """Mean curvature, from differences of the exact slopes."""
    x, y = _places(mirror)
    h = 1e-4 * max(mirror.aperture.size_mm)
    dx = (mirror.slope(x + h, y) - mirror.slope(x - h, y)) / (2 * h)
    dy = (mirror.slope(x, y + h) - mirror.slope(x, y - h)) / (2 * h)
    p, q = np.moveaxis(mirror.slope(x, y), -1, 0)
    r, s, t = dx[..., 0], dx[..., 1], dy[..., 1]
    mean = ((1 + q**2) * r - 2 * p * q * s + (1 + p**2) * t) / (2 * (1 + p**2 + q**2) ** 1.5)
    return _map(ax, x, y, mean, "mean curvature, 1/mm")


def _map(ax: Any, x: Any, y: Any, values: Any, label: str) -> Any:
    ax = _axes(ax)
    image = ax.pcolormesh(x, y, values, shading="auto", cmap="viridis")
    ax.figure.colorbar(image, ax=ax, label=label)
    ax.set_aspect("equal")
    ax.set_xlabel("x, mm")
    ax.set_ylabel("y, mm")
    return ax


def _profile(mirror: Any, ax: Any) -> Any:
    ax = _axes(ax)
    ax.plot(*mirror.profile().T)
    ax.set_aspect("equal")
    ax.set_xlabel("r, mm")
    ax.set_ylabel("z, mm")
    return ax


def plot_reflector(self: Any, kind: str = "sag", *, ax: Any = None) -> Any:
    """Draws the mirror in its own frame.

    Parameters
    ----------
    kind : str
        'sag' (height, mm), 'curvature' (mean curvature, 1/mm) or 'profile' (the meridian y = 0).
    ax : matplotlib.axes.Axes, optional

    Returns
    -------
    matplotlib.axes.Axes
    """
    return _kind(kind, {"sag": _sag, "curvature": _curvature, "profile": _profile})(self, ax)
