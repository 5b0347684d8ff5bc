# SPDX-License-Identifier: Apache-2.0
"""The curves of LB-F2: what is drawn stands where its numbers say."""
import re
import xml.etree.ElementTree as xml

import pytest
from lucerna_bench import curves, log_axis
from lucerna_bench.compression import Measured
from lucerna_bench.views import NAMES, Difference


def measured(method, size, excess, raw=0.01, source="disk"):
    views = {name: Difference(excess, 0.0, excess, 0.0, raw) for name in NAMES}
    return Measured(source, method, size, size, 1.0, 1e6, views)


def places(svg, method):
    """Of the first panel: x and y of a method's models."""
    panel = re.search(r"<g .*?</g>", svg).group()
    found = re.findall(rf'<circle cx="(\S+)" cy="(\S+)" r="2.5" fill="{curves.COLOURS[method]}"', panel)
    return [(float(x), float(y)) for x, y in found]


def test_marks_stand_where_their_numbers_say():
    svg = curves.plot([measured("lucerna", 1000, 0.1), measured("lucerna", 100_000, 0.01),
                       measured("thesis", 10_000, 1.0)])
    # Two decades of bytes and two of error.
    assert places(svg, "lucerna") == [(0.0, curves.HIGH / 2), (curves.WIDE, curves.HIGH)]
    assert places(svg, "thesis") == [(curves.WIDE / 2, 0.0)]
    assert "lucerna: 100,000 bytes, 1.00 %" in svg


def test_what_noise_leaves_nothing_of_is_drawn_at_the_least_excess():
    svg = curves.plot([measured("lucerna", 1000, 0.0), measured("lucerna", 20_000, 0.1)])
    assert places(svg, "lucerna")[0] == (0.0, curves.HIGH)


def test_models_are_joined_by_size_whatever_their_order():
    up, down = (curves.plot([measured("thesis", n, 1.0 / n) for n in sizes]) for sizes in ((10, 100), (100, 10)))
    assert re.search("points=.*?fill", up).group() == re.search("points=.*?fill", down).group()


def test_a_panel_a_source_and_view_and_names_are_escaped():
    svg = curves.plot([measured("lucerna", 10, 0.1), measured("lucerna", 10, 0.1, source="<b>")])
    assert len(xml.fromstring(svg).findall("{*}g")) == 2 * len(NAMES)
    assert "&lt;b&gt;" in svg


@pytest.mark.parametrize("values, decades", [([1, 10], [1, 10]), ([3], [1, 10]), ([2, 2000], [1, 10, 100, 1000, 10000])])
def test_axes_end_at_decades(values, decades):
    axis = log_axis.Axis(values, 0, 100)
    assert axis.decades == pytest.approx(decades)
    assert (axis(decades[0]), axis(decades[-1])) == pytest.approx((0, 100))
