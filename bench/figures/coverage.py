# SPDX-License-Identifier: Apache-2.0
"""How often stated 95 % intervals hold the truth: coverage.py TRUTH.csv RUNS.csv...

Files are those of bench_coverage. A line a figure: the share of runs whose interval holds the truth, what
chance makes of a share of 95 % in so many runs, the truth, and the runs' mean, scatter and median stated
error. Figures that were not determined in a run are counted as such.
"""
import collections
import math
import statistics
import sys

INTERVAL_ERRORS = 2.131  # Student's t, 15 degrees of freedom


def rows(file):
    with open(file, encoding="utf-8") as lines:
        for line in lines:
            _, seed, name, value, error = line.rstrip("\n").split(",")
            if name != "direction":
                yield seed, name, float(value), float(error)


def main():
    truth = {name: (value, error) for _, name, value, error in rows(sys.argv[1])}
    runs, seeds = collections.defaultdict(list), set()
    for file in sys.argv[2:]:
        for seed, name, value, error in rows(file):
            seeds.add(seed)
            # The flux of a mirror that catches all is exact: nothing to cover.
            if name in truth and error > 1e-9 * abs(value):
                runs[name].append((value, error))
    shares = []
    for name, found in runs.items():
        true, own = truth[name]
        held = sum(abs(v - true) <= INTERVAL_ERRORS * math.hypot(e, own) for v, e in found)
        share, n = held / len(found), len(found)
        shares.append(share)
        values = [v for v, _ in found]
        scatter = statistics.stdev(values) if n > 1 else math.nan
        print(f"{name:22s} {100 * share:5.1f} % of {n} (95 +- {100 * math.sqrt(0.95 * 0.05 / n):.1f})"
              f"  truth {true:.7g} +- {own:.2g}, mean {statistics.fmean(values):.7g},"
              f" scatter {scatter:.2g}, stated {statistics.median(e for _, e in found):.2g}")
    print(f"{len(shares)} figures of {len(seeds)} runs: mean {100 * statistics.fmean(shares):.1f} %")


main()
