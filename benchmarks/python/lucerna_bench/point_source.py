# SPDX-License-Identifier: Apache-2.0
"""Zero-étendue baselines: optics that send the light of a point exactly where it is wanted, used with the real source.

- Mirrors of revolution and troughs: balance of flux and the law of reflection, d ln rho / d theta = tan((theta + gamma)
  / 2), with theta from the vertex and gamma the angle from the beam's axis. W. B. Elmer, "The Optical Design of
  Reflectors" (1980); R. Winston, J. C. Minano, P. Benitez, "Nonimaging Optics" (2005), chapter 7.
- Free mirrors: the lower or upper hull of paraboloids, an optimal transport with the cost -log(1 - d.e) between the
  directions d of the source and e of the target. V. I. Oliker, "Near radially symmetric solutions of an inverse problem
  in geometric optics", Inverse Problems 3, 743 (1987); X.-J. Wang, "On the design of a reflector antenna II", Calc.
  Var. 20, 329 (2004). Solved with entropy: M. Cuturi, "Sinkhorn Distances", NIPS 2013.
- Lenses of revolution with a flat entry: balance of flux and Snell's law, from ray to ray.
- Horns: two compound parabolic concentrators across each other.
- Free lenses with a flat entry that touches the source: a hull of ellipsoids, with the cost -log(1 - d.e / n).
  C. E. Gutierrez, Q. Huang, "The refractor problem in reshaping light beams", Arch. Rational Mech. Anal. 193 (2009).

What an optic cannot catch or turn is left out of the balance. One number is free, the distance of the vertex, and there
are a few variants: rays cross the axis or not, and the middle of the optic lights the middle of the target or its edge.
The scorer says which is best."""
import functools

import numpy as np

from .photometry import target_rectangle
from .shapes import LENS_INDEX, MARGIN_MM, free_lens_surfaces, horn_walls, lens_surfaces, mirror
from .surfaces import _basis, _greville, _knots, _surface, heights_at, placed, revolved, spline_through
from .tasks import illuminance, intensity, source_directions

# Every fortieth step is a point of a spline, the last one is.
STEPS = 2001
RAYS = 400_000
# What follows from a task alone is kept: a search asks for it again with every vertex distance.
of_task = functools.lru_cache(maxsize=32)


class NoSolution(ValueError):
    """There is no such optic, or it does not fit into its room."""


class Shares:
    """Shares of light within angles from an axis, from tables of both, and the angles of shares."""

    def __init__(self, angles_rad, shares):
        self.angles, self.shares = np.asarray(angles_rad, float), np.maximum.accumulate(np.asarray(shares, float))
        # Shares that do not rise have no angle of their own: a thousandth of a billionth keeps them apart.
        self.inverse = self.shares + 1e-12 * np.arange(len(self.shares))

    def within(self, angle_rad):
        return np.interp(angle_rad, self.angles, self.shares)

    def angle_of(self, share):
        return np.interp(share, self.inverse, self.angles)


@of_task
def directions_of(task):
    return source_directions(task.source, RAYS)


@of_task
def source_shares(task):
    """Light of the source within angles from +z, up to 180 degrees; of a strip the light within its plane."""
    angle = np.linspace(0.0, np.pi, 3601)
    if task.source["emitter"] == "strip":
        return Shares(angle, np.sin(np.minimum(angle, 0.5 * np.pi)))
    if task.source["emitter"] in ("led", "disk", "rectangle"):
        return Shares(angle, np.sin(np.minimum(angle, 0.5 * np.pi)) ** 2)
    found = np.sort(np.arccos(np.clip(directions_of(task)[:, 2], -1.0, 1.0)))
    return Shares(angle, np.searchsorted(found, angle) / RAYS)


@of_task
def target_shares(task):
    """The target's light within angles from its axis; of a target in angles to one side of it."""
    edge = np.linspace(0.0, 0.5 * np.pi, 9001)
    middle = 0.5 * (edge[1:] + edge[:-1])
    light = intensity(task.target, np.sin(middle), np.zeros_like(middle))
    if task.target["kind"] != "angle":
        light = light * np.sin(middle)
    sums = np.concatenate([[0.0], np.cumsum(light)])
    return Shares(edge, sums / sums[-1])


