#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the tasks with hidden mirrors: random mirrors, the tables of their light, and what the mirrors themselves score.

    python3 benchmarks/make_hidden.py --lucerna build/release/lucerna --scorer benchmarks/build/lucerna-bench-score

Writes tasks/LB-6-hidden-N.json and hidden/LB-6-hidden-N/submission.json, the mirror. A task that was published does not
change: this is run once a task, and is here to be read. Those that are there were made with the defaults, with the program
of 353307e."""
import argparse
import csv
import json
import pathlib
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "python"))
from lucerna_bench import Stated, lucerna_entry, score, write_submission  # noqa: E402
from lucerna_bench.entry import write_whole  # noqa: E402
from lucerna_bench.programs import run  # noqa: E402
from lucerna_bench.tasks import read_task  # noqa: E402

FOCAL_MM, DIAMETER_MM = 9.0, 60.0
C_STEP_DEG, GAMMA_STEP_DEG = 2.0, 0.25


def mirror(count, seed):
    """A reflector table with so many free numbers: 10 of a profile, else those of a spline over a paraboloid."""
    random = np.random.default_rng(seed)
    place = f'position_mm = [0, 0, {FOCAL_MM}]\naxis = "-z"\nreflectance = 0.92\n'
    if count == 10:
        r = np.linspace(0.0, 0.5 * DIAMETER_MM, count + 1)
        z = r * r / (4.0 * FOCAL_MM) + np.cumsum(random.normal(scale=0.25, size=count + 1))
        profile = np.round(np.stack([r, z - z[0]], axis=-1), 4).tolist()
        return f'[[reflector]]\nfamily = "revolution"\nprofile_mm = {profile}\n{place}'
    side = int(round(count**0.5))
    # Where the splines have their middles, in half diameters: some lie beyond the rim.
    x = 2.0 * (np.arange(side) - 1.0) / (side - 3) - 1.0
    # Waves whose slopes are alike at any number of coefficients, and a bend that spreads the light.
    waves = random.normal(scale=0.35 * 7.0 / side, size=(side, side))
    c = np.round(waves - 3.0 * x**2 - 8.0 * x[:, None] ** 2, 4)
    return (f'[[reflector]]\nfamily = "bspline"\nfocal_mm = {FOCAL_MM}\nintervals = [{side - 3}, {side - 3}]\n'
            f"coefficients_mm = {c.ravel().tolist()}\ndiameter_mm = {DIAMETER_MM}\n{place}")


def table_of(lucerna, text, rays, folder):
    """Intensities relative to the largest one, by C and gamma up to where they end."""
    folder = pathlib.Path(folder)
    (folder / "p.toml").write_text(lucerna_entry.sources({"emitter": "led"}, "LB-6") + text
                                   + f'[[detector]]\nkind = "far-field"\nc_step_deg = {C_STEP_DEG}\n'
                                     f"gamma_step_deg = {GAMMA_STEP_DEG}\n")
    run([lucerna, "trace", folder / "p.toml", "-o", folder / "out", "--rays", str(rays), "--quiet"])
    with open(folder / "out" / "far-field.csv", encoding="ascii") as file:
        rows = [(float(r["c_deg"]), float(r["gamma_deg"]), float(r["intensity_cd"])) for r in csv.DictReader(file)]
    planes, nodes = round(360.0 / C_STEP_DEG), round(90.0 / GAMMA_STEP_DEG) + 1
    cd = np.zeros((planes, nodes))
    for c, gamma, value in rows:
        if c < 360.0 and gamma <= 90.0:
            cd[round(c / C_STEP_DEG), round(gamma / GAMMA_STEP_DEG)] = value
    cd[:, 0] = cd[:, 0].mean()
    cd = np.round(cd / cd.max(), 4)
    return cd[:, : int(np.nonzero(cd.any(axis=0))[0][-1]) + 2]


def make(options, count):
    name = f"LB-6-hidden-{count}"
    text = mirror(count, options.seed + count)
    with tempfile.TemporaryDirectory() as folder:
        cd = table_of(options.lucerna, text, options.rays, folder)
    task = json.loads((HERE / "tasks" / "LB-6-led-oval.json").read_text())
    task.update(task=name, title=f"Ray file to mirror: the light of a hidden mirror of {count} numbers", reference=[])
    # As wide as the mirror: only then can its light be made without error.
    task["limits"][0]["radius_mm"] = 0.5 * DIAMETER_MM
    task["target"] = {"kind": "far_field", "axis": "-z", "function": "table", "c_step_deg": C_STEP_DEG,
                      "gamma_step_deg": GAMMA_STEP_DEG, "rows": cd.tolist()}
    file = HERE / "tasks" / f"{name}.json"
    write_task(file, task)
    surfaces, free = lucerna_entry.surfaces_of(text, "mirror")
    stated = Stated(free_parameters=free, wall_s=0.0, program="make_hidden.py", method="random", machine="")
    entry = write_submission(HERE / "hidden" / name, name, "the hidden mirror", "Lucerna Bench", surfaces, stated)
    found = score(options.scorer, file, entry, options.score_rays)
    if not found["counts"]:
        raise ValueError(f"{name}: {found['faults']}")
    error, light = found["error_48"], found["in_rectangle"]["value"]
    task["reference"] = [{"letter": "O", "source": f"hidden/{name}",
                          "text": f"the hidden mirror itself: error {100 * error['excess']:.2f} +- "
                                  f"{100 * error['standard_error']:.2f} %, {100 * light:.2f} % of the light in the rectangle"}]
    write_task(file, task)
    print(name, task["reference"][0]["text"], flush=True)


def write_task(file, task):
    """A row of the table a line."""
    rows = task["target"]["rows"]
    text = json.dumps({**task, "target": {**task["target"], "rows": "ROWS"}}, indent=2)
    lines = ",\n      ".join("[" + ", ".join(f"{x:g}" for x in row) + "]" for row in rows)
    write_whole(file, text.replace('"ROWS"', f"[\n      {lines}\n    ]") + "\n")
    read_task(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lucerna", required=True)
    parser.add_argument("--scorer", required=True)
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--rays", type=int, default=200_000_000)
    parser.add_argument("--score-rays", type=int, default=20_000_000)
    parser.add_argument("--counts", type=int, nargs="+", default=[10, 49, 400])
    options = parser.parse_args()
    for count in options.counts:
        make(options, count)


if __name__ == "__main__":
    main()
