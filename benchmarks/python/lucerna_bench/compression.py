# SPDX-License-Identifier: Apache-2.0
"""LB-F2: small models of sources. A method makes a model of at most so many bytes from a file of rays, and draws rays
from it; they are compared with rays of the source that nobody has seen before."""
import dataclasses
import json
import math
import pathlib
import tempfile
import time

import numpy as np

from . import curves
from .entry import write_whole
from .interpolated_rays import InterpolatedRays
from .light_field import HEADER_BYTES, LightField
from .programs import make_source, run
from .rays import Rays, read_tm25
from .views import NAMES, Views, compare

FORMAT = "lucerna-bench-compression"
# Six floats of a ray whose flux is that of the others.
PICKED_BYTES = 24
# Four floats of one on a plane or a sphere.
SPREAD_BYTES = 16


@dataclasses.dataclass(frozen=True)
class Source:
    """One of the sources of the task, a kind of `lucerna make-source` with its options."""
    name: str
    kind: str
    options: tuple

    def rays(self, lucerna, file, count, seed):
        """Draws a file of rays."""
        make_source(lucerna, self.kind, self.options, count, seed, file)
        return read_tm25(file)


@dataclasses.dataclass(frozen=True)
class Compression:
    """The task."""
    sources: list
    sizes_bytes: list
    train_rays: int
    train_seed: int


def read_compression(file):
    file = pathlib.Path(file)
    try:
        d = json.loads(file.read_text())
    except (OSError, json.JSONDecodeError) as e:
        raise ValueError(f"{file}: file: found {e}, expected a task file") from None
    if not isinstance(d, dict) or d.get("format") != FORMAT:
        raise ValueError(f"{file}: /format: found another format, expected {FORMAT}")
    return Compression([Source(s["name"], s["kind"], tuple(s["options"])) for s in d["sources"]], d["sizes_bytes"],
                       d["train_rays"], d["train_seed"])


@dataclasses.dataclass(frozen=True)
class Model:
    """What a method made: its size, and how rays are drawn from it."""
    size_bytes: int
    sample: callable


class Lucerna:
    """`lucerna compress` and `lucerna sample`, with files between them."""

    def __init__(self, program, method):
        self.program, self.method = program, method

    def compress(self, file, max_bytes, folder):
        model = pathlib.Path(folder) / "model.nfl"
        run([self.program, "compress", file, "-o", model, "--method", self.method, "--max-bytes", str(max_bytes),
             "--held-out", "0", "--quiet"])
        return Model(model.stat().st_size, lambda count, seed: self._sample(model, count, seed))

    def _sample(self, model, count, seed):
        out = model.with_name("drawn.tm25ray")
        run([self.program, "sample", model, "-n", str(count), "--seed", str(seed), "--sequence", "random", "--quiet", "-o",
             out])
        return read_tm25(out)


def picked(file, count):
    """So many of the rays of a file, or all. They are drawn by flux, so that all weigh the same."""
    rays = read_tm25(file)
    count = min(len(rays), count)
    below = np.cumsum(rays.weight)
    at = (np.arange(count) + np.random.default_rng(1).random(count)) / count * below[-1]
    return rays[np.searchsorted(below, at, side="right").clip(0, len(rays) - 1)]


