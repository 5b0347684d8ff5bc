# SPDX-License-Identifier: Apache-2.0
"""The ways to an entry that are compared at equal time: Lucerna, and baselines (benchmarks/README.md)."""
import dataclasses
import pathlib
import time

from . import cma_es, lucerna_entry, point_source, tree_search
from .entry import Entry
from .golden import golden_section
from .shapes import FreeLens, Horn, Lens, Mirror, Trough, exit_place
from .tasks import Room, Task

# What missing light costs beside the error, as in a design of Lucerna: a tenth of it as an error of 3.2 %.
LIGHT_WEIGHT = 0.1
TRIALS_OF_PLAIN = 12
# Of Lucerna's time; the rest is for validating the result, tracing it, its figures and files.
SEARCH_SHARE = 0.7


@dataclasses.dataclass
class Means:
    """With what entries are made."""
    scorer: str
    lucerna: str
    time_s: float
    fit_rays: int = 200_000
    threads: int | None = None
    seed: int = 1


@dataclasses.dataclass
class Made:
    """An optic that a method found."""
    surfaces: list
    free_parameters: int
    name: str
    method: str
    notes: dict = dataclasses.field(default_factory=dict)
    target_place: dict | None = None


class Search:
    """The trials of one method within its time: every cost is asked for here."""

    def __init__(self, task: Task, means: Means, surfaces_of):
        self.means, self.trials, self.start = means, 0, time.monotonic()
        # At the end of a horn, where the target is free.
        self.entry = Entry(task.file, surfaces_of, means.scorer, threads=means.threads,
                           target_place_of=exit_place if task.kind == "horn" else None)

    def cost(self, parameters):
        self.trials += 1
        return self.entry.cost(parameters, self.means.fit_rays, LIGHT_WEIGHT)

    def over(self, share=1.0):
        """Is there no time for one more trial within this share of all?"""
        spent = time.monotonic() - self.start
        return spent + spent / max(1, self.trials) > share * self.means.time_s

    def made(self, surfaces, free_parameters, name, what, **notes):
        return Made(surfaces, free_parameters, name, f"{what}, {self.trials} trials of {self.means.fit_rays:g} rays",
                    notes, self.entry.target_place_of(surfaces))


def lucerna(task, means, folder):
    """`lucerna design`, its seconds and threads given; everything else is its own choice."""
    off = lucerna_entry.project(task, folder)
    search_s = SEARCH_SHARE * means.time_s
    text = lucerna_entry.design(means.lucerna, task, folder, search_s, means.threads, means.seed)
    lucerna_entry.keep_files(folder)
    surfaces, free = lucerna_entry.surfaces_of(text, task.kind)
    return Made(surfaces, free, f"Lucerna, {free} free parameters", f"lucerna design --time {search_s:g}",
                {"target_sampling_error": off}, lucerna_entry.target_place(task))


@dataclasses.dataclass
class Plain:
    """The optic of one number, what it is called, and the number's range in a room."""
    shape: type
    what: str
    range_mm: callable


PLAIN = {"mirror": Plain(Mirror, "paraboloid, focal length", Room.focal_range_mm),
         "trough": Plain(Trough, "parabolic trough, focal length", Room.focal_range_mm),
         "lens": Plain(Lens, "spherical cap, height", Room.cap_range_mm),
         "free-lens": Plain(FreeLens, "spherical cap, height", Room.cap_range_mm),
         "horn": Plain(Horn, "horn of flat walls, length", lambda _: (0.5, 20.0))}


def _plain_shape(task, number):
    return PLAIN[task.kind].shape(task, float(number))


def _best_plain(search, task, share):
    """Golden section over the one number, until its trials or its share of the time are used up."""
    low, high = PLAIN[task.kind].range_mm(task.room)
    # A hundredth within, so that what rounding adds stays in the room.
    low, high = low + 0.01 * (high - low), high - 0.01 * (high - low)
    return golden_section(lambda x: search.cost([x]), low, high,
                          lambda trials: trials >= TRIALS_OF_PLAIN or search.over(share))


def plain(task, means, _folder):
    """The plain optic of one number; golden section."""
    search = Search(task, means, lambda p: _plain_shape(task, p[0]).surfaces())
    number = _best_plain(search, task, 1.0)
    return search.made(_plain_shape(task, number).surfaces(), 1, f"plain {PLAIN[task.kind].what} {number:.3f} mm",
                       "golden section")


def point_source_alone(task, means, _folder):
    """Zero-étendue solutions with the real source: the best of some variants and vertex distances."""
    make, variants, distances = point_source.candidates(task)
    made, best = {}, None
    search = Search(task, means, lambda p: made[tuple(p)])
    for vertex_mm in distances:
        for variant in range(variants):
            key = (variant, vertex_mm)
            try:
                made[key] = make(task, variant, vertex_mm)
            except point_source.NoSolution:
                continue
            found = search.cost(key)
            if best is None or found < best[0]:
                best = (found, key)
            if search.over():
                break
        if best is not None and search.over():
            break
    if best is None:
        raise ValueError(f"{task.file}: found no point-source solution that fits the room, expected one")
    variant, vertex_mm = best[1]
    return search.made(made[best[1]], 1, f"point-source solution {variant}, vertex {vertex_mm:.2f} mm",
                       f"{make.__name__} of a point source, best of {len(made)} vertex distances and variants")


def _spline_search(task, means, minimise, what):
    """A search among splines over the best plain optic, which takes a tenth of the time at most."""
    search = Search(task, means, lambda p: _plain_shape(task, p[0]).surfaces())
    number = _best_plain(search, task, 0.1)
    shape = _plain_shape(task, number)
    # The same clock goes on with other parameters.
    search.entry.surfaces_of = shape.surfaces
    found = minimise(search.cost, [0.0] * shape.size, shape, lambda *_: search.over())
    return search.made(shape.surfaces(found.parameters), shape.size + 1, f"{what}, {shape.size + 1} parameters",
                       f"{what} over the plain optic of {number:.3f} mm", cost=found.cost)


def cma(task, means, _folder):
    """CMA-ES on spline heights over the best plain optic."""
    return _spline_search(task, means, lambda cost, start, shape, stop: cma_es.minimise(
        cost, start, 0.5 * shape.scale_mm, stop, means.seed), "CMA-ES")


def tree(task, means, _folder):
    """The search tree with pattern search on the same spline heights."""
    return _spline_search(task, means, lambda cost, start, shape, stop: tree_search.minimise(
        cost, start, 3.0 * shape.scale_mm, stop, means.seed), "search tree")


METHODS = {"lucerna": lucerna, "plain": plain, "point-source": point_source_alone, "cma-es": cma, "tree": tree}


def make(name, task: Task, means: Means, folder: pathlib.Path):
    return METHODS[name](task, means, folder)