def wanted_of_mirror(target, source, caught, reflectance):
    """What a mirror that catches the share `caught` has to send within each angle: the target, less the light that
    falls there by itself."""
    direct = 1.0 - source.within(np.pi - target.angles)
    total = reflectance * caught + direct[-1]
    left = np.maximum.accumulate(np.maximum(0.0, total * target.shares - direct))
    if left[-1] <= 0.0:
        raise NoSolution("the light that meets no mirror is more than the target's")
    return Shares(target.angles, left / left[-1])


def mirror_profile(task, variant, vertex_mm):
    """Angles from the vertex, and points (r, z) about the source, of a mirror of revolution or one side of a trough
    that ends at the room's width. `variant` 0 to 3: crossing + 2 * inward."""
    source, target = source_shares(task), target_shares(task)
    sign, inward = (-1.0 if variant % 2 else 1.0), variant // 2 == 1
    reflectance = task.definition["optics"]["reflectance"]

    def profile(rim):
        theta = np.linspace(0.0, rim, STEPS)
        caught = source.within(theta)
        share = caught / caught[-1]
        wanted = wanted_of_mirror(target, source, caught[-1], reflectance)
        gamma = sign * wanted.angle_of(1.0 - share if inward else share)
        slope = np.tan(np.minimum(0.5 * (theta + gamma), 0.49 * np.pi))
        log_rho = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(theta))])
        rho = vertex_mm * np.exp(np.minimum(log_rho, 20.0))
        return theta, rho * np.sin(theta), rho * np.cos(theta)

    low, high = 0.02, 0.95 * np.pi
    if task.source["emitter"] == "strip":
        high = 0.499 * np.pi
    for _ in range(40):
        rim = 0.5 * (low + high)
        if profile(rim)[1].max() < task.room.half_mm:
            low = rim
        else:
            high = rim
    theta, r, z = profile(low)
    check_room(task.room, r, z)
    if np.any(np.diff(r) <= 0.0) or r[-1] < 0.9 * task.room.half_mm:
        raise NoSolution("the profile turns back before the rim")
    return theta, r, z


def check_room(room, r, z):
    if r.max() > room.half_mm or z.max() > room.high_mm or z.min() < room.low_mm \
            or np.hypot(r, z).min() < room.lamp_radius_mm:
        raise NoSolution(f"found radii to {r.max():.2f} and z from {z.min():.2f} to {z.max():.2f} mm, expected {room}")


def round_mirror(task, variant, vertex_mm):
    theta, r, z = (x[::40] for x in mirror_profile(task, variant, vertex_mm))
    knots, height = spline_through(theta, z, flat_start=True)
    _, radius = spline_through(theta, r, natural_start=True)
    # The curve goes outwards over the top, so that the source is to its right.
    surface = revolved(knots, np.stack([radius, height], axis=-1))
    return [{"name": "mirror", "role": "mirror", "bspline": surface, "place": placed()}]


def trough(task, variant, vertex_mm):
    theta, x, z = (x[::40] for x in mirror_profile(task, variant, vertex_mm))
    at = np.concatenate([-theta[:0:-1], theta])
    knots, across = spline_through(at, np.concatenate([-x[:0:-1], x]))
    _, height = spline_through(at, np.concatenate([z[:0:-1], z]))
    rows = [[[a, y, h] for y in (-1.0, 1.0)] for a, h in zip(across, height)]
    sheet = _surface((3, 1), knots, _knots(-1.0, 1.0, 1, 1), rows)
    return [{"name": "mirror", "role": "mirror", "bspline": sheet, "place": placed(), "flip": True}]


