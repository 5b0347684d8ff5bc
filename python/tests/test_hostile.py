# SPDX-License-Identifier: Apache-2.0
"""Hostile use: an exception or a right answer, never a crash, nor a hang."""
import concurrent.futures
import contextlib
import gc
import io
import multiprocessing
import pickle
import subprocess
import sys
import threading

import lucerna as lu
import numpy as np
import pytest
import scipy.optimize
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

quick = settings(deadline=None, max_examples=60, suppress_health_check=list(HealthCheck))
CLASSES = [lu.RaySet, lu.SourceModel, lu.IntensityDistribution, lu.PlaneImage, lu.Reflector, lu.Scene,
           lu.TraceResult, lu.DesignResult, lu.Objective]
# What a call with wrong arguments may raise.
REFUSED = (lu.InputError, OSError, TypeError, ValueError, OverflowError, KeyError)

# Looks at everything that an object of a class has, without arguments; prints what was no TypeError.
LOOK_AT_ALL = """
import inspect, sys
import lucerna as lu

cls = getattr(lu, sys.argv[1])
bare = cls.__new__(cls)
looked = 0
for name in dir(cls):
    if name in {"__class__", "__new__", "__init_subclass__", "__subclasshook__", "__module__", "__doc__",
                "__annotations__", "__dict__", "__weakref__", "__hash__", "__dir__", "__sizeof__",
                "__setattr__", "__delattr__", "__getattribute__", "__format__", "__init__"}:
        continue
    found = inspect.getattr_static(cls, name)
    if isinstance(found, staticmethod) or hasattr(object, name) and name not in vars(cls):
        continue
    looked += 1
    for arguments in ((), (bare,), (0,), ("x",), ([0.0],), ([0.0], [0.0]), ((),)):
        try:
            value = getattr(bare, name)
            if callable(value):
                value(*arguments)
        except Exception as error:
            # A wrong argument may be found first.
            if not (isinstance(error, TypeError) or isinstance(error, lu.InputError) and arguments):
                print(name, arguments, type(error).__name__, error)
        else:
            if not name.startswith("__"):
                print(name, arguments, "gave", value)
assert looked > 3, looked
"""

# The same object where others of its class are expected.
HAND_IN = """
import lucerna as lu

bare = {cls: cls.__new__(cls) for cls in (lu.RaySet, lu.SourceModel, lu.IntensityDistribution, lu.PlaneImage,
                                          lu.Reflector, lu.Scene, lu.TraceResult, lu.DesignResult, lu.Objective)}
rays, model, light, trace = (bare[c] for c in (lu.RaySet, lu.SourceModel, lu.IntensityDistribution, lu.TraceResult))
scene = lu.Scene([{"kind": "disk"}])
for call in (lambda: lu.compress(rays), lambda: lu.compress([rays]), lambda: lu.compare(rays, rays),
             lambda: lu.compare(model, model), lambda: lu.compare(light, light), lambda: lu.merge([trace]),
             lambda: lu.merge([scene.trace(rays=100), trace]), lambda: scene.trace(rays=100, resume=trace),
             lambda: lu.merge([None]), lambda: lu.merge(None), lambda: lu.compress(None),
             lambda: lu.Scene([rays]), lambda: lu.Scene([model]), lambda: lu.Scene(["x"], target=light),
             lambda: lu.Scene([scene]), lambda: lu.Scene([{"kind": "disk"}], reflectors=[bare[lu.Reflector]]),
             lambda: lu.design(bare[lu.Scene]), lambda: lu.design(scene, resume=bare[lu.DesignResult]),
             lambda: lu.Objective(bare[lu.Scene]), lambda: scene == bare[lu.Scene],
             lambda: lu.Scene.from_toml("", memory={"a": rays}), lambda: lu.Scene.from_toml("", memory={"a": 3}),
             lambda: lu.Scene.from_toml("", memory={"a": None}), lambda: lu.Scene.from_toml("", memory={3: scene})):
    try:
        call()
    except TypeError:
        continue
    except Exception as error:
        print(type(error).__name__, error)
        continue
    raise SystemExit("nothing was raised")
for thing in bare.values():
    try:
        repr(thing)
    except TypeError:
        pass
"""


