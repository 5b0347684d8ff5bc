# SPDX-License-Identifier: Apache-2.0
"""Submissions: how a peer's optimiser writes and scores them."""
import dataclasses
import json
import os
import pathlib
import platform
import subprocess
import tempfile
import time


@dataclasses.dataclass
class Stated:
    """What an author says of an entry; printed with its score, not checked."""
    free_parameters: int
    wall_s: float
    program: str
    method: str
    machine: str = dataclasses.field(default_factory=lambda: f"{platform.machine()}, {os.cpu_count()} threads")
    cpu_s: float | None = None

    def as_json(self):
        return {k: v for k, v in dataclasses.asdict(self).items() if v is not None}


def write_whole(path, text):
    """Writes a file whole or not at all: under a name of its own beside it, then renamed; its path."""
    path = pathlib.Path(path)
    temporary = path.with_name(f"{path.name}.part{os.getpid()}")
    temporary.write_text(text)
    return temporary.replace(path)


def write_submission(folder, task, name, author, surfaces, stated, target_place=None, light_table=None):
    """Writes submission.json (and the surfaces within it) to `folder`; its path.

    `surfaces`: a list of dicts with `name`, `role` ("mirror", "interface", "absorber"), `bspline` (a surface of
    this package) or `stl` (a file in the folder, with `normals`), and, where wanted, `place`, `flip`,
    `refractive_index`. `task`: its name, as LB-6-led-oval. `light_table`: of LB-1, an LDT file in the folder instead of
    surfaces, which are None then."""
    if (surfaces is None) == (light_table is None):
        found = "neither" if surfaces is None else "both"
        raise ValueError(f"{folder}: found {found} of surfaces and light_table, expected one")
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    submission = {"format": "lucerna-bench-submission", "version": 1, "task": task, "name": name, "author": author,
                  "stated": stated.as_json()}
    submission |= {"surfaces": surfaces} if light_table is None else {"light_table": light_table}
    if target_place is not None:
        submission["target_place"] = target_place
    return write_whole(folder / "submission.json", json.dumps(submission, indent=1) + "\n")


def score(scorer, task_file, submission_file, rays=100_000_000, seed=1, threads=None, rays_from=None):
    """Runs lucerna-bench-score; all figures as a dict (the keys of its JSON). Raises ValueError with the
    program's words where a file is refused. A score that does not count has `counts` False and `faults`."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "score.json"
        command = [str(scorer), str(task_file), str(submission_file), "--rays", str(int(rays)), "--seed", str(seed),
                   "--json", str(out)]
        if threads is not None:
            command += ["--threads", str(threads)]
        if rays_from is not None:
            command += ["--rays-from", str(rays_from)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not out.exists():
            raise ValueError(done.stderr.strip() or f"{' '.join(command)}: found exit {done.returncode} without a score")
        return json.loads(out.read_text())


def _shortfall(target, found):
    """How far a road is from its limits, as the sum of shares of them; 1 more for every other fault."""
    road, missed = found["road"], 0.0
    for name in ("overall_uniformity", "lengthwise_uniformity"):
        missed += max(0.0, 1.0 - road[name]["value"] / target[f"min_{name}"])
    missed += max(0.0, road["threshold_increment"]["value"] / target["max_threshold_increment"] - 1.0)
    return missed + len(found["faults"]) - sum(not limit["held"] for limit in road["limits"])


class Entry:
    """A function from parameters to surfaces as an entry: what an optimiser needs.

        entry = Entry("tasks/LB-6-led-oval.json", surfaces_of, scorer="build/lucerna-bench-score")
        entry.cost(p, rays=200_000)                  # error_48 without noise: for any minimiser
        entry.write("out", p, name="mine", author="me", program="...", method="...")

    `surfaces_of(parameters)` gives the list that `write_submission` takes, and `target_place_of(surfaces)`, of tasks
    whose target is free, where it is. Tasks are scored with other rays than
    these seeds give, so that nothing is gained by fitting to them."""

    def __init__(self, task_file, surfaces_of, scorer, threads=None, fitting_seed=1000, target_place_of=None):
        self.task_file = pathlib.Path(task_file)
        self.task = json.loads(self.task_file.read_text())
        self.surfaces_of = surfaces_of
        self.target_place_of = target_place_of or (lambda _: None)
        self.scorer = scorer
        self.threads = threads
        self.fitting_seed = fitting_seed
        self._start = time.monotonic()

    def figures(self, parameters, rays=1_000_000):
        """All figures of one set of parameters."""
        with tempfile.TemporaryDirectory() as folder:
            stated = Stated(free_parameters=len(parameters), wall_s=0.0, program="", method="")
            surfaces = self.surfaces_of(parameters)
            file = write_submission(folder, self.task["task"], "trial", "", surfaces, stated, self.target_place_of(surfaces))
            return score(self.scorer, self.task_file, file, rays, self.fitting_seed, self.threads)

    def cost(self, parameters, rays=1_000_000, light_weight=0.0):
        """The task's headline figure, such that less is better. What does not count costs 1 more. Where the headline
        is an error, `light_weight` times the square of the share of light that is missing in the rectangle is added
        to its square: without it an optimiser may throw away the light that does not fit. By how much a road misses
        its limits is added as shares of them, so that a search sees the way there."""
        found = self.figures(parameters, rays)
        if found["road"] is not None:
            return 1.0 - found["efficiency_with_losses"]["value"] + _shortfall(self.task["target"], found)
        fault = 0.0 if found["counts"] else 1.0
        if self.task["headline"] == "error_48":
            missing = 1.0 - found["in_rectangle"]["value"]
            return fault + (found["error_48"]["excess"] ** 2 + light_weight * missing**2) ** 0.5
        return fault + 1.0 - found["efficiency_with_losses"]["value"]

    def write(self, folder, parameters, name, author, program, method, wall_s=None, machine=None):
        """Writes the submission; `wall_s`: seconds of the search, those since this object was made if not given.
        Processor seconds are not known here (the scorer runs in processes of its own) and are left out."""
        seconds = time.monotonic() - self._start if wall_s is None else wall_s
        more = {} if machine is None else {"machine": machine}
        stated = Stated(free_parameters=len(parameters), wall_s=seconds, program=program, method=method, **more)
        surfaces = self.surfaces_of(parameters)
        return write_submission(folder, self.task["task"], name, author, surfaces, stated, self.target_place_of(surfaces))