def transport(sign, a, b, cost, entropies=(0.1, 0.05, 0.02, 0.01, 0.006), rounds=300):
    """Potentials of the target's points: entropic optimal transport of the weights a to b, with the cost times `sign`;
    and the last entropy."""
    f, g = np.zeros(len(a)), np.zeros(len(b))
    for entropy in entropies:
        # The potentials so far in the kernel keep its entries in range: B. Schmitzer, SIAM J. Sci. Comput. 41 (2019).
        kernel = np.exp((f[:, None] + g - sign * cost) / entropy)
        u, v = np.ones(len(a)), np.ones(len(b))
        for _ in range(rounds):
            u = a / (kernel @ v)
            v = b / (u @ kernel)
        f, g = f + entropy * np.log(u), g + entropy * np.log(v)
    return g, entropy


def _from_disk(s, t):
    """Directions by stereographic coordinates: 0 is +z, 1 is the horizon."""
    k = 1.0 + s * s + t * t
    return np.stack([2.0 * s / k, 2.0 * t / k, (2.0 - k) / k], axis=-1)


class PointSurface:
    """A surface that turns light of a point into any beam: its distance in each direction, by optimal transport.
    Subclasses say what is bent how: `cost`, and the light there is."""

    CELLS, TARGET_CELLS = 30, 28

    def __init__(self, sign, vertex_mm):
        self.sign, self.vertex_mm = sign, vertex_mm

    def _solve(self, directions, flux, wanted):
        cost = self.cost(directions @ self.beam.T)
        self.potential, self.entropy = transport(self.sign, flux / flux.sum(), wanted / wanted.sum(), cost)
        self.scale = 1.0
        self.scale = self.vertex_mm / self.distance(np.array([[0.0, 0.0, 1.0]]))[0]

    def distance(self, directions):
        """The hull of the surfaces that make one direction each, soft by the entropy, mm."""
        soft = (self.potential - self.sign * self.cost(directions @ self.beam.T)) / self.entropy
        most = soft.max(axis=1)
        hull = -self.entropy * (most + np.log(np.exp(soft - most[:, None]).sum(axis=1)))
        return self.scale * np.exp(self.sign * hull)

    def height_spline(self, points, half, above_mm, sign, intervals=12):
        """A bicubic spline of heights, `above_mm` + `sign` z, through points of the surface by least squares, trimmed
        to a circle."""
        knots = _knots(-half, half, intervals, 3)
        bx, by = (_basis(knots, 3, points[:, k]) for k in (0, 1))
        rows = np.einsum("ki,kj->kij", bx, by).reshape(len(points), -1)
        smooth = 1e-3 * _third_differences(intervals + 3)
        right = np.concatenate([above_mm + sign * points[:, 2], np.zeros(len(smooth))])
        heights = np.linalg.lstsq(np.vstack([rows, smooth]), right, None)[0]
        x, y = np.meshgrid(_greville(knots, 3), _greville(knots, 3), indexing="ij")
        return _surface((3, 3), knots, knots, np.stack([x, y, heights.reshape(x.shape)], axis=-1),
                        trim={"kind": "circle", "diameter_mm": 2.0 * half})


