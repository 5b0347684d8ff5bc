# SPDX-License-Identifier: Apache-2.0
import os
import pathlib
import shutil
import sys

import pytest

HERE = pathlib.Path(__file__).resolve().parent
BENCHMARKS = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
sys.path.insert(0, str(BENCHMARKS))


@pytest.fixture(scope="session")
def scorer():
    """The program: LUCERNA_BENCH_SCORER, or benchmarks/build/lucerna-bench-score."""
    path = os.environ.get("LUCERNA_BENCH_SCORER", str(BENCHMARKS / "build" / "lucerna-bench-score"))
    if not os.access(path, os.X_OK):
        pytest.skip(f"{path} is not built (or LUCERNA_BENCH_SCORER names none)")
    return path


@pytest.fixture(scope="session")
def lucerna():
    """The program lucerna: LUCERNA, or the one on the path."""
    path = os.environ.get("LUCERNA") or shutil.which("lucerna")
    if path is None:
        pytest.skip("lucerna is not there")
    return path


@pytest.fixture(scope="session")
def tasks():
    return BENCHMARKS / "tasks"
