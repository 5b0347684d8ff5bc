# SPDX-License-Identifier: Apache-2.0
"""Entries of Lucerna: a task becomes a project, `lucerna design` shapes the optic, and what it wrote becomes the very
same surface as a B-spline of a submission."""
import math
import pathlib
import shutil
import subprocess
import tomllib

import numpy as np

from . import photometry
from .shapes import LENS_INDEX, MARGIN_MM, cap_height, free_lens_surfaces, mirror
from .surfaces import extruded_profile, height_field, placed, revolved, spline_through
from .tasks import Task

TROUGH_LENGTH_MM = 400.0
# Large beside the source, so that its size does not matter.
COLLECTOR_RADIUS_MM = 50.0
# The others' sources are small beside the lens, and their bottoms stay flat.
ENTRY_OF_FAMILY = {"LB-3": "bspline", "LB-4": "bspline"}
# Of LB-2 only the light counts.
LIGHT_WEIGHT_OF_COLLECTOR = 100
# Beside the project and its target, which are there before.
KEPT_FILES = ("reflector.toml", "lens.toml", "result.json", "history.csv")


def project(task: Task, folder):
    """Writes project.toml and its target to a folder; the share by which the target's table is off."""
    folder = pathlib.Path(folder)
    kind, off = task.kind, 0.0
    if kind == "horn":
        text = (sources(task.source, task.file) + _collector(task) + _plane_target(task, folder, target_place(task))
                + f"[design]\nlight_weight = {LIGHT_WEIGHT_OF_COLLECTOR}\n")
    elif kind in ("lens", "free-lens"):
        text = (sources(task.source, task.file) + _lens(task) + _plane_target(task, folder, task.lit["place"])
                + _lens_design(task, kind))
    else:
        table, off = photometry.sampled(task.target, task.is_round)
        (folder / "target.ies").write_text(table.ies(task.name), newline="")
        text = (sources(task.source, task.file) + _reflector(task, kind) + '[target]\nfile = "target.ies"\n[design]\n'
                + _keep_out(task, kind))
    (folder / "project.toml").write_text(text)
    return off


def sources(s, file):
    """An emitter of a task file by Lucerna's of the same definition. A strip is two-dimensional: a Lambertian rectangle in a
    long trough sends the same light over the angles across it (see `tasks.intensity`)."""
    lines = {"led": 'kind = "led"\n', "disk": f'kind = "disk"\nradius_mm = {s.get("radius_mm")}\n',
             "filament": f'kind = "filament"\nradius_mm = {s.get("radius_mm")}\nlength_mm = {s.get("length_mm")}\n'
                         f'ghost_share = {s.get("ghost_share")}\n',
             "rectangle": f'kind = "rectangle"\nsize_mm = {s.get("size_mm")}\n'}
    if s["emitter"] in lines:
        return f'[[source]]\n{lines[s["emitter"]]}surface = "none"\nflux_lm = 1000\naxis = "+z"\n'
    if s["emitter"] != "strip":
        raise ValueError(f"{file}: /source/emitter: found {s['emitter']}, expected {', '.join(lines)} or strip")
    half, ratio = s["half_width_mm"], s["right_to_left_luminance"]
    halves = [(-0.5 * half, 1000.0 / (1.0 + ratio)), (0.5 * half, 1000.0 * ratio / (1.0 + ratio))]
    return "".join(f'[[source]]\nkind = "rectangle"\nsize_mm = [{half}, 1]\nflux_lm = {flux}\n'
                   f'position_mm = [{x}, 0, 0]\naxis = "+z"\n' for x, flux in halves)


def start_focal_mm(task):
    """A paraboloid well within the room: a fifth of the way from the shortest focal length to the longest."""
    low, high = task.room.focal_range_mm()
    return round(low + 0.2 * (high - low), 3)


def _reflector(task, kind):
    focal, width = start_focal_mm(task), 2.0 * task.room.half_mm
    shape = (f'family = "bspline"\ndiameter_mm = {width}\n' if kind == "mirror" else
             f'family = "trough"\npreset = "parabola"\naperture = "rectangle"\n'
             f"size_mm = [{width}, {TROUGH_LENGTH_MM}]\n")
    return _above(task, shape, focal)


def _above(task, shape, focal):
    """A reflector above the source that opens to -z, with its focus in the source."""
    return (f'[[reflector]]\n{shape}focal_mm = {focal}\nposition_mm = [0, 0, {focal}]\naxis = "-z"\n'
            f'reflectance = {task.definition["optics"]["reflectance"]}\n')


