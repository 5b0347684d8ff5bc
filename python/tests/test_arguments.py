# SPDX-License-Identifier: Apache-2.0
"""Arguments: what is taken beyond the obvious, and what is refused by a clear error."""
import enum
import pickle
import types

import lucerna as lu
import numpy as np
import pytest

SPOT = ([0], [0, 45, 90], [[3.0, 2.0, 0.0]])


class Light(lu.IntensityDistribution):
    pass


class Rays(lu.RaySet):
    pass


class Two(enum.IntEnum):
    two = 2


class Raises:
    """What numpy takes for an array, and that raises when it is asked."""

    def __init__(self, error):
        self.error = error

    def __array__(self, *_, **__):
        raise self.error


def disk(**keys):
    return lu.Scene([{"kind": "disk", "radius_mm": 1}], **keys)


def test_subclasses_are_what_their_base_is(rays):
    scene = disk(target=Light(*SPOT))
    assert list(scene.memory.values()) == [lu.IntensityDistribution(*SPOT)]
    assert scene.replace(target=Light([0], [0, 90], [[1.0, 0.0]])) != scene
    own = Rays.__new__(Rays)
    own.__setstate__(rays.__getstate__())
    assert lu.Scene([own]).flux == pytest.approx(300)


@pytest.mark.parametrize("make", [
    lambda: lu.Scene([{3: 4}]), lambda: disk(design=[1]), lambda: disk().replace(design=[1]), lambda: disk(target=3),
    lambda: disk(target={"file": 3}), lambda: disk().replace(target=3)])
def test_tables_of_other_kinds_are_refused(make):
    with pytest.raises(TypeError, match="expected"):
        make()


def test_a_target_is_no_source(rays):
    with pytest.raises(TypeError, match="target: .* RaySet"):
        disk(target=rays)


def test_members_of_enumerations_are_numbers():
    assert lu.Scene([{"kind": "disk", "radius_mm": Two.two}]) == lu.Scene([{"kind": "disk", "radius_mm": 2}])


@pytest.mark.parametrize("size", ["9" * 400, 10**30, 2**64, "1" + "0" * 19 + "k"])
def test_sizes_beyond_all_files_are_refused(rays, size):
    with pytest.raises(lu.InputError, match="max_bytes"):
        lu.compress(rays, max_bytes=size)


@pytest.mark.parametrize("seed", [-1, 2**64, 10**30, np.int64(-5)])
def test_seeds_out_of_range_are_bad_input(seed, rays, model, lamp, tmp_path):
    target = lu.IntensityDistribution(*SPOT)
    for call in (lambda: lu.compress(rays, seed=seed), lambda: lu.make_source("disk", 10, seed=seed),
                 lambda: model.sample(10, seed=seed), lambda: model.sample_file("a.speos", 10, seed=seed),
                 lambda: model.etendue_mm2sr([0.5], seed=seed), lambda: lamp.trace(rays=10, seed=seed),
                 lambda: lu.design(lamp, target=target, seed=seed), lambda: lu.Objective(lamp, target, seed=seed),
                 lambda: lu.compare("a.nfl", "b.nfl", seed=seed)):
        with pytest.raises(lu.InputError, match="seed: found") as caught:
            call()
        assert caught.value.found == str(seed) and caught.value.cause == "out of range"
    for other in (1.5, "1", None, [1], np.array([1, 2])):
        with pytest.raises(TypeError):
            model.sample(10, seed=other)
    assert model.sample(10, seed=2**64 - 1) != model.sample(10, seed=np.uint8(3))


def test_numbers_of_rays_in_every_form(lamp):
    expected = lamp.trace(rays=100)
    for rays in (np.array(100), np.array(100.0), np.int32(100), np.array([0, 100]), [0, 100], (0, 1e2)):
        assert lamp.trace(rays=rays) == expected
    for rays in (b"ab", bytearray(b"ab"), "10"):
        with pytest.raises(TypeError):
            lamp.trace(rays=rays)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), MemoryError(), ZeroDivisionError()])
def test_exceptions_within_an_array_pass(error, model, lamp):
    for call in (lambda x: model.pdf_area(x), lambda x: lu.IntensityDistribution(x, *SPOT[1:]),
                 lambda x: lamp.reflectors[0].height_mm(x, 0)):
        with pytest.raises(type(error)):
            call(Raises(error))
        for refused in (TypeError("no array"), ValueError("no array")):
            with pytest.raises(TypeError, match="expected an array of numbers"):
                call(Raises(refused))


