# SPDX-License-Identifier: Apache-2.0
"""Memory: nothing is copied that need not be, and nothing is lost."""
import gc
import resource

import lucerna as lu
import numpy as np
import pytest


def resident_bytes():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


@pytest.mark.slow
def test_a_large_set_is_not_copied():
    n = 10_000_000
    rays = lu.make_source("disk", n, seed=1)
    before = resident_bytes()
    views = [rays.x_mm, rays.y_mm, rays.z_mm, rays.kx, rays.ky, rays.kz, rays.weight]
    total = sum(float(view[::1000].sum()) for view in views)
    assert np.isfinite(total)
    assert resident_bytes() - before < 10e6, "a column has 40 MB"


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
