#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the frozen ray files of the sources with the program `lucerna`, or checks those that are there.

    python3 make_sources.py --lucerna lucerna --out rays                  # writes and checks those of 1,000,000 rays
    python3 make_sources.py --lucerna lucerna --out rays --files '*-10M*' # ... of 10,000,000 rays, 280 MB each
    python3 make_sources.py --out rays                                    # checks those that must be in the folder

Each file is compared with its SHA-256 in sources/sources.json: that of its rays (the last 28 bytes per ray) must agree;
that of the whole file also depends on the version of the program, which stands in the file's header, and is only
reported. The models (sources/*.nfl) are kept as they are: they are checked only."""
import argparse
import fnmatch
import hashlib
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "python"))
from lucerna_bench.campaign import lucerna_version  # noqa: E402
from lucerna_bench.programs import make_source, run  # noqa: E402
from lucerna_bench.rays import RAY_BYTES  # noqa: E402

SOURCES = HERE / "sources" / "sources.json"
MODEL_MAX_BYTES = "256k"


def read_sources(file=SOURCES):
    """By name: `kind`, `options` and `seed` of `lucerna make-source`, `files` of rays and the `model` of the largest."""
    whole = json.loads(pathlib.Path(file).read_text())
    if (whole.get("format"), whole.get("version")) != ("lucerna-bench-sources", 1):
        raise ValueError(f"{file}: /format: found another format or version, expected lucerna-bench-sources, version 1")
    return whole["sources"]


def ray_files(sources, pattern="*"):
    """By file name: its source and its entry in `files`."""
    return {name: (source, frozen) for source in sources.values() for name, frozen in source["files"].items()
            if fnmatch.fnmatch(name, pattern)}


def write_rays(lucerna, source, rays, out):
    make_source(lucerna, source["kind"], source["options"], rays, source["seed"], out)


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def digests(path, rays):
    """SHA-256 of the rays of a file and of the whole file."""
    data = memoryview(path.read_bytes())
    return sha256(data[-RAY_BYTES * rays:]), sha256(data)


def check(path, frozen):
    """What is wrong with a file of rays, or nothing; and whether the whole file agrees."""
    rays, whole = digests(path, frozen["rays"])
    if rays != frozen["rays_sha256"]:
        return f"{path}: rays: found SHA-256 {rays}, expected {frozen['rays_sha256']}", False
    return None, whole == frozen["sha256"]


def check_model(name, source, folder=SOURCES.parent):
    """What is wrong with the model of a source, or nothing."""
    path = folder / f"{name}.nfl"
    if not path.exists():
        return f"{path}: file: found nothing, expected a model"
    found, expected = sha256(path.read_bytes()), source["model"]["sha256"]
    return None if found == expected else f"{path}: file: found SHA-256 {found}, expected {expected}"


def freeze(lucerna, out):
    """Makes all files and models anew, and writes down what they are: for a new version of the suite."""
    whole = json.loads(SOURCES.read_text())
    # For readers: another version may make other models.
    whole["made_by"] = lucerna_version(lucerna)
    for name, source in whole["sources"].items():
        for file, frozen in source["files"].items():
            write_rays(lucerna, source, frozen["rays"], out / file)
            frozen["rays_sha256"], frozen["sha256"] = digests(out / file, frozen["rays"])
        model = SOURCES.parent / f"{name}.nfl"
        run([lucerna, "compress", out / source["model"]["of"], "-o", model, "--max-bytes", MODEL_MAX_BYTES, "--quiet"])
        source["model"]["sha256"] = sha256(model.read_bytes())
        SOURCES.write_text(json.dumps(whole, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lucerna", help="the program; without it files are checked only")
    parser.add_argument("--out", required=True, help="folder of the ray files")
    parser.add_argument("--files", default="*-1M.tm25ray", help="which files, with * for anything")
    parser.add_argument("--freeze", action="store_true", help="writes the hashes of what is made to sources.json")
    options = parser.parse_args()
    try:
        return work(options)
    except (ValueError, OSError) as e:
        print(f"make_sources.py: {e}", file=sys.stderr)
        return 1


def work(options):
    """The program's exit code."""
    out = pathlib.Path(options.out)
    if options.freeze and not options.lucerna:
        raise ValueError("--freeze: found no --lucerna, expected the program")
    if options.lucerna:
        out.mkdir(parents=True, exist_ok=True)
    if options.freeze:
        freeze(options.lucerna, out)
        return 0
    sources = read_sources()
    wrong = [text for name, source in sources.items() if (text := check_model(name, source))]
    files = ray_files(sources, options.files)
    if not files:
        raise ValueError(f"--files: found no file by {options.files}, expected some of {', '.join(ray_files(sources))}")
    for name, (source, frozen) in files.items():
        path = out / name
        if options.lucerna:
            write_rays(options.lucerna, source, frozen["rays"], path)
        if not path.exists():
            wrong.append(f"{path}: file: found nothing, expected {frozen['rays']} rays")
            continue
        text, whole = check(path, frozen)
        if text:
            wrong.append(text)
        else:
            print(f"{path}: {frozen['rays']} rays, " + ("as frozen" if whole else "rays as frozen, another header"))
    for text in wrong:
        print(text, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
