# SPDX-License-Identifier: Apache-2.0
"""Source models: made, sampled, asked for densities, saved, pickled, shared."""
import concurrent.futures
import pickle

import lucerna as lu
import numpy as np
import pytest


def test_a_model_has_its_flux_and_is_near_its_source(rays, model):
    assert model.flux == pytest.approx(300) and model.unit == "lm" and model.training_rays == len(rays)
    found = lu.compare(lu.make_source("led", 1e6, seed=9), model, rays=1e6)
    for view in ("far", "near", "focus", "beam", "four_d"):
        assert isinstance(found[view].excess, lu.Estimate)
    assert found.far.excess.value < 0.05


def test_a_model_is_judged_by_rays_that_it_has_not_seen(tmp_path, rays):
    found = lu.compare_held_out(rays, max_bytes="16k")
    assert found.training_rays + found.held_out_rays == len(rays)
    assert [scale.cell_mm for scale in found.scales] == sorted(scale.cell_mm for scale in found.scales)
    # A model of one half is nearer to the other half than the half's rays are; in 4-D by far.
    assert found.views.four_d.excess.value < 0.7 * found.views.four_d.raw
    assert all(isinstance(scale.excess, lu.Estimate) and scale.floor > 0 for scale in found.scales)
    assert lu.compare_held_out(rays, max_bytes="16k", seed=2).views.far.error != found.views.far.error
    rays.save(tmp_path / "a.tm25ray")
    from_file = lu.compare_held_out([tmp_path / "a.tm25ray"], max_rays=1e4)
    assert from_file.training_rays + from_file.held_out_rays == 10_000
    assert lu.compare_held_out(lu.make_source("disk", 150)) is None
    with pytest.raises(lu.InputError):
        lu.compare_held_out(rays, max_bytes=10)
    with pytest.raises(lu.InputError):
        lu.compare_held_out([])


def test_same_seed_same_bits(rays, model):
    assert lu.compress(rays, max_bytes=16_000) == model
    assert model.sample(1000, seed=4) == model.sample(1000, seed=4)
    assert model.sample(1000, seed=4) != model.sample(1000, seed=5)


@pytest.mark.parametrize("size", ["16k", "16kB", 16_000, "16000"])
def test_sizes_are_read(rays, model, size):
    assert lu.compress(rays, max_bytes=size) == model


@pytest.mark.parametrize("size", ["16x", "-1", -1, "", 3.5, "k", 10])
def test_bad_sizes_are_refused(rays, size):
    with pytest.raises(lu.InputError):
        lu.compress(rays, max_bytes=size)


def test_luminance_of_a_disk():
    # A Lambertian disk of 1 mm and 1000 lm: flux / (pi A) in cd/mm2.
    disk = lu.compress(lu.make_source("disk", 200_000, seed=1, sequence="sobol"))
    truth = 1000 / (np.pi * np.pi * 1e-6)
    inside = np.random.default_rng(1).uniform(-0.6, 0.6, (50, 3)) * [1, 1, 0]
    found = disk.luminance(inside, [0.3, 0.1, 1])
    assert found.shape == (50,)
    assert np.median(found) == pytest.approx(truth, rel=0.1)
    assert disk.luminance([3, 0, 0], [0, 0, 1.0]) == 0
    assert disk.pdf_etendue(inside, [0, 0, 1.0]) * 1000e6 == pytest.approx(disk.luminance(inside, [0, 0, 1.0]))
    assert disk.etendue_mm2sr([0.5]) == pytest.approx(0.5 * np.pi**2, rel=0.1)


def test_densities_take_shapes_as_numpy_does(model):
    points, ways = np.zeros((4, 1, 3)), np.tile([0, 0, 1.0], (5, 1))
    assert model.luminance(points, ways).shape == (4, 5)
    assert model.pdf_solid_angle([0, 0, 3], [0, 0, 1]).shape == ()
    for bad in (([0, 0], [0, 0, 1]), ([0, 0, 0], [0, 0, 0]), ([0, 0, np.nan], [0, 0, 1])):
        with pytest.raises(lu.InputError):
            model.luminance(*bad)
    with pytest.raises((ValueError, TypeError)):
        model.luminance(np.zeros((4, 3)), np.ones((5, 3)))


def test_copies_are_made_only_where_they_must_be(model):
    points, ways = np.zeros((4, 3)), np.tile([0, 0, 1.0], (4, 1))
    assert np.array_equal(model.luminance(points, ways, copy=False), model.luminance(points, ways))
    for bad in (points.astype(np.float32), np.asfortranarray(np.zeros((4, 3))), points.tolist(), points[::2]):
        if isinstance(bad, list):
            continue  # a list has no memory to share: numpy makes the array
        with pytest.raises(lu.InputError, match="copy"):
            model.luminance(bad, ways[: len(bad)], copy=False)


def test_files_and_pickles_are_the_same_model(tmp_path, model):
    assert model.save(tmp_path / "led.nfl") == (tmp_path / "led.nfl").stat().st_size
    assert lu.read_model(tmp_path / "led.nfl") == model
    back = pickle.loads(pickle.dumps(model))
    assert back == model and back.sample(100) == model.sample(100)


def test_compress_takes_files(tmp_path, rays, model):
    rays.save(tmp_path / "a.tm25ray")
    one = lu.compress(tmp_path / "a.tm25ray", max_bytes="16k")
    two = lu.compress([tmp_path / "a.tm25ray", str(tmp_path / "a.tm25ray")], max_bytes="16k")
    assert one.flux == pytest.approx(300) and two.flux == pytest.approx(600)
    assert lu.compress(rays, flux_lm=7).flux == pytest.approx(7)
    with pytest.raises(lu.InputError, match="unit of the rays"):
        lu.compress(rays, flux_w=7)


def test_threads_share_a_model(model):
    expected = [model.sample(20_000, seed=k) for k in range(4)]
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda k: model.sample(20_000, seed=k % 4), range(16)))
    assert all(found[k] == expected[k % 4] for k in range(16))


def test_empty_and_dark_sets_are_refused():
    with pytest.raises(lu.InputError, match="no rays"):
        lu.compress(lu.RaySet.from_arrays(np.zeros((0, 3)), np.zeros((0, 3)), flux_lm=1))
    with pytest.raises(lu.InputError):
        lu.compress(lu.RaySet.from_arrays(np.zeros((2, 3)), [[0, 0, 1], [0, 1, 0]], weight=[0, 0], flux_lm=1))
    with pytest.raises(lu.InputError, match="flux"):
        lu.compress(lu.RaySet.from_arrays(np.zeros((2, 3)), [[0, 0, 1], [0, 1, 0]]))