def python(code, *arguments):
    """What code prints in a process of its own; a crash is a signal's return code."""
    done = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, (done.returncode, done.stdout[-2000:], done.stderr[-2000:])
    return done.stdout


@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__name__)
def test_what_was_never_initialised_raises(cls):
    assert python(LOOK_AT_ALL, cls.__name__) == ""


def test_what_was_never_initialised_is_taken_nowhere():
    assert python(HAND_IN) == ""


def test_initialising_again_leaves_views_alone():
    light = lu.IntensityDistribution([0], [0, 90], [[1.0, 2.0]])
    view = light.cd
    light.__init__([0], [0, 60, 90], [[3.0, 4.0, 5.0]])
    assert view.tolist() == [[1, 2]]
    del light
    gc.collect()
    assert view.tolist() == [[1, 2]]


anything = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.binary(max_size=8),
    st.lists(st.floats(), max_size=4), st.dictionaries(st.text(max_size=3), st.integers(), max_size=2),
    st.sampled_from([np.nan, np.inf, -1, 1e300, 2**70, object(), np.float32(1), np.array(2.0), np.array([]),
                     np.zeros((2, 3), complex), np.array(["a"]), np.array([None]), np.zeros((0, 3)),
                     np.zeros((1, 2, 3)), range(3), memoryview(b"abcd"), io.BytesIO(b"x")]),
    hnp.arrays(st.sampled_from([np.float64, np.float32, np.int8, np.uint64, np.bool_, np.float16]),
               hnp.array_shapes(max_dims=3, max_side=4)))


def survives(call, *arguments, **keys):
    """True if the call is refused or returns; anything else fails the test."""
    with contextlib.suppress(*REFUSED):
        call(*arguments, **keys)


@quick
@given(st.lists(anything, max_size=3))
def test_methods_of_rays_take_or_refuse(rays, arguments):
    survives(lu.RaySet.from_arrays, *arguments)
    survives(lu.RaySet.from_arrays, [[0, 0, 0]], [[0, 0, 1]], **dict(zip(("weight", "flux_lm", "wavelength_nm"), arguments)))
    survives(rays.save, *arguments)
    survives(lu.make_source, *arguments)


@quick
@given(st.lists(anything, max_size=3))
def test_methods_of_models_take_or_refuse(model, arguments):
    for method in (model.luminance, model.pdf_area, model.pdf_etendue, model.pdf_solid_angle, model.etendue_mm2sr):
        survives(method, *arguments)
        survives(method, *arguments, copy=False)
    # A count that is one would be sampled.
    if not (arguments and isinstance(arguments[0], (int, float, np.floating)) and arguments[0] > 1e4):
        survives(model.sample, *arguments)
        survives(model.sample, 10, **dict(zip(("seed", "sequence"), arguments)))


@quick
@given(st.lists(anything, max_size=3))
def test_methods_of_light_and_mirrors_take_or_refuse(lamp, traced, arguments):
    survives(lu.IntensityDistribution, *arguments)
    survives(traced["far"].at, *arguments)
    survives(traced["far"].scaled, *arguments)
    survives(traced.__getitem__, *arguments)
    mirror = lamp.reflectors[0]
    survives(mirror.height_mm, *arguments)
    survives(mirror.slope, *arguments)
    survives(lu.Reflector, *arguments)
    survives(lu.Scene, *arguments)
    survives(lu.merge, *arguments)


@quick
@given(anything)
def test_objectives_take_or_refuse(objective, x):
    survives(objective, x)
    survives(objective.scene, x)


@pytest.fixture(scope="module")
def objective():
    gamma = np.arange(0, 181, 5.0)
    spot = lu.IntensityDistribution([0], gamma, [np.where(gamma < 40, np.exp2(-((gamma / 10) ** 2)), 0)])
    return lu.Objective(lu.Scene([{"kind": "disk", "radius_mm": 1}], reflectors=[lu.Reflector(
        "revolution", preset="parabola", focal_mm=8, diameter_mm=60, position_mm=[0, 0, 8], axis="-z")],
        target=spot, design=dict(intervals=4)), rays=8192)


