# SPDX-License-Identifier: Apache-2.0
"""What a task file says, as optimisers need it: the room for the optic, the light that is wanted, the directions of
the source. The definitions are those of benchmarks/README.md, written a second time."""
import dataclasses
import json
import math
import pathlib
import re

import numpy as np

from .road import Road


@dataclasses.dataclass(frozen=True)
class Room:
    """Where an optic may be: |x| (or the radius) up to `half_mm`, z from `low_mm` to `high_mm`, and outside of a sphere
    about the source."""
    half_mm: float
    low_mm: float
    high_mm: float
    lamp_radius_mm: float = 0.0

    def focal_range_mm(self):
        """The focal lengths of paraboloids over the whole width that open to -z, with the focus in the source, and
        that this room holds: from the shortest to the longest."""
        # The rim is at f - half^2 / (4 f), which rises with f.
        shortest = 0.5 * (self.low_mm + math.hypot(self.low_mm, self.half_mm))
        shortest = max(shortest, self.lamp_radius_mm)
        if not shortest < self.high_mm:
            raise ValueError(f"limits: found room for no paraboloid in {self}, expected room for one")
        return shortest, self.high_mm

    def cap_range_mm(self, wall_mm=2.0):
        """Heights of spherical caps on a wall of a lens that this room holds: from nearly flat to nearly half a
        sphere."""
        return 0.5, min(self.half_mm - 4.0, self.high_mm - self.low_mm - wall_mm - 0.1)


def family_of(name):
    """LB-6 of LB-6-led-oval, LB-1 of LB-1a-flat-free."""
    return re.match(r"[A-Z]+-\d+|", name)[0] or name


@dataclasses.dataclass(frozen=True, eq=False)
class Task:
    file: pathlib.Path
    definition: dict
    room: Room

    @property
    def name(self):
        return self.definition["task"]

    @property
    def family(self):
        return family_of(self.name)

    @property
    def target(self):
        return self.definition["target"]

    @property
    def lit(self):
        """The light that an optic of one piece aims at: the target. Of a road it is the light of a lamp that makes its
        luminance even."""
        t = self.target
        if t["kind"] != "road":
            return t
        road, place = Road(t), t["place"]
        # Lanes lie side by side from the lamp's foot on.
        middle = np.asarray(place["origin_mm"]) + 0.5 * road.size_mm[1] * np.cross(place["z_axis"], place["x_axis"])
        return {"kind": "plane", "function": "even_luminance", "size_mm": road.size_mm, "road": road,
                "place": {**place, "origin_mm": middle.tolist()}}

    @property
    def source(self):
        return self.definition["source"]

    @property
    def kind(self):
        """The optic that is entered: a mirror, a trough, a lens of revolution, a free-lens or a horn."""
        if self.definition.get("target_place") == "free":
            return "horn"
        if self.target["kind"] == "angle":
            return "trough"
        if self.target["kind"] == "far_field" and self.definition["optics"]["roles"] == ["mirror"]:
            return "mirror"
        return "lens" if self.lit["function"] == "uniform_disk" and self.source["emitter"] == "disk" else "free-lens"

    @property
    def is_round(self):
        return self.lit["function"] in ("round_gaussian_beam", "batwing", "uniform_disk")


def read_task(file):
    """A task file. Raises ValueError with file, place, found and expected where it is none."""
    file = pathlib.Path(file)
    try:
        definition = json.loads(file.read_text())
    except (OSError, json.JSONDecodeError) as e:
        raise ValueError(f"{file}: file: found {e}, expected a task file") from None
    if not isinstance(definition, dict) or definition.get("format") != "lucerna-bench-task":
        raise ValueError(f"{file}: /format: found another format, expected lucerna-bench-task")
    return Task(file, definition, _room(file, definition["limits"]))


def _room(file, limits):
    half_mm = low_mm = high_mm = None
    lamp_mm = 0.0
    for k, limit in enumerate(limits):
        if limit["kind"] == "inside_cylinder":
            half_mm, (low_mm, high_mm) = limit["radius_mm"], limit["z_mm"]
        elif limit["kind"] == "inside_box":
            half_mm, low_mm, high_mm = limit["high_mm"][0], limit["low_mm"][2], limit["high_mm"][2]
        elif limit["kind"] == "outside_sphere" and limit["centre_mm"] == [0, 0, 0]:
            lamp_mm = limit["radius_mm"]
        else:
            raise ValueError(f"{file}: /limits/{k}: found {limit['kind']}, expected inside_cylinder, inside_box or "
                             "outside_sphere about the origin")
    if half_mm is None:
        raise ValueError(f"{file}: /limits: found no room, expected inside_cylinder or inside_box")
    return Room(half_mm, low_mm, high_mm, lamp_mm)


def illuminance(lit, x, y):
    """Relative illuminance that is wanted on a plane, at places in mm from its middle along its axes."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    if lit["function"] == "uniform_disk":
        return (np.hypot(x, y) <= lit["radius_mm"]).astype(float)
    if lit["function"] == "even_luminance":
        return lit["road"].illuminance(x, y + 0.5 * lit["size_mm"][1])
    return ((np.abs(x) <= 0.5 * lit["size_mm"][0]) & (np.abs(y) <= 0.5 * lit["size_mm"][1])).astype(float)


def intensity(target, u, v):
    """Relative intensity of a far-field target in direction cosines across its axis; 0 on the far side. Of a target in
    angles (LB-1) u and v are those of a trough along v: the target's intensity within each plane through v."""
    u, v = np.broadcast_arrays(np.asarray(u, float), np.asarray(v, float))
    w = np.sqrt(np.maximum(0.0, 1.0 - u * u - v * v))
    a, b = np.degrees(np.arctan2(u, w)), np.degrees(np.arctan2(v, w))
    gamma = np.degrees(np.arctan2(np.hypot(u, v), w))
    return np.where(u * u + v * v < 1.0, _INTENSITY[target["function"]](target, a, b, gamma, v), 0.0)


