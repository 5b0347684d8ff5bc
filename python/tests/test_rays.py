# SPDX-License-Identifier: Apache-2.0
"""Ray sets: arrays in and out, files, statistics, pickles."""
import pickle

import lucerna as lu
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

# The fixtures that print nothing and change the folder may serve several examples.
quick = settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
coordinates = st.floats(-1e6, 1e6, width=32)


@st.composite
def ray_arrays(draw):
    n = draw(st.integers(0, 20))
    position = draw(hnp.arrays(np.float32, (n, 3), elements=coordinates))
    direction = draw(hnp.arrays(np.float32, (n, 3), elements=st.floats(-1, 1, width=32)))
    direction[np.linalg.norm(direction, axis=1) < 1e-3] = [0, 0, 1]
    weight = draw(hnp.arrays(np.float32, (n,), elements=st.floats(0, 1e6, width=32)))
    return position, direction, weight


@quick
@given(ray_arrays(), st.sampled_from([np.float32, np.float64]), st.sampled_from("CF"))
def test_arrays_come_back(arrays, dtype, order):
    position, direction, weight = arrays
    rays = lu.RaySet.from_arrays(np.asarray(position, dtype, order=order), np.asarray(direction, dtype, order=order),
                                 weight=weight.tolist(), flux_lm=5)
    assert len(rays) == len(weight)
    np.testing.assert_array_equal(rays.position_mm, position)
    np.testing.assert_array_equal(rays.x_mm, position[:, 0])
    np.testing.assert_array_equal(rays.weight, weight)
    norm = np.linalg.norm(direction.astype(float), axis=1, keepdims=True)
    np.testing.assert_allclose(rays.direction, direction / norm, atol=2e-6)
    if weight.sum() > 0:
        np.testing.assert_allclose(rays.flux.sum(), 5)
    assert pickle.loads(pickle.dumps(rays)) == rays


# The example is nearly unit: 7e-7 too long.
@quick
@given(ray_arrays())
@example((np.zeros((1, 3), np.float32), np.array([[0, 0.00122261, 1]], np.float32), np.zeros(1, np.float32)))
def test_files_keep_every_bit(tmp_path, arrays):
    rays = lu.RaySet.from_arrays(*arrays[:2], weight=arrays[2], flux_lm=5)
    rays.save(tmp_path / "rays.tm25ray")
    back = lu.read_rays(tmp_path / "rays.tm25ray")
    for name in ("x_mm", "y_mm", "z_mm", "kx", "ky", "kz"):
        np.testing.assert_array_equal(getattr(back, name), getattr(rays, name))
    assert back.flux_lm == pytest.approx(5)


def test_views_are_read_only_and_outlive_their_set():
    rays = lu.make_source("disk", 1000, seed=2)
    views = {name: getattr(rays, name) for name in ("x_mm", "kz", "weight")}
    copies = {name: view.copy() for name, view in views.items()}
    for view in views.values():
        assert not view.flags.writeable and not view.flags.owndata and view.base is rays
        with pytest.raises(ValueError, match="read-only|WRITEABLE"):
            view[0] = 1
        with pytest.raises(ValueError, match="WRITEABLE"):
            view.flags.writeable = True
    del rays
    junk = [lu.make_source("disk", 1000, seed=k) for k in range(3, 20)]
    for name, view in views.items():
        np.testing.assert_array_equal(view, copies[name])
    assert len(junk) == 17


def test_views_share_memory(rays):
    assert np.shares_memory(rays.x_mm, rays.x_mm)


@pytest.mark.parametrize("n", [0, 1, 2, 1000, 100_000, 1_000_000])
def test_vectors_are_views_across_columns_or_copies(n):
    """Whatever the allocator did: the same numbers, read-only, and a view's owner is the set."""
    rays = lu.make_source("led", n, seed=3)
    for whole, columns in ((rays.position_mm, (rays.x_mm, rays.y_mm, rays.z_mm)),
                           (rays.direction, (rays.kx, rays.ky, rays.kz))):
        assert whole.shape == (n, 3) and whole.dtype == np.float32 and not whole.flags.writeable
        np.testing.assert_array_equal(whole, np.stack(columns, axis=1))
        assert (whole.base is rays) == (np.shares_memory(whole, columns[0]) or n == 0 and whole.base is rays)
        assert pickle.loads(pickle.dumps(whole)).tobytes() == whole.tobytes()
    kept = rays.position_mm
    expected = kept.copy()
    del rays
    lu.make_source("led", n, seed=4)
    np.testing.assert_array_equal(kept, expected)


