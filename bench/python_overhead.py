#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What Python costs: the same calls in Python and in C++, in turns; medians, and the median of the ratios.

Usage: bench/python_overhead.py [--build build/release] [--pairs 101] [--rays 1e7]
Needs the targets python_package and bench_python_overhead. Both sides must have the same bits.
"""
import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Other:
    """The C++ side."""

    def __init__(self, program):
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, *words):
        print(*words, file=self.process.stdin, flush=True)
        return self.process.stdout.readline().split()


def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def pairs(count, ours, theirs):
    """Seconds of both sides in turns; each of ours returns seconds and figures as theirs prints them."""
    rows = []
    for k in range(count + 1):
        first, second = (ours(k), theirs(k)) if k % 2 else reversed((theirs(k), ours(k)))
        if [float(a) for a in first[1:]] != [float.fromhex(b) for b in second[1:]]:
            sys.exit(f"the two sides differ: {first} {second}")
        rows.append((float(first[0]), float(second[0])))
    return rows[1:]  # the first warms the caches


def row(name, work, bar, found):
    ours, theirs = (statistics.median(side) for side in zip(*found))
    ratios = sorted(a / b for a, b in found)
    quartiles = statistics.quantiles(ratios, n=4)
    print(f"| {name} | {work} | {theirs:.4f} | {ours:.4f} | {statistics.median(ratios):.3f} "
          f"| {quartiles[0]:.3f} to {quartiles[2]:.3f} | {bar} |", flush=True)


def sampling(lu, other, folder, options):
    model = lu.compress(lu.make_source("led", 1e6, seed=3, flux_lm=300))
    path = folder / "led.nfl"
    model.save(path)

    def ours(k):
        seconds, (rays, arrays) = timed(lambda: arrays_of(model.sample(options.rays, seed=k)))
        return seconds, float(arrays[0][len(rays) // 2, 0]), float(arrays[1][-1, 2])

    def arrays_of(rays):
        return rays, (rays.position_mm, rays.direction, rays.weight)

    found = pairs(options.pairs, ours, lambda k: other.ask("sample", path, int(options.rays), k))
    row("`model.sample`, then positions, directions and weights as arrays", f"{options.rays:.0e} rays", 1.05, found)


def objectives(lu, np, other, folder, options):
    gamma = np.arange(0, 181, 1.0)
    spot = lu.IntensityDistribution([0], gamma, [np.where(gamma < 40, 1000 * np.exp2(-((gamma / 10) ** 2)), 0)])
    for family, preset, rays in (("revolution", "parabola", 2**17), ("bspline", None, 2**17)):
        scene = lu.Scene([{"kind": "disk", "radius_mm": 1}], reflectors=[lu.Reflector(
            family, preset=preset, focal_mm=8, diameter_mm=60, position_mm=[0, 0, 8], axis="-z")],
            target=spot, design=dict(intervals=8))
        path = folder / f"{family}.toml"
        scene.save(path)
        objective = lu.Objective(lu.Scene.load(path), rays=rays, seed=2)
        other.ask("open", path, rays, 2)

        def ours(k, objective=objective):
            seconds, (residuals, jacobian) = timed(lambda: objective(objective.x0 + 1e-3 * k))
            return seconds, sum((r * r for r in residuals.tolist()), 0.0), sum(jacobian.ravel().tolist(), 0.0)

        found = pairs(options.pairs, ours, lambda k: other.ask("evaluate", repr(1e-3 * k)))
        row(f"`Objective`: {family}, {objective.shape[0]} residuals, {objective.shape[1]} parameters",
            f"{rays} rays", 1.05, found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--pairs", type=int, default=101)
    parser.add_argument("--rays", type=float, default=1e7)
    options = parser.parse_args()
    sys.path.insert(0, str(options.build / "python"))
    import lucerna as lu
    import numpy as np

    other = Other(options.build / "bench" / "bench_python_overhead")
    print("| call | work | C++, s | Python, s | Python / C++ | middle half | bar |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        sampling(lu, other, pathlib.Path(name), options)
        objectives(lu, np, other, pathlib.Path(name), options)


if __name__ == "__main__":
    main()