def test_every_mapping_is_taken(model):
    memory = types.MappingProxyType({"a.nfl": model})
    scene = lu.Scene.from_toml("[[source]]\nfile = 'a.nfl'\n", memory=memory)
    assert scene.flux == model.flux
    about = types.MappingProxyType({"name": "lamp", "lamps": (types.MappingProxyType({"count": 2}),)})
    light = lu.IntensityDistribution(*SPOT, luminaire=about)
    assert light.luminaire.name == "lamp" and light.luminaire.lamps[0].count == 2
    for call in (lambda: lu.Scene.from_toml("", memory=[1]), lambda: lu.IntensityDistribution(*SPOT, luminaire=[1])):
        with pytest.raises(TypeError, match="expected a mapping"):
            call()


def test_tables_by_their_documented_names(model):
    assert lu.Detector(kind="plane", name="a") == lu.Detector("plane", name="a")
    assert lu.Body(role="mirror") == lu.Body("mirror")
    assert lu.Source(of=model, flux_lm=3).keys == lu.Source(model, flux_lm=3).keys == {"file": model, "flux_lm": 3}


def test_an_etendue_needs_rays(model):
    with pytest.raises(lu.InputError, match="rays"):
        model.etendue_mm2sr([0.5], rays=0)


@pytest.mark.parametrize("about", [{"nmae": "lamp"}, {"lamps": [{"cuont": 1}]}, {3: 4}])
def test_unknown_keys_of_a_luminaire_are_refused(about):
    with pytest.raises(lu.InputError, match="nmae|cuont|3") as caught:
        lu.IntensityDistribution(*SPOT, luminaire=about)
    assert caught.value.cause == "unknown key"
    assert str(about) == str(dict(about)), "what is given is not changed"


def test_scaled_light_stays_finite():
    bright = lu.IntensityDistribution(*SPOT, standard_error=[[1, 1, 1e300]])
    for factor in (1e308, 1e10):
        with pytest.raises(lu.InputError, match="factor"):
            bright.scaled(factor)
    assert pickle.loads(pickle.dumps(bright.scaled(1e5))) == bright.scaled(1e5)


def test_one_vector_goes_with_many_without_a_copy(model):
    points, ways = np.zeros((4, 3)), np.tile([0, 0, 1.0], (4, 1))
    points[:, 0] = [0, 0.1, 0.2, 0.3]
    whole = model.luminance(points, ways)
    assert np.array_equal(model.luminance(points, ways[0], copy=False), whole)
    assert np.array_equal(model.luminance(points[1], ways, copy=False), np.full(4, whole[1]))
    none = np.zeros((0, 3))
    assert model.luminance(none, ways[0]).shape == model.luminance(points[0], none).shape == (0,)
    with pytest.raises(lu.InputError, match="copy"):
        model.luminance(points[:, None], ways[:2], copy=False)
    assert model.luminance(points[:, None], ways[:2]).shape == (4, 2)


def test_a_replaced_target_is_let_go(model):
    """And another one never has its name, by which designs of the two are told apart."""
    scene = lu.Scene([model], target=lu.IntensityDistribution(*SPOT))
    names = [set(scene.memory)]
    for k in range(3):
        scene = scene.replace(target=lu.IntensityDistribution([0], [0, 90], [[1.0, k]]))
        names.append(set(scene.memory))
    assert [len(some) for some in names] == [2] * 4 and len(set.union(*names)) == 5
    assert scene.replace(target={"file": "x.ldt"}).memory == {name: model for name in set.intersection(*names)}
    assert pickle.loads(pickle.dumps(scene)) == scene


def test_what_a_scene_has_in_memory_is_kept_whatever_its_folder(model, tmp_path):
    scene = lu.Scene.from_toml("[[source]]\nfile = 'a.nfl'\n", folder=tmp_path / "elsewhere", memory={"a.nfl": model})
    assert scene.replace(design={"time_s": 3}).flux == model.flux


def test_an_estimate_of_whole_numbers_is_a_float():
    assert float(lu.Estimate(1, 2)) == 1.0
