# SPDX-License-Identifier: Apache-2.0
"""Runs the tests that are named, or says which packages they miss and ends with 77; also where all tests are skipped."""
import importlib.util
import sys

NEEDED = ("numpy", "scipy", "matplotlib", "xarray", "pytest", "hypothesis")


class Outcomes:
    """What became of the tests: where all were skipped, ctest is to say so."""

    def __init__(self):
        self.found = set()

    def pytest_runtest_logreport(self, report):
        if report.when == "call" or report.outcome != "passed":
            self.found.add(report.outcome)


def main():
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if missing:
        print("skipped: these packages are missing (scripts/packages-python.txt):", *missing)
        return 77
    import pytest

    outcomes = Outcomes()
    code = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[1:]], plugins=[outcomes])
    if code == pytest.ExitCode.OK and outcomes.found == {"skipped"}:
        return 77
    return 0 if code == pytest.ExitCode.NO_TESTS_COLLECTED else code


if __name__ == "__main__":  # processes that a test spawns import this file
    sys.exit(main())
