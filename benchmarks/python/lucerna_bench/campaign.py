# SPDX-License-Identifier: Apache-2.0
"""Makes and scores all entries of a set of tasks, and can be stopped and taken up again.

    OUT/TASK/METHOD/submission.json   the entry; the folder appears as a whole, when the entry is made
    OUT/TASK/METHOD/made.json         how it was made: settings, versions, machine, seconds
    OUT/TASK/METHOD/score.json        its score, with a seed that was drawn after all entries were made"""
import dataclasses
import itertools
import json
import pathlib
import resource
import secrets
import shutil
import subprocess
import time

from .entry import Stated, score, write_submission, write_whole
from .methods import METHODS, Means, make
from .tables import quality
from .tasks import Task

SEEDS = 9_000_000_000_000_000


@dataclasses.dataclass
class Campaign:
    out: pathlib.Path
    means: Means
    rays: int
    commit: str
    force: bool = False
    say: callable = print

    def settings(self):
        """What an entry depends on; one made with others is not taken for this one."""
        return {"time_s": self.means.time_s, "fit_rays": self.means.fit_rays, "threads": self.means.threads,
                "seed": self.means.seed, "commit": self.commit}

    def run(self, tasks, methods=tuple(METHODS)):
        """Makes what is missing, then scores what is missing; what went wrong, one sentence each."""
        wrong = []
        for work in (self._make, self._score):
            # Nobody knows the seed before the last entry is made.
            seed = secrets.randbelow(SEEDS)
            for task, method in itertools.product(tasks, methods):
                try:
                    work(task, method, seed)
                except ValueError as e:
                    wrong.append(f"{task.name}, {method}: {e}")
                    self.say(wrong[-1])
        return wrong

    def _make(self, task: Task, method, _seed):
        folder = self.out / task.name / method
        if (folder / "submission.json").exists() and not self.force:
            return self._check_settings(folder)
        part = folder.with_name(f"{method}.part")
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        wall, cpu = time.monotonic(), _cpu_s()
        made = make(method, task, self.means, part)
        wall, cpu = time.monotonic() - wall, _cpu_s() - cpu
        program = lucerna_version(self.means.lucerna) if method == "lucerna" else f"lucerna_bench, {method}"
        stated = Stated(free_parameters=made.free_parameters, wall_s=wall, cpu_s=cpu,
                        program=f"{program}, commit {self.commit}", method=made.method)
        write_submission(part, task.name, made.name, "Lucerna", made.surfaces, stated, made.target_place)
        record = {"settings": self.settings(), "method": method, "program": program, "machine": stated.machine,
                  "wall_s": wall, "cpu_s": cpu, **made.notes}
        write_whole(part / "made.json", json.dumps(record, indent=1) + "\n")
        shutil.rmtree(folder, ignore_errors=True)
        part.rename(folder)
        self.say(f"{task.name}: {method}: made in {wall:.1f} s, {cpu:.1f} s of processors")

    def _check_settings(self, folder):
        was = json.loads((folder / "made.json").read_text())["settings"]
        for key, value in self.settings().items():
            if was.get(key) != value:
                raise ValueError(f"{folder / 'made.json'}: /settings/{key}: found {was.get(key)}, expected {value}: "
                                 "use another folder for the results, or --force to make it again")

    def _score(self, task, method, seed):
        folder = self.out / task.name / method
        if not (folder / "submission.json").exists():
            return
        file = folder / "score.json"
        if file.exists() and json.loads(file.read_text())["rays"] >= self.rays:
            return
        found = score(self.means.scorer, task.file, folder / "submission.json", self.rays, seed, self.means.threads)
        write_whole(file, json.dumps(found, indent=1) + "\n")
        self.say(f"{task.name}: {method}: {quality(found)}, efficiency {100 * found['efficiency_with_losses']['value']:.2f} %"
                 + ("" if found["counts"] else f", DOES NOT COUNT: {'; '.join(found['faults'])}"))


def _cpu_s():
    """Processor seconds of this process and of those that it started and that ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def lucerna_version(program):
    try:
        done = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=False)
    except OSError as e:
        raise ValueError(f"{program}: file: found {e.strerror}, expected the program lucerna") from None
    return f"lucerna {done.stdout.strip()}"


def commit_of(folder):
    """The commit of the checkout that a folder is in, and whether there are changes."""
    def git(*words):
        return subprocess.run(["git", *words], cwd=folder, capture_output=True, text=True, check=True).stdout.strip()
    try:
        # Pages of results are no change of what makes them.
        changed = git("status", "--porcelain", "--untracked-files=no", ":/", ":(top,exclude)docs")
        return git("rev-parse", "--short", "HEAD") + (" with changes" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        raise ValueError(f"{folder}: found no git checkout, expected one, or --commit TEXT") from None
