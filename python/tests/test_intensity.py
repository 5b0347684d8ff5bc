# SPDX-License-Identifier: Apache-2.0
"""Light distributions: arrays, files, figures, comparison, xarray, pickles."""
import pickle

import lucerna as lu
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

quick = settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])


def lambert(cd=100.0, c_deg=(0.0,)):
    gamma = np.arange(0, 181, 2.5)
    one = cd * np.maximum(np.cos(np.radians(gamma)), 0)
    return lu.IntensityDistribution(c_deg, gamma, np.tile(one, (len(c_deg), 1)))


@quick
@given(hnp.arrays(np.float64, (4, 5), elements=st.floats(0, 1e6)))
def test_arrays_and_files_come_back(tmp_path, cd):
    light = lu.IntensityDistribution([0, 90, 180, 270], [0, 45, 90, 135, 180], cd, standard_error=0.1 * cd)
    np.testing.assert_array_equal(light.cd, cd)
    assert pickle.loads(pickle.dumps(light)) == light
    cd[:, 0], cd[:, -1] = cd[0, 0], cd[0, -1]  # poles are one direction
    light = lu.IntensityDistribution([0, 90, 180, 270], [0, 45, 90, 135, 180], cd)
    light.save(tmp_path / "a.ies", digits=17)
    back = lu.read_intensity(tmp_path / "a.ies")
    c = np.array([0.0, 90, 180, 270])[:, None]
    np.testing.assert_allclose(back.at(c, light.gamma_deg), cd, rtol=1e-12, atol=1e-12)


def test_figures_of_a_lambertian():
    light = lambert()
    assert light.flux == pytest.approx(100 * np.pi, rel=2e-3)
    found = light.metrics()
    assert found.peak_cd == pytest.approx(100) and found.planes[0].beam_of_maximum_deg == pytest.approx(120, abs=0.1)
    assert light.at(17, 60) == pytest.approx(50) and light.at([0, 90], [[0], [30]]).shape == (2, 2)
    assert light.scaled(2).flux == pytest.approx(2 * light.flux)
    assert light.unit == "cd" and light.standard_error is None


def test_views_are_read_only_and_outlive_their_distribution():
    light = lambert()
    cd, gamma = light.cd, light.gamma_deg
    expected = cd.copy()
    assert not cd.flags.writeable and cd.base is light
    del light
    lambert(3.0)
    np.testing.assert_array_equal(cd, expected)
    assert gamma[-1] == 180


def test_comparison_of_equal_and_of_other_light():
    light = lambert(c_deg=(0.0, 90.0, 180.0, 270.0))
    same = lu.compare(light, light)
    assert same.relative_rms == 0 and same.overlap == pytest.approx(1)
    assert lu.compare(light, light.scaled(1.5)).relative_rms == pytest.approx(0.5)
    with pytest.raises(TypeError, match="two"):
        lu.compare(light, 3)


@pytest.mark.parametrize("arguments, text", [
    (([0], [0, 90], [[1]]), "shape"),
    (([0], [90, 0], [[1, 1]]), "gamma"),
    (([0], [0, 90], [[-1, 1]]), "negative|below|-1"),
    (([0], [0, 90], [[np.nan, 1]]), "finite"),
    (([5], [0, 90], [[1, 1]]), "first|C"),
    (([0, 400], [0, 90], [[1, 1], [1, 1]]), "C|360"),
    (([0], [0], [[1]]), "two|gamma"),
    (([0], [0, 200], [[1, 1]]), "180|gamma"),
])
def test_bad_grids_are_refused(arguments, text):
    with pytest.raises(lu.InputError, match=text):
        lu.IntensityDistribution(*arguments)


def test_bad_calls_are_refused(tmp_path):
    light = lambert()
    for call in (lambda: light.at(0, 181), lambda: light.at(0, np.nan), lambda: light.scaled(-1),
                 lambda: light.save(tmp_path / "a.xyz"), lambda: light.save(tmp_path / "a.ldt", digits=99),
                 lambda: lu.IntensityDistribution([0], [0, 90], [[1, 1]], unit="lm"),
                 lambda: lu.read_intensity(tmp_path / "a", isym3="x") if (tmp_path / "a").write_text("x") else None):
        with pytest.raises(lu.InputError):
            call()


def test_luminaires_are_kept(tmp_path):
    light = lu.IntensityDistribution([0], [0, 90, 180], [[3, 2, 1]],
                                     luminaire={"name": "lamp", "length_mm": 40.0, "width_mm": 20.0})
    assert light.luminaire.name == "lamp" and light.luminaire["length_mm"] == 40
    light.save(tmp_path / "a.ldt")
    assert lu.read_intensity(tmp_path / "a.ldt").luminaire.name == "lamp"
    assert pickle.loads(pickle.dumps(light)).luminaire == light.luminaire


def test_xarray_has_dimensions_and_units(traced):
    array = traced["far"].to_xarray()
    assert array.dims == ("C", "gamma") and array.attrs["units"] == "cd"
    assert array.sel(C=90, gamma=0) == traced["far"].at(90, 0)
    assert array.standard_error.shape == array.shape
    floor = traced["floor"].to_xarray()
    assert floor.dims == ("y", "x") and floor.attrs["units"] == "lx" and floor.shape == (20, 30)


def test_diagrams_are_svg(traced):
    for thing in (traced, traced["far"], lambert()):
        html = thing._repr_html_()
        assert html.startswith("<svg ") and "</svg>" in html