def _keep_out(task, kind):
    """The room as volumes that the mirror keeps out of: above, below, and a ball about the lamp (a speck with a wide
    clearance)."""
    r = task.room
    x, y = r.half_mm + 1.0, (r.half_mm if kind == "mirror" else 0.5 * TROUGH_LENGTH_MM) + 1.0
    boxes = [(-x, -y, r.high_mm, x, y, r.high_mm + 100.0, MARGIN_MM),
             (-x, -y, r.low_mm - 100.0, x, y, r.low_mm, MARGIN_MM)]
    if r.lamp_radius_mm > 0.0:
        boxes.append((-1e-3, -1e-3, -1e-3, 1e-3, 1e-3, 1e-3, r.lamp_radius_mm + MARGIN_MM))
    return "".join(f'[[design.limits.keep_out]]\nkind = "box"\nmin_mm = [{a}, {b}, {c}]\nmax_mm = [{d}, {e}, {f}]\n'
                   f"clearance_mm = {gap}\n" for a, b, c, d, e, f, gap in boxes)


def _lens(task, wall_mm=2.0, corners=12):
    """A flat face next to the source, a wall, and a spherical cap of some corners: three fifths of the room that is left
    over the wall."""
    rim, bottom = task.room.half_mm - MARGIN_MM, task.room.low_mm + MARGIN_MM
    cap_mm = round(0.6 * (task.room.high_mm - MARGIN_MM - bottom - wall_mm), 3)
    r = np.linspace(rim, 0.0, corners)
    outer = [[float(a), float(b)] for a, b in zip(r, bottom + wall_mm + cap_height(rim, cap_mm, r))]
    outline = [[0.0, bottom], [rim, bottom], *outer]
    return (f'[[body]]\nrole = "solid"\nname = "lens"\nrefractive_index = {LENS_INDEX}\nsmooth_below_deg = 20\n'
            f"outline_mm = {outline}\naxis = \"+z\"\n")


def target_place(task):
    """Where Lucerna's entry has its target, if that is free: below the source, which shines up into a mirror. The mirror's
    rim is level with the source, and seen from the target within its largest angle."""
    if task.kind != "horn":
        return None
    return placed((0.0, 0.0, -COLLECTOR_RADIUS_MM / math.tan(math.radians(task.target["max_angle_deg"]))))


def _collector(task, intervals=20):
    """The ellipsoid from the source to the target, whose rim is level with the source, as a free form to begin with."""
    radius, down = COLLECTOR_RADIUS_MM, -target_place(task)["origin_mm"][2]
    # The way from focus to focus is the same by the rim and by the vertex.
    vertex = 0.5 * (radius + math.hypot(radius, down) - down)
    half_axis = vertex + 0.5 * down
    b2 = half_axis**2 - (0.5 * down) ** 2
    across = np.linspace(-radius, radius, 6 * intervals + 1)
    square = across**2 + across[:, None] ** 2
    # Beyond the rim its height goes on as a parabola of r^2: the ellipsoid ends before the spline's corners.
    cosine = np.sqrt(1.0 - np.minimum(square, radius**2) / b2)
    beyond = np.maximum(0.0, square - radius**2) / b2
    depth = half_axis * (1.0 - cosine + beyond / (2.0 * cosine) + beyond**2 / (8.0 * cosine**3))
    inverse = np.linalg.pinv(_cubic_pieces(across, -radius, radius, intervals))
    coefficients = inverse @ (depth - square / (4.0 * vertex)) @ inverse.T
    return _above(task, f'family = "bspline"\ndiameter_mm = {2.0 * radius}\nintervals = {2 * [intervals]}\n'
                        f"coefficients_mm = {coefficients.ravel().tolist()}\n", vertex)


def _plane_target(task, folder, place, cells=250, widened=1.25):
    """An even rectangle or disk of light, in a window that is a quarter wider."""
    t = task.lit
    half = [0.5 * widened * side for side in t.get("size_mm", 2 * [2.0 * t.get("radius_mm", 0.0)])]
    (folder / "target.csv").write_text(photometry.csv(photometry.lit_cells(t, half, cells)))
    return (f'[target]\nkind = "plane"\nfile = "target.csv"\nposition_mm = {place["origin_mm"]}\n'
            f'normal = "{"+z" if place["z_axis"][2] > 0 else "-z"}"\n'
            f"size_mm = {[2 * h for h in half]}\n")


def _lens_design(task, kind):
    """Of a lens of revolution 16 pieces of both faces move. A free form chooses its knots. The bottom is a free form too
    where the source is wide beside the lens, or the light beside what comes through a flat bottom."""
    entry = ENTRY_OF_FAMILY.get(task.family)
    sides = "[0, 2]" if kind == "lens" or entry else "2"
    shape = "intervals = 16\n" if kind == "lens" else 'family = "bspline"\n' + (f'entry = "{entry}"\n' if entry else "")
    return (f"[design]\nfree_sides = {sides}\n{shape}[design.limits]\n"
            f"max_diameter_mm = {2 * task.room.half_mm - MARGIN_MM}\n"
            f"max_height_mm = {task.room.high_mm - task.room.low_mm - 2 * MARGIN_MM}\nmin_thickness_mm = 0.5\n"
            + ('symmetry = "both"\n' if kind == "free-lens" and _is_even_in_both(task) else ""))


