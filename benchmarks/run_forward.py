#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The forward tasks of Lucerna Bench: how fast light is traced (LB-F1), and how small models of sources can be (LB-F2).

    python3 benchmarks/run_forward.py tracing -o results/
    python3 benchmarks/run_forward.py compression -o results/
"""
import argparse
import os
import pathlib
import platform
import secrets
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "python"))
from lucerna_bench import compression, tracing  # noqa: E402
from lucerna_bench.campaign import SEEDS, commit_of, lucerna_version  # noqa: E402
from run_entries import number, program, seconds  # noqa: E402


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["tracing", "compression"])
    parser.add_argument("--only", help="names of scenes or sources, with commas between; all when not given")
    parser.add_argument("--threads", type=number(1, 4096), default=1, help="of tracing")
    parser.add_argument("--rounds", type=number(1, 1000), default=5, help="of tracing: runs of each, in turn")
    parser.add_argument("--seconds", type=seconds, default=4.0, help="of tracing: the least length of a run")
    parser.add_argument("--rays", type=number(1000, 1e8), default=4_000_000, help="of compression: rays to compare with")
    parser.add_argument("--lucerna", help="the program; else build/release/lucerna or the one on the path")
    parser.add_argument("--scorer", help="the program; else benchmarks/build/lucerna-bench-score")
    parser.add_argument("--commit", help="commit of the program lucerna; else that of this checkout")
    parser.add_argument("-o", "--out", required=True, help="folder of the results")
    return parser.parse_args(words)


def chosen(all_of_them, only):
    if only is None:
        return all_of_them
    names = only.split(",")
    for name in names:
        if name not in [x.name for x in all_of_them]:
            raise ValueError(f"--only: found {name}, expected some of {', '.join(x.name for x in all_of_them)}")
    return [x for x in all_of_them if x.name in names]


def run(options):
    """The page that was written, and whether all light was right."""
    lucerna = program("--lucerna", options.lucerna, HERE.parent / "build" / "release" / "lucerna")
    head = {"program": lucerna_version(lucerna), "commit": options.commit or commit_of(HERE),
            "machine": f"{platform.machine()}, {os.cpu_count()} threads"}
    say = lambda text: print(text, flush=True)
    if options.what == "tracing":
        scorer = program("--scorer", options.scorer, HERE / "build" / "lucerna-bench-score")
        entrants = {"scorer": tracing.Scorer(scorer), "triangles (Embree)": tracing.Triangles(scorer),
                    "lucerna": tracing.LucernaTrace(lucerna)}
        found = []
        for scene in chosen(tracing.scenes(HERE / "forward"), options.only):
            found += tracing.measure(scene, entrants, options.threads, options.seconds, options.rounds, say)
        return (tracing.write(options.out, found, {**head, "threads": options.threads}),
                all(abs(m.deviation) < tracing.MOST_DEVIATION for m in found))
    task = compression.read_compression(HERE / "forward" / "LB-F2.json")
    # Nobody knows the rays to compare with before.
    seed = secrets.randbelow(SEEDS)
    found = []
    for source in chosen(task.sources, options.only):
        found += compression.measure(task, source, compression.methods(lucerna), lucerna, options.rays, seed, say)
    return compression.write(options.out, found, {**head, "seed": seed, "train_rays": task.train_rays,
                                                  "test_rays": options.rays}), True


def main(words=None):
    options = arguments(words)
    try:
        page, right = run(options)
    except ValueError as e:
        print(f"run_forward.py: {e}", file=sys.stderr)
        return 1
    print(page)
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
