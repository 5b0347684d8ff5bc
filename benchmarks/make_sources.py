#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the frozen ray files of the tasks with the program `lucerna`, or checks those that are there.

    python3 make_sources.py --lucerna lucerna --out sources      # writes and checks
    python3 make_sources.py --out sources                        # checks the files in the folder

Each file is compared with the task's SHA-256: that of its rays (the last 28 bytes per ray) must agree; that of the
whole file also depends on the version of the program, which stands in the file's header, and is only reported."""
import argparse
import hashlib
import json
import pathlib
import subprocess
import sys

RAY_BYTES = 28


def frozen_files(tasks):
    """The `frozen_rays` tables of all tasks by file; two tasks with one file must agree on it."""
    found = {}
    for path in sorted(pathlib.Path(tasks).glob("*.json")):
        frozen = json.loads(path.read_text()).get("frozen_rays")
        if frozen is None:
            continue
        if found.setdefault(frozen["file"], frozen) != frozen:
            raise ValueError(f"{path}: /frozen_rays: found another definition of {frozen['file']} than in a task before, "
                             "expected the same")
    return found


def command_of(lucerna, frozen, out):
    return [lucerna, "make-source", frozen["kind"], "-n", str(frozen["rays"]), "--seed", str(frozen["seed"]),
            *frozen["options"], "--quiet", "-o", str(out)]


def check(path, frozen):
    """What is wrong with a file, or nothing; and whether the whole file agrees."""
    data = path.read_bytes()
    rays = hashlib.sha256(data[-RAY_BYTES * frozen["rays"]:]).hexdigest()
    if rays != frozen["rays_sha256"]:
        return f"{path}: rays: found SHA-256 {rays}, expected {frozen['rays_sha256']}", False
    return None, hashlib.sha256(data).hexdigest() == frozen["sha256"]


def main():
    here = pathlib.Path(__file__).resolve().parent
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lucerna", help="the program; without it files are checked only")
    parser.add_argument("--out", required=True, help="folder of the ray files")
    parser.add_argument("--tasks", default=here / "tasks", help="folder of the task files")
    options = parser.parse_args()
    out = pathlib.Path(options.out)
    if options.lucerna:
        out.mkdir(parents=True, exist_ok=True)
    bad = 0
    for name, frozen in frozen_files(options.tasks).items():
        path = out / name
        if options.lucerna:
            subprocess.run(command_of(options.lucerna, frozen, path), check=True)
        if not path.exists():
            wrong, whole = f"{path}: file: found nothing, expected {frozen['rays']} rays", False
        else:
            wrong, whole = check(path, frozen)
        bad += wrong is not None
        print(wrong or f"{path}: {frozen['rays']} rays, " +
              ("as frozen" if whole else f"rays as frozen, header not that of {frozen['made_by']}"))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
