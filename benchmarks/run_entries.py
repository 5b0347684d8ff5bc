#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes entries of Lucerna and baselines for tasks of Lucerna Bench at equal time, scores them, and writes tables and
plots. What is made and scored already is kept, so that it can be stopped and called again.

    python3 benchmarks/run_entries.py --tasks 'LB-6-*' --time 60 --rays 1e7 -o results/
"""
import argparse
import os
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "python"))
from lucerna_bench import tables  # noqa: E402
from lucerna_bench.campaign import Campaign, commit_of, lucerna_version  # noqa: E402
from lucerna_bench.methods import METHODS, Means  # noqa: E402
from lucerna_bench.tasks import read_task  # noqa: E402


def program(option, given, usual):
    """A program that is there: the one given, the usual place, or the one on the path."""
    for place in [given] if given else [str(usual), shutil.which(pathlib.Path(usual).name)]:
        if place and os.access(place, os.X_OK) and pathlib.Path(place).is_file():
            return str(place)
    raise ValueError(f"{given or usual}: file: found no program, expected one: build it (benchmarks/README.md) or say "
                     f"where it is with {option}")


def number(low, high):
    """A whole number, 1e7 too."""
    def parse(text):
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not low <= value <= high or value != int(value):
            raise argparse.ArgumentTypeError(f"found {text}, expected a whole number from {low} to {high:g}")
        return int(value)
    return parse


def seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1.0 <= value <= 1e6:
        raise argparse.ArgumentTypeError(f"found {text}, expected seconds from 1 to 1e6")
    return value


def methods_of(text):
    names = text.split(",")
    for name in names:
        if name not in METHODS:
            raise argparse.ArgumentTypeError(f"found {name}, expected some of {', '.join(METHODS)}")
    return names


def arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", default="*", help="which tasks, with * for anything: 'LB-6-*'; all when not given")
    parser.add_argument("--methods", type=methods_of, default=list(METHODS), help=f"some of {','.join(METHODS)}")
    parser.add_argument("--time", type=seconds, default=60.0, help="seconds of each entry")
    parser.add_argument("--rays", type=number(16384, 8e9), default=100_000_000, help="rays of each score")
    parser.add_argument("--fit-rays", type=number(16384, 1e9), default=200_000, help="rays of a baseline's trial")
    parser.add_argument("--threads", type=number(1, 4096), help="of Lucerna and of the scorer; all when not given")
    parser.add_argument("--seed", type=number(0, 1e9), default=1, help="of the searches, not of the scores")
    parser.add_argument("--lucerna", help="the program; else build/release/lucerna or the one on the path")
    parser.add_argument("--scorer", help="the program; else benchmarks/build/lucerna-bench-score")
    parser.add_argument("--commit", help="commit of the program lucerna; else that of this checkout")
    parser.add_argument("--force", action="store_true", help="makes and scores again what is there")
    parser.add_argument("-o", "--out", required=True, help="folder of the results")
    return parser.parse_args(words)


def run(options):
    """True if all went well."""
    files = sorted((HERE / "tasks").glob(f"{options.tasks}.json"))
    if not files:
        raise ValueError(f"--tasks: found no task by {options.tasks}, expected a name below {HERE / 'tasks'}")
    tasks = [read_task(file) for file in files]
    means = Means(program("--scorer", options.scorer, HERE / "build" / "lucerna-bench-score"),
                  program("--lucerna", options.lucerna, HERE.parent / "build" / "release" / "lucerna"),
                  options.time, options.fit_rays, options.threads, options.seed)
    commit = options.commit or commit_of(HERE)
    print(f"{lucerna_version(means.lucerna)}, commit {commit}; {len(tasks)} tasks, {options.time:g} s an entry",
          flush=True)
    campaign = Campaign(pathlib.Path(options.out), means, options.rays, commit, options.force,
                        lambda text: print(text, flush=True))
    wrong = campaign.run(tasks, options.methods)
    pathlib.Path(options.out).mkdir(parents=True, exist_ok=True)
    for file in tables.write_all(options.out):
        print(file)
    for text in wrong:
        print(f"WRONG: {text}", file=sys.stderr)
    return not wrong


def main(words=None):
    options = arguments(words)
    try:
        return 0 if run(options) else 1
    except ValueError as e:
        print(f"run_entries.py: {e}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
