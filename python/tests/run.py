# SPDX-License-Identifier: Apache-2.0
"""Runs the tests that are named, or says which packages they miss and ends with 77."""
import importlib.util
import sys

NEEDED = ("numpy", "scipy", "matplotlib", "xarray", "pytest", "hypothesis")


def main():
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        print("skipped: these packages are missing (scripts/packages-python.txt):", *missing)
        return 77
    import pytest

    code = pytest.main(["-q", "-p", "no:cacheprovider", *sys.argv[1:]])
    return 0 if code == pytest.ExitCode.NO_TESTS_COLLECTED else code


if __name__ == "__main__":  # processes that a test spawns import this file
    sys.exit(main())