class FreeMirror(PointSurface):
    """A mirror of a point source for any target."""

    WIDEST = 1.6

    def __init__(self, task, sign, vertex_mm, rounds=3):
        super().__init__(sign, vertex_mm)
        self.task = task
        centre = (np.arange(self.CELLS) + 0.5) * 2.0 * self.WIDEST / self.CELLS - self.WIDEST
        cells = _from_disk(*(x.ravel() for x in np.meshgrid(centre, centre, indexing="ij")))
        light = directions_of(task)
        disk = light[:, :2] / np.maximum(1e-9, 1.0 + light[:, 2:])
        flux = np.histogram2d(*disk.T, bins=self.CELLS, range=2 * [[-self.WIDEST, self.WIDEST]])[0].ravel() / RAYS
        self._set_target(light)
        # What the room's width holds of the mirror follows from its shape: at first that of a paraboloid.
        reach = 2.0 * vertex_mm / (1.0 + cells[:, 2] + 1e-9)
        for _ in range(rounds):
            hit = (reach * np.hypot(cells[:, 0], cells[:, 1]) <= task.room.half_mm) & (flux > 0.0)
            if not hit.any():
                raise NoSolution("the mirror is wider than its room in every direction")
            self._solve(cells[hit], flux[hit], self._left_for(flux[hit].sum()))
            reach = self.distance(cells)

    @staticmethod
    def cost(cosine):
        """Of a paraboloid that turns one direction into the other; bounded where light would have to go straight on."""
        return -np.log(np.maximum(0.02, 1.0 - cosine))

    def _set_target(self, light):
        low, high = target_rectangle(self.task.target, fine=512)
        edges = [np.linspace(low[k], high[k], self.TARGET_CELLS + 1) for k in (0, 1)]
        u, v = (x.ravel() for x in np.meshgrid(*(0.5 * (e[1:] + e[:-1]) for e in edges), indexing="ij"))
        down = light[light[:, 2] < 0.0]
        direct = np.histogram2d(down[:, 0], -down[:, 1], bins=edges)[0].ravel() / RAYS
        there = u * u + v * v < 0.999
        u, v, self.direct = u[there], v[there], direct[there]
        w = np.sqrt(1.0 - u * u - v * v)
        wanted = intensity(self.task.target, u, v) / w
        self.beam, self.wanted = np.stack([u, -v, -w], axis=-1), wanted / wanted.sum()

    def _left_for(self, caught):
        """The wanted light, less what falls there by itself."""
        total = self.task.definition["optics"]["reflectance"] * caught + self.direct.sum()
        return np.maximum(1e-12, total * self.wanted - self.direct)

    def surfaces(self, intervals=12, lines=70):
        half = self.task.room.half_mm
        at = np.linspace(-self.WIDEST, self.WIDEST, lines)
        directions = _from_disk(*(x.ravel() for x in np.meshgrid(at, at, indexing="ij")))
        points = self.distance(directions)[:, None] * directions
        points = points[np.abs(points[:, :2]).max(axis=1) <= half]
        within = points[np.hypot(points[:, 0], points[:, 1]) <= half]
        if len(within) < (intervals + 3) ** 2:
            raise NoSolution("the mirror does not fill its room")
        check_room(self.task.room, np.hypot(within[:, 0], within[:, 1]), within[:, 2])
        return [mirror(self.height_spline(points, half, self.vertex_mm, -1.0, intervals), self.vertex_mm)]