def _soft_step(x, edge, soft):
    return 1.0 / (1.0 + np.exp(np.minimum(60.0, 4.0 * (x - edge) / (soft * edge))))


def _cosine_power(t, a, _b, gamma, v):
    # Light of a Lambertian strip in a long trough: its plane angles a are as in two dimensions, and its sines v along
    # the trough go with sqrt(1 - v^2), whatever the trough does (an element of solid angle is da dv).
    if t["kind"] == "angle":
        return np.where(np.abs(a) <= t["edge_deg"],
                        np.cos(np.radians(a)) ** t["power"] * np.sqrt(np.maximum(0.0, 1.0 - v * v)), 0.0)
    return np.where(gamma <= t["edge_deg"], np.cos(np.radians(gamma)) ** t["power"], 0.0)


def _wall_washer(_t, a, b, _gamma, _v):
    rise = 0.25 + 0.75 / (1.0 + np.exp(-(a - 12.0) / 9.0))
    return rise * _soft_step(np.abs(a - 15.0), 48.0, 0.3) * np.exp2(-((b / 38.0) ** 2))


def _batwing(t, _a, _b, gamma, _v):
    light = np.cos(np.radians(np.minimum(gamma, 75.0))) ** -3.0 * _soft_step(gamma, t["edge_deg"], t["soft"])
    return np.where(gamma < 89.0, light, 0.0)


def _table(t, a, b, gamma, _v):
    """Bilinear between nodes, 0 beyond the last gamma. C0 is along u, C270 along v."""
    rows = np.asarray(t["rows"], float)
    rows = np.vstack([rows, rows[:1]])
    c = np.degrees(np.arctan2(-np.tan(np.radians(b)), np.tan(np.radians(a)))) % 360.0 / t["c_step_deg"]
    g = gamma / t["gamma_step_deg"]
    i, j = np.minimum(c.astype(int), len(rows) - 2), np.minimum(g.astype(int), rows.shape[1] - 2)
    s, k = c - i, g - j
    light = ((1.0 - s) * ((1.0 - k) * rows[i, j] + k * rows[i, j + 1])
             + s * ((1.0 - k) * rows[i + 1, j] + k * rows[i + 1, j + 1]))
    return np.where(g <= rows.shape[1] - 1, light, 0.0)


_INTENSITY = {
    "cosine_power": _cosine_power,
    "round_gaussian_beam": lambda t, a, b, gamma, v: np.exp2(-((2.0 * gamma / t["beam_deg"]) ** 2)),
    "gaussian_beam": lambda t, a, b, gamma, v: np.exp2(-((2.0 * a / t["beam_x_deg"]) ** 2
                                                         + (2.0 * b / t["beam_y_deg"]) ** 2)),
    "wall_washer": _wall_washer,
    "batwing": _batwing,
    "table": _table,
}


def source_directions(source, count, seed=1):
    """Directions of equal rays of an emitter, as rows: what is left of it when it shrinks to a point."""
    random = np.random.default_rng(seed)
    if source["emitter"] == "point":
        z = 1.0 - 2.0 * random.random(count)
        turn = 2.0 * np.pi * random.random(count)
        s = np.sqrt(1.0 - z * z)
        return np.stack([s * np.cos(turn), s * np.sin(turn), z], axis=-1)
    if source["emitter"] == "filament":
        return _filament_directions(source, count, random)
    if source["emitter"] in ("led", "disk", "rectangle"):
        return _lambertian(np.tile([0.0, 0.0, 1.0], (count, 1)), random)
    raise ValueError(f"/source/emitter: found {source['emitter']}, expected point, led, disk, rectangle or filament")


def _lambertian(normals, random):
    """Directions even in the projection on the surface."""
    radius, turn = np.sqrt(random.random(len(normals))), 2.0 * np.pi * random.random(len(normals))
    side = np.where(np.abs(normals[:, :1]) < 0.7, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    x = np.cross(side, normals)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(normals, x)
    z = np.sqrt(1.0 - radius**2)
    return (radius * np.cos(turn))[:, None] * x + (radius * np.sin(turn))[:, None] * y + z[:, None] * normals


def _filament_directions(source, count, random):
    """A wire of radius 0.06 mm coiled 12 times about x. Its image by inversion turns directions round."""
    winding, wire_mm = 2.0 * np.pi * 12.0, 0.06
    radius, length = source["radius_mm"], source["length_mm"]
    angle = winding * random.random(count)
    speed = math.hypot(length, radius * winding)
    bend = wire_mm * radius * winding**2 / speed**2
    # The outside of a bent wire has more surface: phi from it with density 1 + bend cos(phi), by rejection.
    phi = 2.0 * np.pi * random.random(2 * count + 100)
    phi = phi[random.random(len(phi)) * (1.0 + bend) < 1.0 + bend * np.cos(phi)][:count]
    zero = np.zeros(count)
    out = np.stack([zero, np.cos(angle), np.sin(angle)], axis=-1)
    tangent = np.stack([zero + length, -radius * winding * np.sin(angle), radius * winding * np.cos(angle)], -1) / speed
    normals = np.cos(phi)[:, None] * out + np.sin(phi)[:, None] * np.cross(tangent, out)
    turned = np.where(random.random(count) < source["ghost_share"], -1.0, 1.0)
    return turned[:, None] * _lambertian(normals / np.linalg.norm(normals, axis=1, keepdims=True), random)