def test_values_of_objectives_are_the_callers(objective):
    """scipy's losses write into them."""
    residuals, jacobian = objective(objective.x0)
    expected = residuals.copy()
    for array in (residuals, jacobian, objective.residuals(objective.x0), objective.jacobian(objective.x0)):
        assert array.flags.writeable
        array[:] = 0
    np.testing.assert_array_equal(objective.residuals(objective.x0), expected)
    scipy.optimize.least_squares(objective.residuals, objective.x0,
                                 jac=objective.jacobian, loss="soft_l1", max_nfev=2)


@quick
@given(st.sampled_from(["x_mm", "position_mm", "direction", "flux", "weight"]),
       st.sampled_from([np.s_[::2], np.s_[::-1], np.s_[1:], np.s_[5:5], np.s_[...], np.s_[[0, 3]]]), st.integers(1, 3000))
def test_views_of_views_outlive_their_set(name, part, n):
    rays = lu.make_source("disk", n + 4, seed=n)
    expected = getattr(rays, name)[part].copy()
    view = getattr(rays, name)[part]
    del rays
    lu.make_source("disk", n + 4, seed=n + 1)
    gc.collect()
    np.testing.assert_array_equal(view, expected)


def test_views_of_light_outlive_their_trace(lamp):
    def arrays():
        result = lamp.trace(rays=20_000)
        light, floor = result["far"], result["floor"]
        return [light.cd, light.standard_error, light.c_deg, floor.value, floor.standard_error, floor.x_mm]

    first = arrays()
    gc.collect()
    for a, b in zip(first, arrays()):
        np.testing.assert_array_equal(a, b)


@quick
@given(st.data())
def test_buffers_that_change_meanwhile_do_no_harm(model, data):
    """Another thread writes the points that luminance reads: any answer, no crash."""
    points = np.zeros((2000, 3))
    stop = threading.Event()

    def write():
        while not stop.is_set():
            points[:] = data_value
    data_value = data.draw(st.floats(allow_nan=True, allow_infinity=True))
    thread = threading.Thread(target=write)
    thread.start()
    try:
        survives(model.luminance, points, [0, 0, 1.0])
    finally:
        stop.set()
        thread.join()


def test_files_that_are_cut_while_open(tmp_path, rays):
    """What was read does not depend on the file any more."""
    rays.save(tmp_path / "a.tm25ray")
    back = lu.read_rays(tmp_path / "a.tm25ray")
    x = back.x_mm
    with open(tmp_path / "a.tm25ray", "r+b") as file:
        file.truncate(10)
    np.testing.assert_array_equal(x, rays.x_mm)
    with open(tmp_path / "a.tm25ray", "rb") as file:
        pass
    for thing in (file, file.fileno if not file.closed else None, 3, io.BytesIO(b"")):
        with pytest.raises(TypeError):
            lu.read_rays(thing)


def test_names_with_odd_characters(tmp_path, rays):
    for name in ("a b.tm25ray", "ä.tm25ray", "line\nbreak.tm25ray", "\udcff.tm25ray"):
        rays.save(tmp_path / name)
        assert len(lu.read_rays(tmp_path / name)) == len(rays)
    for bad in ("nul\0.tm25ray", ""):
        with pytest.raises((OSError, ValueError, TypeError)):
            lu.read_rays(bad)
        with pytest.raises((OSError, ValueError, TypeError)):
            rays.save(bad, format="tm25")


def test_threads_share_everything(model, lamp, traced):
    """Figures that are worked out on first use are asked for by all threads at once."""
    def look(k):
        fresh_light, fresh_floor = fresh["far"], fresh["floor"]
        return [fresh_light.metrics().peak_cd, fresh_floor.max, fresh_floor.value.sum(), fresh.summary(),
                model.sample(2000, seed=k % 2).x_mm.sum(), model.luminance([0.1, 0, 0], [0, 0, 1.0]).item()]

    fresh = pickle.loads(pickle.dumps(traced))
    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        found = list(pool.map(look, range(16)))
    assert all(one[:4] == found[0][:4] and one[5] == found[0][5] for one in found)
    assert all(one[4] == found[k % 2][4] for k, one in enumerate(found))


