# SPDX-License-Identifier: Apache-2.0
"""The five views on sources whose windows and differences are known, and models that are compared by them."""
import json
import math

import numpy as np
import pytest
from lucerna_bench import compression, interpolated_rays, views
from lucerna_bench.interpolated_rays import InterpolatedRays
from lucerna_bench.light_field import LightField, Sphere
from lucerna_bench.programs import run
from lucerna_bench.rays import Rays, read_tm25
from lucerna_bench.views import NAMES, Views, compare


def lambertian_disk(count, seed, radius=1.0, centre=(0.0, 0.0, 0.0), axis=2):
    """Even over a disk, Lambertian; `axis`: the coordinate that it shines along."""
    random = np.random.default_rng(seed)
    r, turn = radius * np.sqrt(random.random(count)), 2.0 * np.pi * random.random(count)
    s, way = np.sqrt(random.random(count)), 2.0 * np.pi * random.random(count)
    start = np.stack([r * np.cos(turn), r * np.sin(turn), np.zeros(count)], axis=-1)
    direction = np.stack([s * np.cos(way), s * np.sin(way), np.sqrt(1.0 - s * s)], axis=-1)
    roll = lambda x: np.roll(x, axis - 2, axis=1)
    return Rays(roll(start) + centre, roll(direction), np.ones(count))


def differences(reference, test):
    views = Views(reference)
    shares = views.shares(reference)
    return compare(shares, views.shares(test), shares)


def test_a_disk_has_the_frame_that_is_known():
    v = Views(lambertian_disk(200_000, 1, radius=2.0, centre=(5.0, -3.0, 7.0)))
    assert np.allclose(v.frame[2], [0.0, 0.0, 1.0], atol=5e-3)
    # Lines leave the disk evenly to all sides: the focus lies in it.
    assert np.allclose(v.focus, [5.0, -3.0, 7.0], atol=0.03)
    assert v.radius == pytest.approx(2.0 * math.sqrt(0.98), abs=0.02)
    assert v.focal == pytest.approx(1.25 * v.radius, abs=1e-9)
    # Of Lambertian light a cap to the angle t holds sin^2 t.
    assert v.cosine_low == pytest.approx(0.1, abs=0.01)
    # A square of half side 0.975 holds 99 % of a disk of radius 1.
    assert v.on_focus.half == pytest.approx(1.95, abs=0.02)
    assert v.across.half == pytest.approx(0.975, abs=0.01)