class PickedRays:
    """Some of the rays, drawn again and again: the usual way of making a ray file smaller."""

    def compress(self, file, max_bytes, _folder):
        kept = picked(file, max_bytes // PICKED_BYTES)
        return Model(PICKED_BYTES * len(kept), lambda n, seed: self._again(kept, n, seed))

    @staticmethod
    def _again(kept, count, seed):
        which = np.random.default_rng(seed).integers(len(kept), size=count)
        return Rays(kept.start[which], kept.direction[which], np.ones(count))


class SpreadRays:
    """Some of the rays, each spread over a cell of its own."""

    def compress(self, file, max_bytes, _folder):
        kept = picked(file, (max_bytes - HEADER_BYTES) // SPREAD_BYTES)
        return Model(SPREAD_BYTES * len(kept) + HEADER_BYTES, InterpolatedRays(kept).sample)


class UniformLightField:
    def compress(self, file, max_bytes, _folder):
        field = LightField(read_tm25(file), max(2, math.floor((max_bytes - HEADER_BYTES) ** 0.25)))
        return Model(field.size_bytes, field.sample)


def methods(lucerna):
    return {"lucerna": Lucerna(lucerna, "adaptive"), "thesis": Lucerna(lucerna, "clusters"),
            "light-field": UniformLightField(), "picked-rays": PickedRays(), "interpolated-rays": SpreadRays()}


@dataclasses.dataclass(frozen=True)
class Measured:
    source: str
    method: str
    max_bytes: int
    size_bytes: int
    compress_s: float
    sample_rays_per_s: float
    views: dict

    @property
    def worst(self):
        """The name of the view with the largest excess."""
        return max(NAMES, key=lambda name: self.views[name].excess)


def measure(task, source, entrants, lucerna, test_rays, seed, say=print):
    """All methods on one source, at all sizes that make a difference. `seed` gives the rays to compare with and must be new
    to all."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        file = folder / "train.tm25ray"
        trained = source.rays(lucerna, file, task.train_rays, task.train_seed)
        reference = source.rays(lucerna, folder / "test.tm25ray", test_rays, seed)
        views = Views(reference)
        # Every model is compared with these.
        fresh, used = views.shares(reference), views.shares(trained)
        for name, method in entrants.items():
            for max_bytes in task.sizes_bytes:
                begun = time.monotonic()
                model = method.compress(file, max_bytes, folder)
                made = time.monotonic() - begun
                if model.size_bytes > max_bytes:
                    raise ValueError(f"{name}: {source.name}: found a model of {model.size_bytes} bytes, expected no more "
                                     f"than {max_bytes}")
                if found and (found[-1].method, found[-1].size_bytes) == (name, model.size_bytes):
                    continue  # it has no use for more bytes
                begun = time.monotonic()
                drawn = model.sample(test_rays, seed + 1)
                speed = test_rays / (time.monotonic() - begun)
                found.append(Measured(source.name, name, max_bytes, model.size_bytes, made, speed,
                                      compare(fresh, views.shares(drawn), used)))
                worst = found[-1].views[found[-1].worst]
                say(f"{source.name}: {name}: {model.size_bytes} bytes, worst {found[-1].worst} {worst.excess:.4f} +- "
                    f"{worst.standard_error:.4f} (raw {worst.raw:.4f})")
    return found


def table(measured):
    """Markdown: a row a model."""
    lines = ["| source | method | bytes | " + " | ".join(NAMES) + " | compress, s | M rays/s drawn |",
             "|" + "---|" * (5 + len(NAMES))]
    for m in measured:
        cells = [f"{v.excess:.4f} +- {v.standard_error:.4f} ({v.raw:.4f})" for v in (m.views[name] for name in NAMES)]
        lines.append("| " + " | ".join([m.source, m.method, f"{m.size_bytes:,}", *cells, f"{m.compress_s:.1f}",
                                        f"{m.sample_rays_per_s / 1e6:.1f}"]) + " |")
    return "\n".join(lines) + "\n"


def write(out, measured, head):
    """LB-F2.json with all numbers, LB-F2.svg with the curves and LB-F2.md with the table; the page."""
    out = pathlib.Path(out)
    out.mkdir(parents=True, exist_ok=True)
    write_whole(out / "LB-F2.json", json.dumps({**head, "models": [dataclasses.asdict(m) for m in measured]}, indent=1) + "\n")
    text = ["# LB-F2", "", f"{head['train_rays']:,} rays to make a model of, {head['test_rays']:,} others to compare with,",
            f"seed {head['seed']}; {head['program']}, commit {head['commit']}; {head['machine']}.", "",
            "Excess by view, with its standard error; in brackets the noise of the rays that the model was",
            "made of. 0.01 is one per cent.", "", "![Excess by bytes](LB-F2.svg)", "",
            "Dashed: that noise. Excess below 0.1 % is drawn there.", "", table(measured)]
    write_whole(out / "LB-F2.svg", curves.plot(measured))
    return write_whole(out / "LB-F2.md", "\n".join(text))
