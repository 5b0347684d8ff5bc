# SPDX-License-Identifier: Apache-2.0
"""Memory: nothing is copied that need not be, and nothing is lost."""
import gc
import os
import resource
import subprocess
import sys

import lucerna as lu
import numpy as np
import pytest
from conftest import SANITIZED


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


LARGE = """
import resource, sys
sys.path.insert(0, sys.argv[1])
import lucerna as lu, numpy as np
from test_memory import resident_bytes

def peak_bytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

n = 10_000_000
rays = {made}
before, peak = resident_bytes(), peak_bytes()
views = [rays.x_mm, rays.y_mm, rays.z_mm, rays.kx, rays.ky, rays.kz, rays.weight, rays.position_mm, rays.direction]
assert np.isfinite(sum(float(view.sum(dtype=float)) for view in views))
assert all(view.base is rays for view in views)
# A column has 40 MB.
assert resident_bytes() - before < 10e6, (before, resident_bytes())
assert peak_bytes() - peak < 10e6, (peak, peak_bytes())
if {saved}:
    rays.save("large.tm25ray")
    assert peak_bytes() - peak < 100e6, "written block by block"
"""


@pytest.mark.slow
@pytest.mark.parametrize("made, saved", [
    ("lu.make_source('disk', n, seed=1)", False),
    ("lu.compress(lu.make_source('disk', 1e4)).sample(n)", True),
    ("lu.RaySet.from_arrays(np.zeros((n, 3), np.float32), np.ones((n, 3), np.float32))", False),
])
def test_a_large_set_is_not_copied(made, saved):
    """10^7 rays, 280 MB: looking at them, as columns and as vectors, takes no memory."""
    code = LARGE.format(made=made, saved=saved)
    subprocess.run([sys.executable, "-c", code, os.path.dirname(__file__)], check=True)


@pytest.mark.skipif(SANITIZED, reason="the sanitizer keeps freed memory")
def test_calls_do_not_leak(lamp, model):
    def work():
        rays = model.sample(20_000)
        rays.x_mm.sum()
        assert lamp.trace(rays=2000).ledger.emitted == 300
        model.luminance(np.zeros((1000, 3)), [0, 0, 1.0])
        with pytest.raises(lu.InputError):
            rays.save("a.nothing")

    for _ in range(60):
        work()
    gc.collect()
    before = resident_bytes()
    for _ in range(200):
        work()
    gc.collect()
    assert resident_bytes() - before < 20e6
