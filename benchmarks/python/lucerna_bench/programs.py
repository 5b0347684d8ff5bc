# SPDX-License-Identifier: Apache-2.0
"""Other programs."""
import subprocess


def run(command):
    """Runs a program; ValueError with its words where it fails."""
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, check=False)
    except OSError as e:
        raise ValueError(f"{command[0]}: file: found {e.strerror}, expected a program") from None
    if done.returncode != 0:
        raise ValueError(f"{' '.join(map(str, command))}: found exit {done.returncode}, expected 0: {done.stderr.strip()}")
