# SPDX-License-Identifier: Apache-2.0
"""Error against bytes of small models: an SVG with a row of panels a source, a panel a view, a line a method."""
import html

from .log_axis import Axis
from .views import NAMES

COLOURS = {"lucerna": "#c0392b", "thesis": "#8e44ad", "light-field": "#2980b9", "picked-rays": "#7f8c8d",
           "interpolated-rays": "#27ae60"}
LEFT, TOP, WIDE, HIGH, GAP = 120, 46, 130, 96, 12
# Excess below this is drawn at it: noise leaves nothing of it.
LEAST = 1e-3


def plot(measured):
    """All panels have the same axes. Dashed: the noise of the rays that models were made of."""
    sources = list(dict.fromkeys(m.source for m in measured))
    methods = [m for m in COLOURS if any(m == x.method for x in measured)]
    x = Axis([m.size_bytes for m in measured], 0, WIDE)
    y = Axis([max(LEAST, v) for m in measured for view in m.views.values() for v in (view.excess, view.raw)], HIGH, 0)
    shapes, at = [], LEFT
    for m in methods:
        shapes.append(f'<circle cx="{at}" cy="12" r="4" fill="{COLOURS[m]}"/><text x="{at + 8}" y="16">{m}</text>')
        at += 30 + 7 * len(m)
    for column, view in enumerate(NAMES):
        shapes.append(f'<text x="{LEFT + column * (WIDE + GAP) + WIDE / 2}" y="{TOP - 8}" text-anchor="middle">{view}</text>')
    for row, source in enumerate(sources):
        top = TOP + row * (HIGH + GAP)
        shapes.append(f'<text x="8" y="{top + HIGH / 2}">{html.escape(source)}</text>')
        shapes += [f'<text x="{LEFT - 4}" y="{top + y(d) + 4:.1f}" text-anchor="end" font-size="9">{100 * d:g} %</text>'
                   for d in y.decades[:-1]]
        for column, view in enumerate(NAMES):
            ours = [m for m in measured if m.source == source]
            shapes.append(f'<g transform="translate({LEFT + column * (WIDE + GAP)} {top})">{_panel(ours, view, methods, x, y)}</g>')
    bottom = TOP + len(sources) * (HIGH + GAP)
    for column in range(len(NAMES)):
        shapes += [f'<text x="{LEFT + column * (WIDE + GAP) + x(d):.1f}" y="{bottom}" text-anchor="middle" font-size="9">'
                   f"{_bytes(d)}</text>" for d in x.decades[1:-1]]
    across, down = LEFT + len(NAMES) * (WIDE + GAP) + 8, bottom + 8
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across} {down}" width="{across}" height="{down}" '
            'font-family="sans-serif" font-size="12" role="img"><title>LB-F2: excess by bytes of the model, dashed the noise '
            f'of the rays that it was made of</title>\n<rect width="{across}" height="{down}" fill="#ffffff"/>\n'
            + "\n".join(shapes) + "\n</svg>\n")


def _panel(measured, view, methods, x, y):
    """One source in one view."""
    shapes = [f'<line x1="{x(d):.1f}" y1="0" x2="{x(d):.1f}" y2="{HIGH}" stroke="#eeeeee"/>' for d in x.decades]
    shapes += [f'<line x1="0" y1="{y(d):.1f}" x2="{WIDE}" y2="{y(d):.1f}" stroke="#eeeeee"/>' for d in y.decades]
    shapes.append(f'<rect width="{WIDE}" height="{HIGH}" fill="none" stroke="#999999"/>')
    raw = y(max(LEAST, measured[0].views[view].raw))
    shapes.append(f'<line x1="0" y1="{raw:.1f}" x2="{WIDE}" y2="{raw:.1f}" stroke="#000000" stroke-dasharray="3 3"/>')
    for method in methods:
        models = sorted((m for m in measured if m.method == method), key=lambda m: m.size_bytes)
        points = [(x(m.size_bytes), y(max(LEAST, m.views[view].excess)), m) for m in models]
        line = " ".join(f"{px:.1f},{py:.1f}" for px, py, _ in points)
        shapes.append(f'<polyline points="{line}" fill="none" stroke="{COLOURS[method]}"/>')
        shapes += [f'<circle cx="{px:.1f}" cy="{py:.1f}" r="2.5" fill="{COLOURS[method]}"><title>{method}: {m.size_bytes:,} bytes, '
                   f"{100 * m.views[view].excess:.2f} %</title></circle>" for px, py, m in points]
    return "".join(shapes)


def _bytes(n):
    return f"{n / 1000:g} kB" if n >= 1000 else f"{n:g} B"