def test_wavelengths_are_a_column():
    rays = lu.RaySet.from_arrays(np.zeros((3, 3)), np.tile([0, 0, 1.0], (3, 1)), wavelength_nm=[400, 500, 600])
    (name,) = rays.columns
    assert "wavelength" in name and rays.columns[name].tolist() == [400, 500, 600]
    assert pickle.loads(pickle.dumps(rays)) == rays


@pytest.mark.parametrize("arguments, text", [
    (([[0, 0]], [[0, 0, 1]]), r"shape"),
    (([0, 0, 0], [0, 0, 1]), r"shape"),
    (([[0, 0, 0]], [[0, 0, 1], [0, 0, 1]]), r"shape \(2, 3\), expected \(1, 3\)"),
    (([[0, 0, np.nan]], [[0, 0, 1]]), r"nan at index 2, expected finite"),
    (([[0, 0, np.inf]], [[0, 0, 1]]), r"inf"),
    (([[0, 0, 0]], [[0, 0, 0]]), r"length 0"),
])
def test_bad_arrays_are_refused(arguments, text):
    with pytest.raises(lu.InputError, match=text):
        lu.RaySet.from_arrays(*arguments)


@pytest.mark.parametrize("thing", ["text", None, object(), [["a", "b", "c"]], [[1j, 0, 0]], [[1, 2, 3], [4]]])
def test_what_is_no_array_is_refused(thing):
    with pytest.raises((TypeError, ValueError)):
        lu.RaySet.from_arrays(thing, [[0, 0, 1]])


@pytest.mark.parametrize("keys", [dict(weight=[-1]), dict(weight=[1, 2]), dict(flux_lm=0), dict(flux_lm=-3),
                                  dict(flux_lm=np.nan), dict(flux_lm=1, flux_w=1), dict(wavelength_nm=[1, 2])])
def test_bad_figures_are_refused(keys):
    with pytest.raises(lu.InputError):
        lu.RaySet.from_arrays([[0, 0, 0]], [[0, 0, 1]], **keys)


def test_statistics_of_a_known_source():
    found = lu.make_source("sphere", 100_000, seed=1, sequence="sobol", radius_mm=2).statistics()
    assert found.rays == 100_000 and found["equal_weights"]
    assert np.allclose(found.virtual_focus_mm, 0, atol=0.02)
    assert found.extent_max_mm[2] == pytest.approx(2, abs=0.01)
    assert lu.RaySet.from_arrays(np.zeros((0, 3)), np.zeros((0, 3))).statistics().extent_min_mm is None


@pytest.mark.parametrize("form", ["zemax-binary", "zemax-text", "speos", "mcpl", "asap", "text", "lighttools-ascii"])
def test_formats(tmp_path, rays, form):
    path = tmp_path / "rays.any"
    rays.save(path, format=form)
    assert len(lu.read_rays(path)) == len(rays)


def test_sources_are_reproducible():
    assert lu.make_source("led", 1e3, seed=5) == lu.make_source("led", 1000, seed=5)
    assert lu.make_source("led", 1e3, seed=5) != lu.make_source("led", 1000, seed=6)
    for bad in (1.5, -1, np.nan, 1e30):
        with pytest.raises(lu.InputError, match="rays"):
            lu.make_source("led", bad)


def test_wavelengths_are_above_zero():
    for bad in (-5, 0, np.nan, np.inf):
        with pytest.raises(lu.InputError, match="wavelength_nm"):
            lu.RaySet.from_arrays([[0, 0, 0]], [[0, 0, 1]], wavelength_nm=[bad])


def test_a_size_that_a_kind_does_not_have_is_refused():
    with pytest.raises(lu.InputError, match="found length_mm, which a disk does not have"):
        lu.make_source("disk", 10, length_mm=3)
    wide = lu.make_source("rectangle", 1000, size_mm=[4, 1], seed=1).position_mm
    assert 1.9 < abs(wide[:, 0]).max() <= 2 and abs(wide[:, 1]).max() <= 0.5
