# SPDX-License-Identifier: Apache-2.0
"""Other programs."""
import subprocess


def make_source(lucerna, kind, options, rays, seed, out):
    """Draws a file of rays of a kind of `lucerna make-source`."""
    run([lucerna, "make-source", kind, "-n", rays, "--seed", seed, *options, "--quiet", "-o", out])


def run(command):
    """Runs a program; ValueError with its words where it fails."""
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    except OSError as e:
        raise ValueError(f"{command[0]}: file: found {e.strerror}, expected a program") from None
    if done.returncode != 0:
        raise ValueError(f"{' '.join(map(str, command))}: found exit {done.returncode}, expected 0: {done.stderr.strip()}")