def _is_even_in_both(task):
    """Whether source and target are symmetric about the planes x = 0 and y = 0."""
    places = task.source["place"], task.target["place"]
    return (task.source["emitter"] in ("disk", "rectangle") and task.target["kind"] == "plane"
            and task.target["function"].startswith("uniform")
            and all(place["origin_mm"][:2] == [0, 0] and place["x_axis"] == [1, 0, 0] for place in places))


def design(lucerna, task, folder, time_s, threads=None, seed=1, device="cpu"):
    """Runs `lucerna design` in a folder; the designed project's text. A mirror that breaks a limit is returned, too:
    the scorer judges it."""
    folder = pathlib.Path(folder)
    command = [str(lucerna), "design", str(folder / "project.toml"), "-o", str(folder / "design"), "--time",
               str(time_s), "--seed", str(seed), "--device", device, "--quiet", "--force"]
    if threads is not None:
        command += ["--threads", str(threads)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as e:
        raise ValueError(f"{lucerna}: file: found {e.strerror}, expected the program lucerna") from None
    whole = done.returncode in (0, 1) and (folder / "design" / "result.json").exists()
    for name in ("lens.toml", "reflector.toml"):
        if whole and (folder / "design" / name).exists():
            return (folder / "design" / name).read_text()
    raise ValueError(f"{' '.join(command)}: found exit {done.returncode} and no result, expected a design: "
                     f"{done.stderr.strip()}")


def keep_files(folder):
    """Of a design's folder only the optic, the result and the history are kept."""
    folder = pathlib.Path(folder)
    for name in KEPT_FILES:
        if (folder / "design" / name).exists():
            shutil.move(folder / "design" / name, folder / name)
    shutil.rmtree(folder / "design", ignore_errors=True)


def surfaces_of(text, kind):
    """The surfaces of a designed project (reflector.toml, lens.toml), and the number of its free parameters."""
    tables = tomllib.loads(text)
    if kind in ("lens", "free-lens"):
        return (_lens_surfaces if kind == "lens" else _free_lens_surfaces)(tables["body"][0])
    r = tables["reflector"][0]
    if r["axis"] != "-z" or r["family"] not in ("bspline", "revolution"):
        raise ValueError(f"reflector: found {r['family']} along {r['axis']}, expected bspline or revolution along -z")
    vertex_mm = r["position_mm"][2]
    if r["family"] == "revolution":
        return _revolution(r, vertex_mm)
    height = spline_heights(r)
    nx, ny = r["intervals"]
    if kind == "trough":
        # Its spline takes y^2 / (4 f) away again: the profile is the height at y = 0.
        sheet = extruded_profile(lambda x: height(x, np.zeros_like(x)), 0.5 * r["size_mm"][0], intervals=nx)
        return [mirror(sheet, vertex_mm)], nx + 3
    half = 0.5 * r["diameter_mm"]
    trim = {"kind": "circle", "diameter_mm": r["diameter_mm"]}
    if r.get("hole_diameter_mm", 0.0) > 0.0:
        trim["hole_diameter_mm"] = r["hole_diameter_mm"]
    # Both are bicubic splines on the same knots, so going through the Greville points is exact.
    sheet = height_field(height, half, half, intervals=(nx, ny), trim=trim)
    return [mirror(sheet, vertex_mm)], free_coefficients(r)


def spline_heights(reflector):
    """Heights of Lucerna's free form, mm over its vertex: x^2 + y^2 over 4 f plus a bicubic B-spline whose knots are
    even over the aperture and go on evenly beyond it; coefficients along x first."""
    halves = [0.5 * s for s in reflector.get("size_mm", 2 * [reflector.get("diameter_mm")])]
    offset = _even_spline(reflector, halves)
    return lambda x, y: (x * x + y * y) / (4.0 * reflector["focal_mm"]) + offset(x, y)


def _coefficients(table):
    nx, ny = table["intervals"]
    return np.reshape(table["coefficients_mm"], (ny + 3, nx + 3))


def free_coefficients(table):
    """How many of a free form's coefficients are free: those that a symmetry ties together are one."""
    c = _coefficients(table)
    counts = [(n + 1) // 2 if np.allclose(c, np.flip(c, axis), rtol=0.0, atol=1e-12) else n
              for axis, n in enumerate(c.shape)]
    return counts[0] * counts[1]


def _even_spline(table, halves):
    """The bicubic B-spline of a table's `intervals` and `coefficients_mm` over |x| and |y| up to `halves`."""
    nx, ny = table["intervals"]
    c = _coefficients(table)

    def height(x, y):
        bx, by = (_cubic_pieces(at, -half, half, n) for at, half, n in zip((x, y), halves, (nx, ny)))
        return np.einsum("...j,...i,ji->...", by, bx, c)

    return height


def _cubic_pieces(x, low, high, intervals):
    """The values of all intervals + 3 even cubic B-splines at x, by the four polynomials of one."""
    x = np.asarray(x, float)
    at = (x - low) / (high - low) * intervals
    i = np.clip(at.astype(int), 0, intervals - 1)
    t = at - i
    values = np.zeros(x.shape + (intervals + 3,))
    pieces = ((1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6)
    for k, piece in enumerate(pieces):
        np.put_along_axis(values, (i + k)[..., None], piece[..., None], axis=-1)
    return values


def _revolution(reflector, vertex_mm):
    r, z = np.array(reflector["profile_mm"]).T
    knots, height = spline_through(r, z, flat_start=r[0] == 0.0)
    _, radius = spline_through(r, r, natural_start=r[0] == 0.0)
    surface = revolved(knots, np.stack([radius, height], axis=-1))
    # The curve goes outwards, so that its right is the mirror's back.
    return [{**mirror(surface, vertex_mm), "flip": True}], len(r)


def _curve_from_axis(corners):
    """Knots and control points (r, z) of the curve through corners that Lucerna has from the axis to an edge."""
    r, z = np.array(corners, float).T
    way = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(r), np.diff(z)))])
    knots, height = spline_through(way, z, flat_start=True)
    _, radius = spline_through(way, r, natural_start=True)
    return knots, np.stack([radius, height], axis=-1)


