# SPDX-License-Identifier: Apache-2.0
"""LB-F1: rays per second through a mirror that is given, emission and boxes included. An entrant traces as many rays as
it is asked for; its light must be that of the scorer, box by box. Starting a program takes time that is not its speed:
two runs of different length tell it apart."""
import csv
import dataclasses
import json
import math
import pathlib
import statistics
import tempfile
import time

import numpy as np

from .entry import write_whole
from .lucerna_entry import sources
from .programs import run
from .stl import disk_triangles, write_stl
from .surfaces import heights_at

BOXES = 48
# Chi^2 is nearly normal with so many boxes: once in three million by chance.
MOST_DEVIATION = 5.0


@dataclasses.dataclass(frozen=True)
class Scene:
    """A folder with task.json, submission.json and, for Lucerna, reflector.toml: the same mirror twice."""
    folder: pathlib.Path

    @property
    def name(self):
        return self.folder.name

    @property
    def task(self):
        return json.loads((self.folder / "task.json").read_text())


def scenes(folder):
    """All scenes below a folder."""
    found = [Scene(file.parent) for file in sorted(pathlib.Path(folder).glob("LB-F1-*/task.json"))]
    if not found:
        raise ValueError(f"{folder}: found no LB-F1-*/task.json, expected scenes")
    return found


def column(file, name):
    with open(file, encoding="ascii") as text:
        return np.array([float(row[name]) for row in csv.DictReader(text)])


class Scorer:
    """The scorer's own tracer: Embree and Newton's method."""

    def __init__(self, program):
        self.program = program

    def shares(self, scene, rays, seed, threads, folder):
        out = pathlib.Path(folder) / "boxes.csv"
        run([self.program, scene.folder / "task.json", scene.folder / "submission.json", "--rays", str(rays), "--seed",
             str(seed), "--threads", str(threads), "--boxes", out])
        return column(out, "share")


class Triangles(Scorer):
    """The same with the mirror as triangles, so that Embree alone finds hits; normals are interpolated between corners."""

    def __init__(self, program):
        super().__init__(program)
        self.made = {}

    def shares(self, scene, rays, seed, threads, folder):
        if scene.name not in self.made:
            self.made[scene.name] = self.triangulated(scene, pathlib.Path(folder))
        return super().shares(self.made[scene.name], rays, seed, threads, folder)

    @staticmethod
    def triangulated(scene, folder):
        """The scene in a folder of its own."""
        given = json.loads((scene.folder / "submission.json").read_text())
        mirror = given["surfaces"][0]
        sheet = mirror.pop("bspline")
        write_stl(folder / "mirror.stl", disk_triangles(lambda x, y: heights_at(sheet, x, y),
                                                        0.5 * sheet["trim"]["diameter_mm"]))
        mirror.update(stl="mirror.stl", normals="interpolated")
        (folder / "submission.json").write_text(json.dumps(given))
        (folder / "task.json").write_text(json.dumps(scene.task))
        return Scene(folder)


class LucernaTrace:
    """`lucerna trace` with a plane detector."""

    def __init__(self, program):
        self.program = program

    def shares(self, scene, rays, seed, threads, folder):
        folder = pathlib.Path(folder)
        # The boxes of a score leave out a quarter of a per cent of even light at each side.
        side_mm = 0.995 * scene.task["target"]["size_mm"][0]
        (folder / "p.toml").write_text(self.project(scene, side_mm))
        run([self.program, "trace", folder / "p.toml", "-o", folder / "out", "--rays", str(rays), "--seed", str(seed),
             "--threads", str(threads), "--sequence", "random", "--quiet", "--force"])
        return column(folder / "out" / "boxes.csv", "illuminance_lx") * 1e-9 * (side_mm / BOXES) ** 2

    @staticmethod
    def project(scene, side_mm):
        z_mm = scene.task["target"]["place"]["origin_mm"][2]
        return (sources(scene.task["source"], scene.folder / "task.json")
                + (scene.folder / "reflector.toml").read_text()
                + f'[[detector]]\nname = "boxes"\nkind = "plane"\nposition_mm = [0, 0, {z_mm}]\nnormal = "+z"\n'
                  f"size_mm = [{side_mm}, {side_mm}]\ncells = [{BOXES}, {BOXES}]\n")


