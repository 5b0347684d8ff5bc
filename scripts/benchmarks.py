#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the tables and plots of docs/benchmarks from what the benchmarks print.

A page has blocks between two comments:

    <!-- measured: bench_trace 4 1024 && bench_trace 4 2048;
    plot: pictures/tracing.svg, M rays/s, AVX2, AVX-512, Embree -->
    ...
    <!-- /measured -->

The commands are run from build/release/bench (those that end in .py from bench), one after another. The rows that they print as a Markdown
table, with commit and date, become the block. A plot draws the named columns of the table as bars, with
that unit. An argument that begins with DATA/ stands for the files of that pattern in the folder of real
files (LUCERNA_DATA_DIR of the build); where it is missing, the block stays as it is.

Usage: scripts/benchmarks.py [--list | --plots | --check] [--build FOLDER] [--only TEXT] [PAGE...]
  --list   the blocks, one a line        --plots  draws the plots of the tables as they are
  --check  each block has a table and a commit, and names a benchmark that there is; exit 1 if not
  --only   blocks whose command has TEXT in it
"""
import argparse
import datetime
import html
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"<!-- measured: (?P<says>.*?) -->\n(?P<body>.*?)<!-- /measured -->\n", re.S)
STAMP = re.compile(r"^(Commit [0-9a-f]{7,}( with changes)?, \d{4}-\d\d-\d\d\.)", re.M)
COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"]  # Okabe and Ito 2008


class Block:
    """What a comment asks for, and what stands in the block."""

    def __init__(self, found):
        says, _, plot = " ".join(found["says"].split()).partition("; plot: ")
        self.commands = says.split(" && ")
        self.plot = [part.strip() for part in plot.split(",")] if plot else []
        self.body, self.start, self.end = found["body"], found.start("body"), found.end("body")

    def __str__(self):
        return " && ".join(self.commands)


def rows_of(text):
    """The cells of a Markdown table: head, then rows."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")]
            for line in text.splitlines() if line.startswith("|")]
    return [row for row in rows if not all(re.fullmatch(r":?-+:?", cell) for cell in row)]


def table_of(text):
    """The lines of `text` that are rows of a table; the head of a later table is left out."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    rule = next((i for i, line in enumerate(lines) if re.fullmatch(r"[|:\- ]+", line)), None)
    if rule != 1:
        return ""
    head = lines[:2]
    return "\n".join(head + [line for line in lines[2:] if line not in head]) + "\n"


def stamp():
    def git(*arguments):
        return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    changes = " with changes" if git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs") else ""
    return f"Commit {git('rev-parse', '--short', 'HEAD')}{changes}, {datetime.date.today()}.\n"


def number(cell):
    found = re.search(r"-?\d+(\.\d+)?(e-?\d+)?", cell.replace(",", ""))
    return float(found.group()) if found else None


def bars(rows, unit, columns):
    """A plot of bars, one group a row of the table."""
    at = [rows[0].index(column) for column in columns]
    groups = [(row[0], [number(row[i]) for i in at]) for row in rows[1:]]
    most = max((value for _, values in groups for value in values if value), default=1.0)
    high, width, gap = 14, 400, 10
    left = 16 + 7 * max(len(name) for name, _ in groups)
    across = left + width + 60
    y, shapes = 30, []
    for name, values in groups:
        middle = y + high * len(values) / 2
        shapes.append(f'<text x="{left - 8}" y="{middle + 4:.0f}" text-anchor="end">{html.escape(name)}</text>')
        for k, value in enumerate(values):
            if value is None:
                y += high
                continue
            shapes.append(f'<rect x="{left}" y="{y}" width="{width * value / most:.1f}" height="{high - 2}" '
                          f'fill="{COLOURS[k % len(COLOURS)]}"/>')
            shapes.append(f'<text x="{left + width * value / most + 4:.1f}" y="{y + 10}" font-size="10">{value:g}</text>')
            y += high
        y += gap
    keys, x = [], left
    for k, column in enumerate(columns):
        keys.append(f'<rect x="{x}" y="8" width="10" height="10" fill="{COLOURS[k % len(COLOURS)]}"/>'
                    f'<text x="{x + 14}" y="17">{html.escape(column)}</text>')
        x += 30 + 7 * len(column)
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across} {y + 20}" width="{across}" height="{y + 20}" '
            f'font-family="sans-serif" font-size="12" role="img"><title>{html.escape(unit)}</title>\n'
            f'<rect width="{across}" height="{y + 20}" fill="#ffffff"/>\n' + "\n".join(keys + shapes) +
            f'\n<text x="{left}" y="{y + 12}">{html.escape(unit)}</text>\n</svg>\n')


def draw(page, block, body):
    if not block.plot:
        return
    file, unit, *columns = block.plot
    (page.parent / file).write_text(bars(rows_of(body), unit, columns))


def data_folder(build):
    found = re.search(r"^LUCERNA_DATA_DIR:\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M)
    return pathlib.Path(found[1] if found else "")


def expanded(arguments, build):
    """The arguments with the names of files for patterns; nothing where a pattern has no file."""
    out = []
    for argument in arguments:
        if not argument.startswith("DATA/"):
            out.append(argument)
            continue
        files = sorted(data_folder(build).glob(argument.removeprefix("DATA/")))
        if not files:
            return None
        out += files
    return out


def measured(block, build):
    printed = ""
    for command in block.commands:
        print(f"{command} ...", flush=True)
        program, *arguments = command.split()
        arguments = expanded(arguments, build)
        if arguments is None:
            print("  not measured: its files are not here")
            return block.body
        script = [sys.executable, ROOT / "bench" / program, "--build", build]
        called = script if program.endswith(".py") else [build / "bench" / program]
        printed += subprocess.run([*called, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True,
                                  check=True).stdout
    table = table_of(printed)
    if not table:
        sys.exit(f"{block}: printed no table")
    return stamp() + "\n" + table


def faults(page, block):
    for command in block.commands:
        program = command.split()[0]
        source = ROOT / "bench" / (program if program.endswith(".py") else program.removeprefix("bench_") + ".cpp")
        if not source.exists():
            yield f"{page.name}: {source.relative_to(ROOT)} is not there"
    rows = rows_of(block.body)
    if len(rows) < 2 or any(len(row) != len(rows[0]) for row in rows):
        yield f"{page.name}: {block}: no table"
    if not STAMP.search(block.body):
        yield f"{page.name}: {block}: no commit"
    if block.plot:
        file, _, *columns = block.plot
        if not (page.parent / file).exists():
            yield f"{page.name}: {file} is not there"
        yield from (f"{page.name}: no column '{column}'" for column in columns if column not in rows[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for flag in ("--list", "--plots", "--check"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--only", default="")
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    found = []
    for page in options.pages or sorted((ROOT / "docs" / "benchmarks").glob("*.md")):
        text = page.read_text()
        blocks = [block for block in map(Block, BLOCK.finditer(text)) if options.only in str(block)]
        for block in reversed(blocks):
            if options.list:
                print(f"{page.name}: {block}")
            elif options.check:
                found += faults(page, block)
            else:
                body = block.body if options.plots else measured(block, options.build)
                draw(page, block, body)
                text = text[:block.start] + body + text[block.end:]
        if not (options.list or options.check or options.plots):
            page.write_text(text)
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