def test_a_thread_whose_objects_go_away_meanwhile(lamp):
    def trace(_):
        return lu.Scene.from_toml(lamp.to_toml(), memory=lamp.memory).trace(rays=20_000)["far"].cd.sum()

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        sums = list(pool.map(trace, range(12)))
        gc.collect()
    assert len(set(sums)) == 1


def in_a_fork(queue, calls):
    found = []
    for name, call in calls:
        try:
            call()
            found.append((name, "returned"))
        except RuntimeError as error:
            found.append((name, "spawn" if "spawn" in str(error) else str(error)))
    queue.put(found)


def test_forked_processes_look_but_do_not_compute(rays, model, lamp, traced):
    """What needs no threads works in a fork; what needs them says so; nothing hangs."""
    traced["far"]
    context = multiprocessing.get_context("fork")
    looks = [("views", lambda: rays.position_mm.sum()), ("repr", lambda: repr(model)), ("toml", lamp.to_toml),
             ("ledger", lambda: traced.ledger)]
    work = [("sample", lambda: model.sample(1000)), ("trace", lambda: lamp.trace(rays=1000)),
            ("compress", lambda: lu.compress(rays)), ("design", lambda: lu.design(lamp, target="x.ldt"))]
    queue = context.Queue()
    process = context.Process(target=in_a_fork, args=(queue, looks + work))
    process.start()
    found = dict(queue.get(timeout=120))
    process.join(60)
    assert process.exitcode == 0
    assert {found[name] for name, _ in looks} == {"returned"}
    assert {found[name] for name, _ in work} == {"spawn"}


# A class of pybind11 that no object of lucerna is of, and classes derived from it.
BASE = """
import lucerna as lu
base = lu.RaySet.__base__
class Derived(base):
    pass
for make in (base, Derived, lambda: base.__new__(base)):
    try:
        make()
    except TypeError:
        continue
    raise SystemExit("nothing was raised")
"""


def test_the_base_class_makes_no_objects():
    assert python(BASE) == ""


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_every_protocol_pickles(protocol):
    rays = lu.make_source("disk", 10)
    scene = lu.Scene([{"kind": "disk"}])
    for thing in (rays, lu.compress(lu.make_source("disk", 1000, flux_lm=1)), scene, scene.trace(rays=100),
                  lu.Reflector("revolution", preset="parabola", focal_mm=8, diameter_mm=60)):
        back = pickle.loads(pickle.dumps(thing, protocol))
        if isinstance(thing, lu.SourceModel):  # which are equal only to themselves
            assert back.sample(10) == thing.sample(10)
        else:
            assert type(back) is type(thing) and back == thing


class Named(lu.RaySet):
    pass


def test_a_subclass_keeps_its_class_and_attributes():
    rays = lu.make_source("disk", 10)
    named = Named.__new__(Named)
    named.__setstate__(rays.__getstate__())
    named.name = "a lamp"
    back = pickle.loads(pickle.dumps(named))
    assert type(back) is Named and back.name == "a lamp" and back == rays


def test_no_object_changes_to_or_from_a_class_of_the_extension():
    rays = lu.make_source("disk", 10)
    for cls in CLASSES[1:8]:
        with pytest.raises(TypeError):
            rays.__class__ = cls
    with pytest.raises(TypeError):
        lu.RaySet.flux_lm = 3


# A thread that is in a long call at the end of the interpreter, of the kinds that can and cannot be stopped.
AT_EXIT = """
import sys, threading, time
import lucerna as lu
scene = lu.Scene([{"kind": "disk"}])
model = lu.compress(lu.make_source("disk", 2000, flux_lm=1))
def sample():
    while True:
        model.sample(1e5)
work = {"trace": lambda: scene.trace(rays=1e12), "callback": lambda: scene.trace(rays=1e12, callback=lambda s: None),
        "sample": sample}[sys.argv[1]]
def run():
    try:
        work()
    except RuntimeError as error:
        assert "interpreter" in str(error), error
threading.Thread(target=run, daemon=True).start()
time.sleep(0.5)
"""


