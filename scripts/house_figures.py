#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Figures of the sources' form: sizes, function lengths, comments. Usage: scripts/house_figures.py

A function runs from the first line of its signature to its closing brace, as clang-format lays them out; lambdas count to the
function that they are in. clang-tidy (`make check STAGES=tidy`) holds the limit of 60 lines more exactly."""
import os
import re

ROOT = "src/lucerna"
PUBLIC = "include/lucerna"


def lines_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read().split("\n")


def sources(endings, tests=False):
    for folder, _, names in sorted(os.walk(ROOT)):
        for name in sorted(names):
            if name.endswith(endings) and (tests or not name.endswith("_test.cpp")):
                yield os.path.join(folder, name)


def indent(line):
    return len(line) - len(line.lstrip())


def starts_function(line):
    keyword = re.match(r"\s*(if|for|while|switch|\}|else|do|catch)\b", line)
    return not keyword and not line.lstrip().startswith("}") and re.search(r"\)( const| noexcept| override)* \{$", line)


def function_lengths(lines):
    for i, line in enumerate(lines[:-1]):
        body = indent(lines[i + 1])
        if not starts_function(line) or not lines[i + 1].strip() or not 2 <= body <= 6:
            continue
        end = next((e for e in range(i + 1, len(lines)) if indent(lines[e]) == body - 2 and lines[e].strip()[:1] == "}"), i)
        begin = i
        while begin > 0 and lines[begin - 1].strip() and not re.search(r"[;}{:]$|^\s*//", lines[begin - 1]):
            begin -= 1
        yield end - begin + 1


def quantiles(values):
    values = sorted(values)
    return ", ".join(f"p{p} {values[min(len(values) - 1, len(values) * p // 100)]}" for p in (50, 90, 99)) + f", max {values[-1]}"


def comment_share(paths):
    lines = [line for path in paths for line in lines_of(path) if line.strip()]
    return 100.0 * sum(line.lstrip().startswith("//") or "///<" in line for line in lines) / len(lines)


def rooms():
    for room in sorted(os.listdir(ROOT)):
        folders = [len(names) for _, _, names in os.walk(os.path.join(ROOT, room)) if names]
        if folders:
            print(f"| `{room}` | {sum(folders)} | {len(folders)} | {max(folders)} |")


def main():
    print("| room | files | folders | files in the largest |\n|---|---|---|---|")
    rooms()
    lengths = [n for path in sources((".h", ".cpp")) for n in function_lengths(lines_of(path))]
    print(f"functions: {len(lengths)}; {quantiles(lengths)}; above 60: {sum(n > 60 for n in lengths)}")
    print(f"lengths of files: {quantiles([len(lines_of(path)) for path in sources(('.h', '.cpp', '.cu', '.cuh'))])}")
    public = [os.path.join(PUBLIC, name) for name in os.listdir(PUBLIC)]
    print(f"public headers: {len(public)}, [[nodiscard]] {sum(open(p, encoding='utf-8').read().count('[[nodiscard]]') for p in public)}")
    for what, paths in (("public headers", public), ("private headers", sources((".h",))), ("sources", sources((".cpp",)))):
        print(f"comments in {what}: {comment_share(paths):.1f} % of the lines")


main()
