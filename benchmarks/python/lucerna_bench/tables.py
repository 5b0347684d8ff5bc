# SPDX-License-Identifier: Apache-2.0
"""Tables and plots of scores: one Markdown table and one SVG picture for each family of tasks."""
import html
import json
import math
import pathlib

from .entry import write_whole
from .log_axis import Axis
from .tasks import family_of

COLUMNS = ["task", "entry", "error +- standard error, n = 48", "noise", "NMAE", "efficiency with losses",
           "without losses", "light outside", "free parameters", "wall s", "processor s", "made on", "program, commit",
           "scored with"]
COLOURS = {"lucerna": "#c0392b", "plain": "#7f8c8d", "point-source": "#2980b9", "cma-es": "#27ae60", "tree": "#8e44ad"}


def read_scores(out):
    """All scores below a folder of results, as (task, method, score.json), sorted."""
    found = []
    for file in sorted(pathlib.Path(out).glob("*/*/score.json")):
        found.append((file.parent.parent.name, file.parent.name, json.loads(file.read_text())))
    return found


def loss(s):
    """What is the less the better, and its standard error: the error, or the light that does not arrive."""
    if s["headline"] == "error_48":
        return s["error_48"]["excess"], s["error_48"]["standard_error"]
    return 1.0 - s["efficiency_with_losses"]["value"], s["efficiency_with_losses"]["standard_error"]


def percent(x, digits=2):
    return f"{100.0 * x:.{digits}f} %"


def quality(s):
    """How well the light is where it should be: the error, or what counts on a road."""
    if s["road"] is None:
        return f"{percent(s['error_48']['excess'])} +- {percent(s['error_48']['standard_error'])}"
    road = {name: figure["value"] for name, figure in s["road"].items() if name != "limits"}
    return (f"Uo {road['overall_uniformity']:.3f}, Ul {road['lengthwise_uniformity']:.3f}, "
            f"TI {percent(road['threshold_increment'], 1)}, {road['lm_per_cd_m2']:.0f} lm for 1 cd/m2")


def row(task, method, s):
    """The cells of one entry: what its score.json says, and no more."""
    stated = s["stated"]
    cpu = "not stated" if stated["cpu_s"] is None else f"{stated['cpu_s']:.1f}"
    if s["light_table"]:
        method += " (light table)"
    share = lambda figure, key="value": "-" if s[figure] is None else percent(s[figure][key])
    return [task, method if s["counts"] else f"{method} (does not count: {'; '.join(s['faults'])})", quality(s),
            share("error_48", "floor"), share("nmae"), share("efficiency_with_losses"), share("efficiency_without_losses"),
            share("outside_rectangle"), str(stated["free_parameters"]), f"{stated['wall_s']:.1f}", cpu, stated["machine"], stated["program"],
            f"{s['rays']:,} rays, seed {s['seed']}"]


def ranked(s):
    """Is it an entry that counts, and not a light table, which nobody can verify?"""
    return s["counts"] and not s["light_table"]


def best_losses(scores):
    """By task: the least loss of those that are ranked."""
    best = {}
    for task, _, s in scores:
        if ranked(s):
            best[task] = min(best.get(task, math.inf), loss(s)[0])
    return best


def _line(cells):
    return "| " + " | ".join(c.replace("|", "\\|") for c in cells) + " |"


def overview(scores):
    """A Markdown table: a row a task, a column a method. Errors with the light in the window, or the light alone where
    that is what counts."""
    found = {(task, method): s for task, method, s in scores}
    names = {method for _, method, _ in scores}
    methods = [*(m for m in COLOURS if m in names), *sorted(names - set(COLOURS))]
    best = best_losses(scores)
    lines = [_line(["task", *methods]), "|---|" + "---|" * len(methods)]
    for task in sorted({task for task, _, _ in scores}):
        cells = []
        for method in methods:
            s = found.get((task, method))
            text = "-" if s is None else _brief(s)
            cells.append(f"**{text}**" if s and ranked(s) and loss(s)[0] == best[task] else text)
        lines.append(_line([task, *cells]))
    return "\n".join(lines) + "\n"


def _brief(s):
    if not s["counts"]:
        return "does not count"
    light = f"{percent(s['efficiency_with_losses']['value'], 1)} light"
    if s["headline"] == "error_48":
        light = f"{quality(s)}, {light}"
    return light + (" (light table)" if s["light_table"] else "")