@pytest.mark.parametrize("kind", ["trace", "callback", "sample"])
def test_the_interpreter_ends_while_a_daemon_thread_works(kind):
    assert python(AT_EXIT, kind) == ""


def state_with(rays, **changes):
    """The state of a pickle of rays with other columns; names as in RaySet."""
    state = list(rays.__getstate__())
    arrays = [np.array(a) for a in state[9]]
    names = ["x_mm", "y_mm", "z_mm", "kx", "ky", "kz", "weight"]
    for name, value in changes.items():
        if name in names:
            arrays[names.index(name)][:] = value
    state[9] = arrays
    if "spectra" in changes:
        state[4] = changes["spectra"]
    return tuple(state)


@pytest.mark.parametrize("changes", [{"weight": np.inf}, {"weight": np.nan}, {"weight": -1.0}, {"x_mm": np.nan},
                                     {"kz": np.inf}, {"spectra": [(np.ones(3, "f4"), np.ones(1, "f4"))]}], ids=str)
def test_damaged_pickles_of_rays_are_refused(changes):
    rays = lu.make_source("disk", 10)
    with pytest.raises(lu.InputError, match="damaged pickle"):
        lu.RaySet.__new__(lu.RaySet).__setstate__(state_with(rays, **changes))


@pytest.mark.parametrize("cells", [(0, 3), (3, 0), (1 << 40, 1 << 40)])
def test_images_without_cells_are_refused(cells):
    scene = lu.Scene([{"kind": "disk"}], detectors=[
        lu.Detector("plane", name="wall", position_mm=[0, 0, 5], size_mm=[10, 10], cells=[2, 2])])
    state = list(scene.trace(rays=1000)["wall"].__getstate__())
    grid = list(state[1])
    grid[3], grid[4] = cells
    state[1], state[3], state[4] = tuple(grid), np.zeros((0,)), np.zeros((0,))
    with pytest.raises(lu.InputError, match="damaged pickle"):
        lu.PlaneImage.__new__(lu.PlaneImage).__setstate__(tuple(state))


def flux_of(scene):
    return scene.flux


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_pool_raises_and_ends():
    scene = lu.Scene([{"kind": "disk"}])
    trace = scene.trace(rays=100)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        for thing in (scene, trace):
            with pytest.raises(RuntimeError, match="spawn"):
                pool.map_async(flux_of, [thing]).get(timeout=60)


def test_numbers_that_float32_cannot_hold():
    start = [[0, 0, 0.0]]
    for place in (1e39, -1e300):
        with pytest.raises(lu.InputError, match="position_mm: .*float32"):
            lu.RaySet.from_arrays([[0, 0, place]], [[0, 0, 1.0]])
    for length in (1e39, 1e300, 1e-50, 1e-310):
        assert lu.RaySet.from_arrays(start, [[0, 0, -length]]).direction.tolist() == [[0, 0, -1]]
        diagonal = lu.RaySet.from_arrays(start, [[0, length, length]]).direction[0]
        np.testing.assert_allclose(diagonal, [0, 0.5**0.5, 0.5**0.5], rtol=1e-6)
    with pytest.raises(lu.InputError, match="length 0"):
        lu.RaySet.from_arrays(start, [[0, 0, 0.0]])


def test_threads_save_to_one_path(tmp_path):
    sets = [lu.make_source("disk", n, flux_lm=1) for n in (20_000, 30_000)]
    path = tmp_path / "rays.tm25ray"
    start = threading.Barrier(len(sets))
    failures = []

    def save(rays):
        start.wait()
        for _ in range(20):
            try:
                rays.save(path)
                if lu.read_rays(path) not in sets:
                    failures.append("mixed")
            except Exception as error:
                failures.append(error)

    threads = [threading.Thread(target=save, args=(rays,)) for rays in sets]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
