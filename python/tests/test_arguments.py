# SPDX-License-Identifier: Apache-2.0
"""Arguments: what is taken beyond the obvious, and what is refused by a clear error."""
import enum
import pickle

import lucerna as lu
import pytest

SPOT = ([0], [0, 45, 90], [[3.0, 2.0, 0.0]])


class Light(lu.IntensityDistribution):
    pass


class Rays(lu.RaySet):
    pass


class Two(enum.IntEnum):
    two = 2


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


def test_tables_by_their_documented_names(model):
    assert lu.Detector(kind="plane", name="a") == lu.Detector("plane", name="a")
    assert lu.Body(role="mirror") == lu.Body("mirror")
    assert lu.Source(of=model, flux_lm=3).keys == lu.Source(model, flux_lm=3).keys == {"file": model, "flux_lm": 3}


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


def test_an_estimate_of_whole_numbers_is_a_float():
    assert float(lu.Estimate(1, 2)) == 1.0
