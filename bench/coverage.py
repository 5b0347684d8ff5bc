#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often stated 95 % intervals of short traces hold the truth, as a table in Markdown.

Usage: bench/coverage.py PROJECT.toml... [--build build/release] [--seeds 40] [--rays 1048576] [--keep FOLDER]
Runs bench_coverage: short traces, then the truth. A row a figure: the truth, then of the runs the scatter,
the median stated error, and the share whose interval holds the truth, with what chance makes of a share of
95 % in so many runs. Runs that did not determine a figure are not counted, nor figures that less
than half of the runs did. --keep has the figures as CSV.
"""
import argparse
import collections
import contextlib
import math
import pathlib
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
INTERVAL_ERRORS = 2.131  # Student's t, 15 degrees of freedom
TRUTH_RAYS = 1 << 28


def rows(file):
    with open(file, encoding="utf-8") as lines:
        for line in lines:
            _, _, name, value, error = line.rstrip("\n").split(",")
            if name != "direction":
                yield name, float(value), float(error)


def compared(scene, truth_file, runs_file):
    """Prints the rows of one scene."""
    truth = {name: (value, error) for name, value, error in rows(truth_file)}
    runs = collections.defaultdict(list)
    for name, value, error in rows(runs_file):
        # The flux of a mirror that catches all is exact: nothing to cover.
        if name in truth and error > 1e-9 * abs(value):
            runs[name].append((value, error))
    shares = []
    most = max(map(len, runs.values()))
    for name, found in runs.items():
        if len(found) < most / 2:
            continue
        true, own = truth[name]
        n = len(found)
        share = sum(abs(v - true) <= INTERVAL_ERRORS * math.hypot(e, own) for v, e in found) / n
        shares.append(share)
        scatter = statistics.stdev(v for v, _ in found) if n > 1 else math.nan
        stated = statistics.median(e for _, e in found)
        chance = math.sqrt(0.95 * 0.05 / n)
        print(f"| {scene} | {name} | {true:.7g} +- {own:.2g} | {scatter:.2g} | {stated:.2g} "
              f"| {100 * share:.1f} +- {100 * chance:.1f} % of {n} |")
    print(f"| {scene} | mean of {len(shares)} figures | | | | {100 * statistics.fmean(shares):.1f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("projects", nargs="+", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--rays", type=float, default=1 << 20)
    parser.add_argument("--keep", type=pathlib.Path)
    options = parser.parse_args()
    program = options.build / "bench" / "bench_coverage"
    if options.keep:
        options.keep.mkdir(parents=True, exist_ok=True)
    print("| scene | figure | truth | scatter | stated error | intervals that hold the truth |\n|---|---|---|---|---|---|")
    with contextlib.nullcontext(options.keep) if options.keep else tempfile.TemporaryDirectory() as folder:
        for project in options.projects:
            runs, truth = (pathlib.Path(folder) / f"{project.stem}-{what}.csv" for what in ("runs", "truth"))
            for file, arguments in ((runs, ["runs", project, int(options.rays), 1, options.seeds]),
                                    (truth, ["truth", project, TRUTH_RAYS, runs])):
                with open(file, "w", encoding="utf-8") as out:
                    subprocess.run([program, *map(str, arguments)], stdout=out, check=True)
            compared(project.stem, truth, runs)


main()