class FreeFace(PointSurface):
    """The outer face of a lens with a flat entry, for light on a rectangle. The source lies at the flat face:
    within the glass its light comes from one point, in directions within the critical angle."""

    def __init__(self, task, sign, vertex_mm):
        super().__init__(sign, vertex_mm)
        self.task, self.bottom_mm = task, task.room.low_mm + MARGIN_MM
        widest = 1.0 / LENS_INDEX
        centre = (np.arange(self.CELLS) + 0.5) * 2.0 * widest / self.CELLS - widest
        u, v = (x.ravel() for x in np.meshgrid(centre, centre, indexing="ij"))
        sine = np.hypot(u, v)
        inside = sine < 0.999 * widest
        u, v, sine = u[inside], v[inside], sine[inside]
        # Lambertian light is even in direction cosines, outside as inside of the glass.
        flux = 1.0 - fresnel(np.arcsin(LENS_INDEX * sine), np.arcsin(sine))
        middle = task.lit["place"]["origin_mm"]
        far = middle[2] - self.bottom_mm - vertex_mm
        x, y = (at + 0.5 * side * ((np.arange(self.TARGET_CELLS) + 0.5) * 2.0 / self.TARGET_CELLS - 1.0)
                for at, side in zip(middle, task.lit["size_mm"]))
        x, y = (p.ravel() for p in np.meshgrid(x, y, indexing="ij"))
        # The plane's y axis by its z and x axis.
        side_y = np.cross(task.lit["place"]["z_axis"], task.lit["place"]["x_axis"])[1]
        wanted = np.maximum(1e-6, illuminance(task.lit, x - middle[0], side_y * (y - middle[1])))
        self.beam = np.stack([x, y, np.full_like(x, far)], axis=-1)
        self.beam /= np.linalg.norm(self.beam, axis=1, keepdims=True)
        self._solve(np.stack([u, v, np.sqrt(1.0 - sine**2)], axis=-1), flux, wanted)

    @staticmethod
    def cost(cosine):
        """Of an ellipsoid that turns one direction into the other; bounded where glass cannot bend light so much."""
        return -np.log(np.maximum(0.02, 1.0 - cosine / LENS_INDEX))

    def surfaces(self, whole, intervals=16):
        """`whole`: as wide as its light reaches anywhere, else as it reaches everywhere."""
        room = self.task.room
        points = self._rings()
        ends = np.hypot(points[-1, :, 0], points[-1, :, 1])
        rim = min(room.half_mm - MARGIN_MM, ends.max() if whole else ends.min())
        points = np.concatenate([points, self._beyond(points, 1.5 * rim)]).reshape(-1, 3)
        points = points[np.abs(points[:, :2]).max(axis=1) <= rim]
        face = self.height_spline(points, rim, self.bottom_mm, 1.0, intervals)
        way, turn = np.linspace(0.0, rim, 25)[:, None], np.linspace(0.0, 2.0 * np.pi, 73)
        heights = heights_at(face, way * np.cos(turn), way * np.sin(turn))
        if heights.min() < self.bottom_mm + 0.1:
            raise NoSolution("the face comes down to the flat one")
        check_room(room, np.array([rim]), heights)
        return free_lens_surfaces(face, rim, self.bottom_mm)

    def _rings(self, rings=60, spokes=120):
        """Points of the face up to the critical angle, by ring and spoke."""
        sine = np.linspace(0.0, 0.999 / LENS_INDEX, rings)[:, None]
        turn = 2.0 * np.pi * np.arange(spokes) / spokes
        d = np.stack(np.broadcast_arrays(sine * np.cos(turn), sine * np.sin(turn), np.sqrt(1.0 - sine**2)), axis=-1)
        return self.distance(d.reshape(-1, 3)).reshape(rings, spokes, 1) * d

    @staticmethod
    def _beyond(points, radius_mm, rings=20):
        """No light comes there: straight on from the last two rings, so that a spline has no gap to bridge."""
        before, last = points[-3], points[-1]
        step = (last - before) / np.linalg.norm((last - before)[:, :2], axis=1, keepdims=True)
        left = np.maximum(0.0, radius_mm - np.linalg.norm(last[:, :2], axis=1, keepdims=True))
        return last + np.linspace(0.05, 1.0, rings)[:, None, None] * left * step


def _third_differences(n):
    d = np.diff(np.eye(n), 3, axis=0)
    return np.vstack([np.kron(d, np.eye(n)), np.kron(np.eye(n), d)])


def free_mirror(task, variant, vertex_mm):
    """`variant` 0: the lower hull, spreading rays; 1: the upper hull, crossing ones."""
    return FreeMirror(task, -1.0 if variant else 1.0, vertex_mm).surfaces()


def free_lens(task, variant, vertex_mm):
    """Variants as of `free_mirror`, each as wide as its light reaches anywhere (0, 1) or everywhere (2, 3)."""
    return FreeFace(task, -1.0 if variant % 2 else 1.0, vertex_mm).surfaces(variant < 2)