def test_a_collimator_makes_a_beam_of_the_focus():
    """Light from the focus leaves a paraboloid along its axis; light beside it does not."""
    disk = lambertian_disk(100_000, 1)
    v = Views(disk)
    focus = Rays(np.tile(v.focus, (1000, 1)), disk.direction[:1000], np.ones(1000))
    o, d = v._turned(focus)
    assert np.nanmax(np.abs(v._beam(o, d))) < 1e-12
    assert v.on_beam.half > 0.2
    # Law of reflection at the place where the ray meets the paraboloid, found here by bisection.
    o, d = v._turned(disk[:200])
    for start, way, found in zip(o, d, v._beam(o, d)):
        low, high = 0.0, 1e3
        for _ in range(200):
            middle = 0.5 * (low + high)
            at = start + middle * way
            low, high = (middle, high) if np.linalg.norm(at) + at[2] < 2.0 * v.focal else (low, middle)
        at = start + low * way
        normal = at / np.linalg.norm(at) + [0.0, 0.0, 1.0]
        normal /= np.linalg.norm(normal)
        assert np.allclose(found, (way - 2.0 * (way @ normal) * normal)[:2], atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_equal_sources_differ_by_noise_only(axis):
    """Five standard errors: a false alarm in a million, a view. A disk that is 5 % wider is told apart."""
    one, two, wide = (lambertian_disk(300_000, seed, radius, axis=axis) for seed, radius in ((1, 1.0), (2, 1.0), (3, 1.05)))
    same, other = differences(one, two), differences(one, wide)
    for name in NAMES:
        assert same[name].excess < 5.0 * same[name].standard_error
        assert same[name].raw == pytest.approx(same[name].floor / math.sqrt(2.0), rel=0.02)
    assert other["focus"].excess > 5.0 * other["focus"].standard_error
    assert other["far"].excess < 5.0 * other["far"].standard_error


def test_rays_through_a_point_do_not_lie_on_the_edge_of_two_cells():
    """Rounding to one side or the other is no difference of two sources."""
    d = np.random.default_rng(5).normal(size=(20_000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    aside = np.full((1, 3), 3e-8)
    weight = np.ones(len(d))
    reference, other = Rays(d - aside, d, weight), Rays(d + aside, d, weight)
    views = Views(reference)
    one, two = views.shares(reference), views.shares(other)
    for view in ("focus", "beam", "four_d"):
        # All but rays that run along the plane; with the point on an edge it is 0.9.
        assert np.abs(two[view][0] - one[view][0]).sum() < 0.1, view


def test_light_that_a_view_does_not_see_is_missing():
    disk = lambertian_disk(20_000, 1)
    v = Views(disk)
    back = Rays(disk.start, disk.direction * [1.0, 1.0, -1.0], disk.flux)
    whole, parts = v.shares(disk), v.shares(disk, block=999)
    assert whole["near"][0].sum() == pytest.approx(1.0)
    # The axis is that of the rays, a little tilted: of the grazing ones some go the other way.
    assert v.shares(back)["near"][0].sum() < 1e-3
    for name in NAMES:
        assert parts[name][0] == pytest.approx(whole[name][0], abs=1e-12)
    assert whole["far"][0][-1] == pytest.approx(0.01, abs=0.003)


def test_quantiles_are_weighted():
    assert views.weighted_quantile(np.array([3.0, 1.0, 2.0]), np.array([1.0, 1.0, 8.0]), 0.5) == 2.0
    assert views.weighted_quantile(np.array([3.0, 1.0, 2.0]), np.array([8.0, 1.0, 1.0]), 0.5) == 3.0


def test_light_field_holds_the_light():
    disk = lambertian_disk(200_000, 1, centre=(1.0, 2.0, 3.0))
    field = LightField(disk, 12)
    drawn = field.sample(200_000, 5)
    assert np.allclose(np.linalg.norm(drawn.direction, axis=1), 1.0)
    assert np.allclose(drawn.direction.mean(axis=0), disk.direction.mean(axis=0), atol=0.02)
    coarse, fine = (differences(disk, f.sample(200_000, 5)) for f in (field, LightField(disk, 20)))
    assert all(fine[name].excess < coarse[name].excess for name in ("far", "focus"))
    assert field.size_bytes == 12**4 + 64


@pytest.mark.parametrize("kind", [Sphere, interpolated_rays.Plane])
def test_surfaces_turn_rays_to_numbers_and_back(kind):
    disk = lambertian_disk(1000, 1, centre=(1.0, 2.0, 3.0))
    # Starts that are not all in one plane.
    moved = Rays(disk.start + np.linspace(0.0, 0.5, 1000)[:, None] * disk.direction, disk.direction, disk.flux)
    surface = kind(moved)
    numbers = surface.numbers(moved)
    again = surface.rays(numbers)
    assert np.allclose(again.direction, disk.direction, atol=1e-9) and (again.flux == 1.0).all()
    # The same lines, though they start on the surface.
    assert np.allclose(np.cross(again.start - disk.start, disk.direction), 0.0, atol=1e-9)
    assert np.allclose(surface.numbers(again), numbers, atol=1e-7)


def test_a_plane_of_flat_rays_is_found():
    """All within 20 degrees of the horizon, through a ring in z = 1."""
    random = np.random.default_rng(8)
    turn, rise = 2.0 * np.pi * random.random(1000), np.radians(5.0 + 15.0 * random.random(1000))
    way = np.stack([np.cos(rise) * np.cos(turn), np.cos(rise) * np.sin(turn), np.sin(rise)], axis=-1)
    start = np.stack([-0.1 * np.sin(turn), 0.1 * np.cos(turn), np.ones(1000)], axis=-1)
    assert interpolated_rays.Plane(Rays(start + way, way, np.ones(1000))).z == pytest.approx(1.0, abs=1e-3)


def test_a_plane_has_no_light_beyond_the_horizon():
    plane = interpolated_rays.Plane(lambertian_disk(100, 1))
    assert plane.rays(np.array([[0.0, 0.0, 0.6, 0.6], [0.0, 0.0, 0.9, 0.6]])).flux.tolist() == [1.0, 0.0]


def test_cells_share_the_box_of_their_points():
    points = np.random.default_rng(2).random((1001, 4))
    found = interpolated_rays.cells(points)
    assert ((found[:, 0] <= points) & (points <= found[:, 1])).all()
    assert np.prod(found[:, 1] - found[:, 0], axis=1).sum() == pytest.approx(np.prod(np.ptp(points, axis=0)), rel=1e-12)
    # No two cells overlap: each holds one point.
    inside = ((points[:, None] > found[None, :, 0]) & (points[:, None] < found[None, :, 1])).all(axis=2)
    assert (inside.sum(axis=1) <= 1).all()
    less = interpolated_rays.drawn_in(found, points)
    assert ((less[:, 0] <= points) & (points <= less[:, 1])).all()
    assert (less[:, 0] >= found[:, 0]).all() and (less[:, 1] <= found[:, 1]).all()
    # Axes that are cyclic have no edge.
    whole = interpolated_rays.cells(points, (1, 3))
    assert (interpolated_rays.drawn_in(whole, points, (1, 3))[:, :, [1, 3]] == whole[:, :, [1, 3]]).all()
    assert whole[:, 0, [1, 3]].min() == 0.0 and whole[:, 1, [1, 3]].max() == 1.0
    inner = (found[:, 0] > points.min(axis=0)).all(axis=1) & (found[:, 1] < points.max(axis=0)).all(axis=1)
    assert 20 < inner.sum() < 1001 and (less[inner] == found[inner]).all() and not (less[~inner] == found[~inner]).all()


def test_a_sphere_has_no_seam():
    """Light of a sphere is as bright at the azimuth where numbers begin anew as elsewhere: 5 standard errors of 500 cells."""
    random = np.random.default_rng(5)
    way = random.normal(size=(4000, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    drawn = InterpolatedRays(Rays(np.zeros((4000, 3)) + 1e-3 * random.normal(size=(4000, 3)), way, np.ones(4000)))
    assert isinstance(drawn.surface, Sphere)
    out = drawn.sample(200_000, 6).direction
    seam = np.mean(np.abs(np.arctan2(out[:, 1], out[:, 0])) < np.pi / 16.0)
    assert seam == pytest.approx(1.0 / 16.0, abs=5.0 * math.sqrt(1.0 / 16.0 / 4000.0))


def test_a_dome_is_interpolated_where_its_rays_are_narrowest():
    """The rays of a disk, which start on a dome above it: the plane is that of the disk."""
    disk = lambertian_disk(50_000, 1, centre=(0.0, 0.0, 2.0))
    o = disk.start - [0.0, 0.0, 2.0]
    b = np.sum(o * disk.direction, axis=1)
    way = -b + np.sqrt(b * b - np.sum(o * o, axis=1) + 9.0)
    dome = Rays(disk.start + way[:, None] * disk.direction, disk.direction, disk.flux)
    drawn = InterpolatedRays(dome[:4000])
    assert drawn.surface.z == pytest.approx(2.0, abs=0.03)
    again = np.random.default_rng(3).integers(4000, size=100_000)
    kept = dome[:4000]
    picked, spread = (differences(dome, rays) for rays in
                      (Rays(kept.start[again], kept.direction[again], np.ones(100_000)), drawn.sample(100_000, 4)))
    for name in ("far", "focus", "beam", "four_d"):
        assert spread[name].excess < 0.7 * picked[name].excess


def test_spread_rays_are_nearer_than_the_rays_themselves():
    disk = lambertian_disk(200_000, 1, centre=(1.0, 2.0, 3.0))
    kept = disk[:4000]
    again = np.random.default_rng(3).integers(4000, size=200_000)
    picked = differences(disk, Rays(kept.start[again], kept.direction[again], np.ones(200_000)))
    few, spread = (differences(disk, InterpolatedRays(disk[:n]).sample(200_000, 4)) for n in (250, 4000))
    for name in ("far", "focus", "beam", "four_d"):
        assert spread[name].excess < 0.7 * picked[name].excess
        assert spread[name].excess < few[name].excess


def test_the_task_is_read_and_damage_is_named(tasks, tmp_path):
    task = compression.read_compression(tasks.parent / "forward" / "LB-F2.json")
    assert task.train_rays >= 10**6 and len({s.name for s in task.sources}) == len(task.sources) >= 6
    (tmp_path / "t.json").write_text('{"format": "x"}')
    with pytest.raises(ValueError, match="t.json: /format: found another format, expected lucerna-bench-compression"):
        compression.read_compression(tmp_path / "t.json")
    (tmp_path / "t.json").write_text("{")
    with pytest.raises(ValueError, match="t.json: file: found Expecting"):
        compression.read_compression(tmp_path / "t.json")


def test_files_that_are_cut_are_refused(lucerna, tmp_path):
    file = tmp_path / "disk.tm25ray"
    run([lucerna, "make-source", "disk", "-n", "1000", "-o", file, "--quiet"])
    rays = read_tm25(file)
    assert len(rays) == 1000 and np.allclose(np.linalg.norm(rays.direction, axis=1), 1.0, atol=1e-6)
    whole = file.read_bytes()
    cut = tmp_path / "cut.tm25ray"
    for size in (0, 3, 30, 36287, 36288, len(whole) - 1):
        cut.write_bytes(whole[:size])
        with pytest.raises(ValueError, match="cut.tm25ray: byte .*: found .*, expected"):
            read_tm25(cut)
    with pytest.raises(ValueError, match="none.tm25ray: file: found No such file"):
        read_tm25(tmp_path / "none.tm25ray")


def test_models_are_measured_at_their_sizes(lucerna, tmp_path):
    task = compression.Compression([compression.Source("disk", "disk", ("--radius-mm", "1"))], [4000, 60000], 50_000, 1)
    found = compression.measure(task, task.sources[0], compression.methods(lucerna), lucerna, 100_000, 77, say=lambda _: None)
    # A model that more bytes leave as it is appears once.
    assert list(dict.fromkeys(m.method for m in found)) == ["lucerna", "thesis", "light-field", "picked-rays",
                                                     "interpolated-rays"]
    assert len({(m.method, m.size_bytes) for m in found}) == len(found)
    assert all(0 < m.size_bytes <= m.max_bytes for m in found)
    worst = {m.method: {} for m in found}
    for m in found:
        worst[m.method][m.max_bytes] = m.views[m.worst].excess
    # Few rays have much noise; a model of an exact disk has little.
    picked = worst["picked-rays"]
    assert picked[4000] > picked[60000] > 2.0 * max(worst["lucerna"].values())
    page = compression.write(tmp_path, found, {"train_rays": 50_000, "test_rays": 100_000, "seed": 77, "program": "p",
                                               "commit": "c", "machine": "m"})
    assert page.read_text().count("| disk |") == len(found)
    assert (tmp_path / "LB-F2.svg").read_text().count(" bytes, ") == len(found) * len(found[0].views)
    kept = json.loads((tmp_path / "LB-F2.json").read_text())
    assert kept["models"][0]["views"]["far"]["excess"] == found[0].views["far"].excess


def test_a_model_that_is_too_large_does_not_count(lucerna):
    class Large:
        def compress(self, *_):
            return compression.Model(10**6, None)
    task = compression.Compression([compression.Source("disk", "disk", ())], [4000], 1000, 1)
    with pytest.raises(ValueError, match="large: disk: found a model of 1000000 bytes, expected no more than 4000"):
        compression.measure(task, task.sources[0], {"large": Large()}, lucerna, 1000, 3)