def table(scores):
    """The Markdown page of a family."""
    machines = sorted({s["run"]["machine"] for _, _, s in scores})
    lines = ["<!-- written by benchmarks/run_entries.py -->", "",
             "Errors have their noise taken out. NMAE has it in. Light counts as shares of the source's flux.", "",
             _line(COLUMNS), "|" + "---|" * len(COLUMNS)]
    best = best_losses(scores)
    for task, method, s in scores:
        cells = row(task, method, s)
        if ranked(s) and loss(s)[0] == best[task]:
            headline = 2 if s["headline"] == "error_48" else 5
            cells[headline] = f"**{cells[headline]}**"
        lines.append(_line(cells))
    lines += ["", f"Scored on: {'; '.join(machines)}."]
    return "\n".join(lines) + "\n"


def plot(scores, title):
    """Errors on a logarithmic axis, a line a task, with their standard errors; one that does not count is hollow."""
    tasks = sorted({task for task, _, _ in scores})
    methods = [m for m in COLOURS if any(m == method for _, method, _ in scores)]
    errors = [max(1e-5, loss(s)[0]) for _, _, s in scores]
    left, width, high_px, top = 16 + 7 * max(map(len, tasks)), 420, 26, 40
    axis = Axis(errors, left, left + width)
    x = lambda e: axis(max(axis.decades[0], e))
    bottom = top + high_px * len(tasks)
    shapes = []
    for decade in axis.decades:
        at = x(decade)
        shapes += [f'<line x1="{at:.1f}" y1="{top - 4}" x2="{at:.1f}" y2="{bottom}" stroke="#dddddd"/>',
                   f'<text x="{at:.1f}" y="{bottom + 14}" text-anchor="middle">{100 * decade:g} %</text>']
    for i, task in enumerate(tasks):
        y = top + high_px * (i + 0.5)
        shapes.append(f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{html.escape(task)}</text>')
        for name, method, s in scores:
            if name == task:
                shapes.append(_mark(s, x, y, COLOURS.get(method, "#000000"), method))
    keys, at = [], left
    for m in methods:
        keys.append(f'<circle cx="{at}" cy="14" r="5" fill="{COLOURS[m]}"/><text x="{at + 9}" y="18">{m}</text>')
        at += 34 + 7 * len(m)
    across, down = max(left + width + 40, at), bottom + 24
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across} {down}" width="{across}" height="{down}" '
            f'font-family="sans-serif" font-size="12" role="img"><title>{html.escape(title)}</title>\n'
            f'<rect width="{across}" height="{down}" fill="#ffffff"/>\n' + "\n".join(keys + shapes) + "\n</svg>\n")


def plot_title(family, scores):
    """What is drawn: errors, or of some tasks the light that does not arrive."""
    of_light = sorted({task for task, _, s in scores if s["headline"] != "error_48"})
    if len(of_light) == len({task for task, _, _ in scores}):
        return f"{family}: light that does not arrive"
    of_some = f"; of {', '.join(of_light)} light that does not arrive" if of_light else ""
    return f"{family}: error at 48 boxes a side, noise taken out{of_some}"


def _mark(s, x, y, colour, method):
    error, spread = loss(s)
    label = f"{method}: {percent(error)} +- {percent(spread)}"
    fill = colour if s["counts"] else "#ffffff"
    return (f'<line x1="{x(error - spread):.1f}" y1="{y}" x2="{x(error + spread):.1f}" y2="{y}" stroke="{colour}"/>'
            f'<circle cx="{x(error):.1f}" cy="{y}" r="5" fill="{fill}" stroke="{colour}">'
            f"<title>{html.escape(label)}</title></circle>")


def write_all(out):
    """Writes FAMILY.md and FAMILY.svg of all that is scored below `out`, and overview.md of all families; the files."""
    out, scores, files = pathlib.Path(out), read_scores(out), []
    for family in sorted({family_of(task) for task, _, _ in scores}):
        ours = [s for s in scores if family_of(s[0]) == family]
        page = f"# {family}\n\n![Errors by entry]({family}.svg)\n\n" + table(ours)
        picture = plot(ours, plot_title(family, ours))
        files += [write_whole(out / f"{family}.md", page), write_whole(out / f"{family}.svg", picture)]
    if scores:
        text = ("# Overview\n\n<!-- written by benchmarks/run_entries.py -->\n\nErrors at 48 boxes a side with their noise taken "
                "out, and the share of the source's light\nthat arrives. The least error of a task is bold, or the most "
                "light where that is what is asked\nfor. An entry with a smaller error and less light is not the better "
                "one. Noise, free parameters\nand seconds stand on the pages of the families.\n\n")
        files.append(write_whole(out / "overview.md", text + overview(scores)))
    return files