@dataclasses.dataclass(frozen=True)
class Speed:
    scene: str
    entrant: str
    rays: int
    rays_per_s: list
    deviation: float

    @property
    def median(self):
        return statistics.median(self.rays_per_s)


def deviation(a, rays_a, b, rays_b):
    """Chi^2 of the shares of two independent sets of equal rays, less its mean, in its standard deviations."""
    pooled = (a * rays_a + b * rays_b) / (rays_a + rays_b)
    variance = pooled * (1.0 / rays_a + 1.0 / rays_b)
    there = pooled * min(rays_a, rays_b) > 10.0
    chi2 = np.sum((a - b)[there] ** 2 / variance[there])
    return float((chi2 - there.sum()) / math.sqrt(2.0 * max(1, there.sum())))


class Clock:
    """Runs of one entrant on one scene."""

    def __init__(self, entrant, scene, threads, folder):
        self.entrant, self.scene, self.threads, self.folder = entrant, scene, threads, pathlib.Path(folder)
        self.folder.mkdir(parents=True, exist_ok=True)

    def seconds(self, rays, seed=1):
        begun = time.monotonic()
        shares = self.entrant.shares(self.scene, rays, seed, self.threads, self.folder)
        return time.monotonic() - begun, shares

    def enough(self, seconds, first=1 << 18):
        """So many rays that a run takes so long."""
        rays = first
        while self.seconds(rays)[0] < seconds:
            rays *= 2
        return rays

    def rays_per_s(self, rays):
        """From a whole and a quarter of the rays."""
        long, short = self.seconds(rays)[0], self.seconds(rays // 4)[0]
        return (rays - rays // 4) / max(1e-9, long - short)


def measure(scene, entrants, threads=1, seconds=4.0, rounds=5, say=print):
    """Speeds of all entrants, whose runs take turns: a machine changes its pace. The first one is the judge of the
    light."""
    with tempfile.TemporaryDirectory() as folder:
        clocks = {name: Clock(e, scene, threads, pathlib.Path(folder) / name) for name, e in entrants.items()}
        rays = {name: clock.enough(seconds) for name, clock in clocks.items()}
        light = {name: clock.seconds(rays[name], seed=2 + k)[1] for k, (name, clock) in enumerate(clocks.items())}
        speeds = {name: [] for name in clocks}
        for _ in range(rounds):
            for name, clock in clocks.items():
                speeds[name].append(clock.rays_per_s(rays[name]))
    judge = next(iter(entrants))
    found = []
    for name, s in speeds.items():
        off = 0.0 if name == judge else deviation(light[name], rays[name], light[judge], rays[judge])
        found.append(Speed(scene.name, name, rays[name], s, off))
        say(f"{scene.name}: {name}: {found[-1].median / 1e6:.2f} M rays/s, light within {off:.1f} of {judge}'s")
    return found


def table(measured):
    """Markdown: a row a scene and entrant, with the ratio to the first entrant of the scene."""
    lines = ["| scene | entrant | M rays/s, median | all rounds | times the first | light |", "|---|---|---|---|---|---|"]
    first = {}
    for m in measured:
        base = first.setdefault(m.scene, m.median)
        rounds = ", ".join(f"{s / 1e6:.2f}" for s in m.rays_per_s)
        light = f"deviates by {m.deviation:.1f}" + ("" if abs(m.deviation) < MOST_DEVIATION else ": DOES NOT COUNT")
        lines.append(f"| {m.scene} | {m.entrant} | {m.median / 1e6:.2f} | {rounds} | {m.median / base:.1f} | {light} |")
    return "\n".join(lines) + "\n"


def write(out, measured, head):
    """LB-F1.json and LB-F1.md; the page."""
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    speeds = [{**dataclasses.asdict(m), "median": m.median} for m in measured]
    write_whole(out / "LB-F1.json", json.dumps({**head, "speeds": speeds}, indent=1) + "\n")
    text = ["# LB-F1", "", f"{head['threads']} threads; {head['program']}, commit {head['commit']}; {head['machine']}.", "",
            "Light: chi^2 of 48 x 48 boxes against the first entrant's, in standard deviations.", "", table(measured)]
    return write_whole(out / "LB-F1.md", "\n".join(text))