def _lens_surfaces(body):
    """Bottom, wall and outer face of the outline that `project` gave: from the axis out, up the wall and back. Between edges
    and on the axis Lucerna's faces are cubic splines through the corners over the length of the chords, level on the
    axis; a face of one side is straight."""
    corners = np.array(body["outline_mm"], float)
    walls = [i for i in range(1, len(corners) - 1) if abs(corners[i, 0] - corners[i + 1, 0]) < 1e-9]
    ends_on_axis = abs(corners[0][0]) < 1e-9 and abs(corners[-1][0]) < 1e-9
    if not ends_on_axis or len(walls) != 1 or len(corners) - walls[0] < 5:
        raise ValueError(f"outline_mm: found {corners.tolist()}, expected bottom, wall and an outer face to the axis")
    bottom, outer = corners[:walls[0] + 1], corners[walls[0] + 1:]
    # From the axis to the rim, as the spline's start is the one with the condition.
    knots, curve = _curve_from_axis(outer[::-1])
    faces = {"bottom": revolved([0, 0, 1, 1], bottom, degree=1) if len(bottom) == 2 else revolved(*_curve_from_axis(bottom)),
             "wall": revolved([0, 0, 1, 1], corners[walls[0]:walls[0] + 2], degree=1),
             "outer": revolved(knots[-1] - knots[::-1], curve[::-1])}
    parts = [{"name": name, "role": "interface", "bspline": face, "refractive_index": body["refractive_index"]}
             for name, face in faces.items()]
    return parts, len(outer) - 1 + (len(bottom) if len(bottom) > 2 else 0)


def _free_lens_surfaces(body):
    """Bottom, wall and free face of the body that `project` gave; the bottom may have got a cavity, or a free form."""
    outline = body["outline_mm"]
    entry = body.get("bottom_face")
    below = outline[1:] if entry else outline
    if len(below) < 3 or (entry or len(below) > 3) and below[-3][1] != below[-2][1] or below[-2][0] != below[-1][0]:
        raise ValueError(f"outline_mm: found {outline}, expected a flat bottom, with a hollow or not, and a wall")
    rim, bottom = below[-2]
    cavity = _curve_from_axis(below[:-2]) if not entry and len(below) > 3 else None
    hollow = (_sheet(entry, below[0][0]), below[0][0]) if entry else None
    free = free_coefficients(body["face"]) + (free_coefficients(entry) if entry else 0)
    return (free_lens_surfaces(_sheet(body["face"], rim), rim, bottom, body["refractive_index"], cavity, hollow),
            free + (0 if cavity is None else 2))


def _sheet(face, rim_mm):
    """A face within a circle. Both are bicubic splines on the same knots, as of mirrors."""
    half = face["half_mm"]
    return height_field(_even_spline(face, 2 * [half]), half, half, intervals=tuple(face["intervals"]),
                        trim={"kind": "circle", "diameter_mm": 2.0 * rim_mm})
