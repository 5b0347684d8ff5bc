# SPDX-License-Identifier: Apache-2.0
"""Errors of every kind: types, parts, damaged files, pickles."""
import errno
import pickle
import random

import lucerna as lu
import pytest
from conftest import parabola

READERS = [lu.read_rays, lu.read_model, lu.read_intensity, lu.Scene.load, lu.compress]


@pytest.mark.parametrize("read", READERS)
def test_files_that_are_not_there(read, tmp_path):
    with pytest.raises(FileNotFoundError) as caught:
        read(tmp_path / "none.file")
    assert caught.value.filename == str(tmp_path / "none.file") and caught.value.errno == 2


@pytest.mark.parametrize("read", READERS)
def test_folders_are_no_files(read, tmp_path):
    with pytest.raises((IsADirectoryError, lu.InputError)):
        read(tmp_path)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("content", [b"", b"\0" * 100, b"what is this", b"\x89NFL\r\n\x1a\n", bytes(range(256))])
def test_files_of_another_kind(read, tmp_path, content):
    path = tmp_path / "a.file"
    path.write_bytes(content)
    with pytest.raises(lu.InputError) as caught:
        read(path)
    assert "a.file" in str(caught.value)


def test_places_that_cannot_be_written(tmp_path, rays, model, traced):
    light, mirror = traced["far"], parabola()
    for save in (lambda p: rays.save(p, format="tm25"), model.save, lambda p: light.save(p, format="ldt"),
                 traced.scene.save):
        with pytest.raises(OSError):
            save(tmp_path / "no" / "such" / "folder.ldt")
        with pytest.raises(OSError):
            save(tmp_path)
    with pytest.raises(OSError):
        mirror.save(tmp_path / "no" / "mirror.step")
    (tmp_path / "file").write_text("x")
    with pytest.raises(OSError):
        traced.save(tmp_path / "file" / "folder")
    assert (tmp_path / "file").read_text() == "x"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file"], "nothing half-written is left"


@pytest.mark.parametrize("read", READERS)
def test_errors_of_names_of_any_bytes(read, tmp_path):
    path = str(tmp_path / "\udcff.file")
    with pytest.raises(FileNotFoundError) as caught:
        read(path)
    assert caught.value.filename == path
    with open(path, "wb") as file:
        file.write(b"what is this")
    with pytest.raises(lu.InputError) as caught:
        read(path)
    assert caught.value.path in (path, None) and path in str(caught.value)


def test_saving_and_scenes_with_names_of_any_bytes(tmp_path, rays):
    with pytest.raises(FileNotFoundError) as caught:
        rays.save(tmp_path / "\udcff" / "a.tm25ray")
    assert caught.value.filename == str(tmp_path / "\udcff" / "a.tm25ray")
    for scene in (lambda p: lu.Scene([p]), lambda p: lu.Scene([{"kind": "disk"}], target=p)):
        with pytest.raises(lu.InputError, match="UTF-8"):
            scene(tmp_path / "\udcff.tm25ray")


def test_names_that_no_file_can_have(tmp_path, rays, model):
    """The error number is that of `open`."""
    (tmp_path / "loop").symlink_to("loop")
    for path, number in ((tmp_path / ("n" * 300), errno.ENAMETOOLONG), (tmp_path / "loop", errno.ELOOP)):
        for read in READERS:
            with pytest.raises(OSError) as caught:
                read(path)
            assert caught.value.errno == number, read
    for save in (lambda p: rays.save(p, format="tm25"), model.save):
        with pytest.raises(OSError) as caught:
            save(tmp_path / ("n" * 300))
        assert caught.value.errno == errno.ENAMETOOLONG
        with pytest.raises(OSError) as caught:
            save(tmp_path / "loop" / "file")
        assert caught.value.errno == errno.ELOOP


def test_parts_of_an_error(tmp_path):
    path = tmp_path / "lamp.toml"
    path.write_text("[[source]]\nkind = 'disk'\nradius_mm = -3\n")
    with pytest.raises(lu.InputError) as caught:
        lu.Scene.load(path)
    error = caught.value
    assert isinstance(error, ValueError)
    assert error.path == str(path) and error.place == "line 3: source[0].radius_mm"
    assert (error.found, error.expected, error.cause) == ("-3", "> 0", "out of range")
    copy = pickle.loads(pickle.dumps(error))
    assert copy.place == error.place and str(copy) == str(error)


def damaged(data, rng):
    """A few bytes changed, or the end cut off."""
    data = bytearray(data)
    if rng.random() < 0.5:
        del data[rng.randrange(len(data)):]
    for _ in range(rng.randrange(4)):
        if data:
            data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data)


def test_damaged_files_raise_or_are_right(tmp_path, rays, model, traced):
    rays.save(tmp_path / "a.tm25ray")
    model.save(tmp_path / "a.nfl")
    traced["far"].save(tmp_path / "a.ldt")
    traced["far"].save(tmp_path / "a.ies")
    rng = random.Random(1)
    for name, read in (("a.tm25ray", lu.read_rays), ("a.nfl", lu.read_model), ("a.ldt", lu.read_intensity),
                       ("a.ies", lu.read_intensity)):
        whole = (tmp_path / name).read_bytes()
        for _ in range(40):
            (tmp_path / "bad").write_bytes(damaged(whole, rng))
            try:
                read(tmp_path / "bad")
            except (lu.InputError, OSError):
                pass


def test_damaged_pickles_raise(rays, model, traced):
    cls, arguments = type(model), model.__getstate__()
    for state in ((), (b"", []), (arguments[0][:-1], []), (b"x" * 100, [])):
        with pytest.raises(lu.InputError):
            cls.__new__(cls).__setstate__(state)
    with pytest.raises((lu.InputError, RuntimeError, TypeError)):
        type(rays).__new__(type(rays)).__setstate__((1, 2))
    sums, scene, *rest = traced.__getstate__()
    rng = random.Random(2)
    for _ in range(40):
        try:
            type(traced).__new__(type(traced)).__setstate__((damaged(sums, rng), scene, *rest))
        except lu.InputError:
            pass


@pytest.mark.parametrize("cls", [lu.RaySet, lu.SourceModel, lu.TraceResult, lu.PlaneImage, lu.DesignResult])
def test_what_is_not_made_is_not_used(cls):
    with pytest.raises(TypeError):
        cls()
