#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Enters the plain paraboloid in a task of LB-6: a baseline with one parameter, its focal length, which is found
by golden section with the scorer itself.

    python3 benchmarks/python/examples/plain_paraboloid.py --scorer benchmarks/build/lucerna-bench-score \
        --task benchmarks/tasks/LB-6-led-spot10.json --out entry --rays 200000
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from lucerna_bench import Entry, height_field, placed  # noqa: E402
from lucerna_bench.golden import golden_section  # noqa: E402
from lucerna_bench.tasks import read_task  # noqa: E402


def surfaces_of(parameters, half):
    """The mirror above the source, opening towards -z, its focus in the source; `half` of its diameter in mm."""
    focal_mm = float(parameters[0])
    mirror = height_field(lambda x, y: (x * x + y * y) / (4.0 * focal_mm), half, half, intervals=(1, 1), degree=2,
                          trim={"kind": "circle", "diameter_mm": 2.0 * half})
    return [{"name": "mirror", "role": "mirror", "bspline": mirror,
             "place": placed((0.0, 0.0, focal_mm), z_axis=(0.0, 0.0, -1.0))}]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scorer", required=True, help="the program lucerna-bench-score")
    parser.add_argument("--task", required=True, help="a task file of LB-6")
    parser.add_argument("--out", required=True, help="folder for submission.json")
    parser.add_argument("--rays", type=float, default=200_000, help="rays of each trial")
    parser.add_argument("--steps", type=int, default=10, help="trials after the first two")
    parser.add_argument("--threads", type=int, default=None)
    options = parser.parse_args()
    task = read_task(options.task)
    if task.kind != "mirror":
        parser.error(f"--task: found {task.name}, expected a task of LB-6")
    entry = Entry(options.task, lambda p: surfaces_of(p, task.room.half_mm), options.scorer, threads=options.threads)
    # The mirrors that the task has room for.
    low, high = task.room.focal_range_mm()
    focal_mm = golden_section(lambda f: entry.cost([f], rays=options.rays), low + 1e-3, high - 1e-3,
                              lambda trials: trials >= options.steps + 2)
    file = entry.write(options.out, [focal_mm], name=f"plain paraboloid, focal length {focal_mm:.2f} mm",
                       author="Lucerna", program="examples/plain_paraboloid.py",
                       method=f"golden section, {options.steps + 2} trials of {options.rays:g} rays")
    print(f"{file}: focal length {focal_mm:.3f} mm")


if __name__ == "__main__":
    main()