def round_lens(task, variant, vertex_mm):
    """A lens with a flat entry whose vertex is `vertex_mm` over it; variants as of `mirror_profile`."""
    n, room = LENS_INDEX, task.room
    bottom = room.low_mm + MARGIN_MM
    theta = np.linspace(0.0, np.radians(89.0), STEPS)
    inner = np.arcsin(np.sin(theta) / n)
    enters = np.sin(2.0 * theta) * (1.0 - fresnel(theta, inner))
    caught = np.concatenate([[0.0], np.cumsum(0.5 * (enters[1:] + enters[:-1]))])
    share = caught / caught[-1]
    # The lens is small beside its distance from the target: light leaves it as from the axis at the vertex.
    far = task.target["place"]["origin_mm"][2] - bottom - vertex_mm
    gamma = np.arctan(task.target["radius_mm"] * np.sqrt(1.0 - share if variant // 2 else share) / far)
    gamma = -gamma if variant % 2 else gamma
    if np.any(n * np.cos(inner - gamma) <= 1.001):
        raise NoSolution("light would have to be bent by more than the glass can")
    d, e = (np.stack([np.sin(x), np.cos(x)], axis=-1) for x in (inner, gamma))
    normal = n * d - e
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    start = bottom * np.tan(theta)
    points = [np.array([0.0, vertex_mm])]
    for k in range(1, STEPS):
        # The next ray meets the plane across the mean of both normals; heights count from the bottom.
        across = normal[k - 1] + normal[k]
        origin = np.array([start[k], 0.0])
        points.append(origin + (across @ (points[-1] - origin)) / (across @ d[k]) * d[k])
    points = np.array(points)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    if np.any(np.diff(points[:, 0]) <= 0.0) or points[-1, 1] < 0.1:
        raise NoSolution("the face turns back")
    check_room(room, points[:, 0] + MARGIN_MM, points[:, 1] + bottom)
    # As many even pieces of the curve as a spline needs.
    at = np.linspace(0.0, way[-1], 50)
    r, z = (np.interp(at, way, points[:, k]) for k in (0, 1))
    knots, height = spline_through(at, z, flat_start=True)
    _, radius = spline_through(at, r, natural_start=True)
    outer = np.stack([radius, height], axis=-1)[::-1]
    return lens_surfaces(room, at[-1] - knots[::-1], outer)


def fresnel(outside, inside):
    """Share of unpolarised light that a face reflects, by the angles to its normal outside and inside of the glass."""
    ca, cb, n = np.cos(outside), np.cos(inside), LENS_INDEX
    return 0.5 * (((ca - n * cb) / (ca + n * cb)) ** 2 + ((n * ca - cb) / (n * ca + cb)) ** 2)


# Of a horn along x; along y it is what the étendue leaves. At 2 both acceptance angles are 30 degrees.
WIDENING = (1.5, 2.9)


def compound_parabolic_horn(task, _variant, widening, intervals=32):
    """Two troughs across each other, each a compound parabolic concentrator that is used the other way: edge rays of
    the entry leave at the edges of the cone (R. Winston, J. C. Minano, P. Benitez, "Nonimaging Optics", 2005, chapter
    4). The shorter one goes on straight."""
    across = widening, 1.0 / (widening * np.sin(np.radians(task.target["max_angle_deg"])) ** 2)
    profiles = [_concentrator(0.5 * side, ratio) for side, ratio in zip(task.source["size_mm"], across)]
    length = max(z[-1] for z, _ in profiles)
    knots = _knots(0.0, length, intervals, 3)
    at = _greville(knots, 3)
    basis = _basis(knots, 3, at)
    return horn_walls(knots, at, *(np.linalg.solve(basis, np.interp(at, z, half)) for z, half in profiles))


def _concentrator(half_mm, ratio):
    """Heights and half widths, from the narrow end to one `ratio` times as wide."""
    accepted = np.arcsin(1.0 / ratio)
    focal = half_mm * (1.0 + np.sin(accepted))
    turn = np.linspace(0.5 * np.pi + accepted, 2.0 * accepted, 400)
    reach = 2.0 * focal / (1.0 - np.cos(turn))
    return reach * np.cos(turn - accepted), reach * np.sin(turn - accepted) - half_mm


def candidates(task, distances=9):
    """Makers of surfaces, how many variants they have, and vertex distances to try: the middle ones first. Of a horn
    the number is how many times as wide as its entry it is along x."""
    kind = task.kind
    if kind == "horn":
        make, variants, (low, high) = compound_parabolic_horn, 1, WIDENING
    elif kind.endswith("lens"):
        make, variants = (round_lens, 4) if kind == "lens" else (free_lens, 4)
        low, high = 0.2 * task.room.high_mm, 0.9 * task.room.high_mm
    else:
        low, high = max(task.room.lamp_radius_mm + 1.0, task.room.low_mm, 0.15 * task.room.half_mm), task.room.high_mm
        make, variants = (trough, 4) if kind == "trough" else (round_mirror, 4) if task.is_round else (free_mirror, 2)
    at = np.linspace(low, high, distances + 2)[1:-1]
    order = sorted(range(distances), key=lambda k: abs(k - distances // 2))
    return make, variants, [float(at[k]) for k in order]
