"""The start bench: `pullfocus record` as a process of its own, from the shell's return key to the first pixel and to the end.

The first pixel is there when the lens engine's first rays are traced: when the device has finished the first tile of the picture,
before the progress of the first frame is printed. Each run is a new process. The caches of the product and of the driver begin
empty in a folder of the bench's own: the first run fills them, the second run shows whether it did, the runs after it are warm.
The operating system's cache of files is warm in all of them, and Python's modules are compiled.

pullfocus bench start
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import perf_counter

from render.demo.shot import write_demo
from render.errors import PullfocusError
from render.lab.bench.checkouts import script_command, script_environment
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.lab.bench.start import recorder
from render.lab.bench.start.plan import FIRST_PIXEL_S, StartPlan, plan_from_arguments
from render.lab.bench.start.shot import write_small_shot

HERE, AGAINST = "this checkout", "the other one"
DEMO_FRAME = 64
PYTHON, EXIT = "python", "exit"
STAGES = (PYTHON, "imports", *dict.fromkeys(stage for _, _, stage in recorder.WATCHED), recorder.OTHER, EXIT)
"""Stages in the order of the table: the interpreter's start and end, and those of the recorder."""
_CHECKOUT = Path(__file__).resolve().parents[4]
PACKAGES = ("usd_schemas", "render")
"""Folders of a checkout that are compiled first."""
CACHES = ("PULLFOCUS_CACHE", "XDG_CACHE_HOME", "MESA_SHADER_CACHE_DIR", "__GL_SHADER_DISK_CACHE_PATH")
"""Environment variables that move the caches of the product, of Mesa and of NVIDIA's driver."""


@dataclass(frozen=True)
class StartRun:
    """One run, in seconds.

    Attributes:
        first_pixel_s: from before the process is started until the first rays are traced.
        done_s: until the process has ended.
        before_s: time before the first pixel by stage.
        after_s: time after it by stage.
        modules: number of Python modules that were loaded.
    """

    first_pixel_s: float
    done_s: float
    before_s: dict[str, float]
    after_s: dict[str, float]
    modules: int


@dataclass(frozen=True)
class StartRow:
    """The runs of one shot by one checkout.

    Attributes:
        shot: name of the shot.
        width: width of its pictures in pixels.
        checkout: which checkout.
        first: runs with empty caches.
        second: runs after these.
        warm: all later runs.
        missing: functions of the recorder that the checkout does not have.
    """

    shot: str
    width: int
    checkout: str
    first: list[StartRun]
    second: list[StartRun]
    warm: list[StartRun]
    missing: list[str]


@dataclass(frozen=True)
class StartBench:
    """Results of the start bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        rows: shots by widths and checkouts.
        goals: goals and whether they are met.
    """

    device: str
    rows: list[StartRow]
    goals: list[Goal]


class _Course:
    """Runs of one shot by one checkout, with caches of its own."""

    def __init__(
        self, shot: str, width: int, name: str, checkout: Path, arguments: Sequence[str], folder: Path
    ) -> None:
        self.shot, self.width, self.name = shot, width, name
        self.runs: tuple[list[StartRun], list[StartRun], list[StartRun]] = ([], [], [])
        self.missing: list[str] = []
        self.device = ""
        self._checkout, self._arguments, self._folder = checkout, arguments, folder
        self._round = 0
        folder.mkdir()
        compile_command = [
            sys.executable,
            "-m",
            "compileall",
            "-q",
            *PACKAGES,
        ]  # also where PYTHONDONTWRITEBYTECODE is set
        subprocess.run(compile_command, cwd=checkout, stdin=subprocess.DEVNULL, capture_output=True, check=False)

    def empty_caches(self) -> None:
        """Give the next run caches without entries."""
        self._round += 1

    def run(self, kind: int) -> None:
        """Run once; ``kind`` is 0 for the first run, 1 for the second, 2 for later ones."""
        times, out = self._folder / "times.json", self._folder / "picture.png"
        environment = script_environment(self._checkout)
        environment |= {name: str(self._folder / f"{name}{self._round}") for name in CACHES}
        command = [*script_command(Path(recorder.__file__)), str(times), "record", *self._arguments[:1], str(out)]
        began = perf_counter()
        done = subprocess.run(
            [*command, *self._arguments[1:]],
            cwd=self._folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        ended = perf_counter()
        if done.returncode != 0:
            raise PullfocusError(f"pullfocus record of {self.name} failed: {done.stderr.strip().splitlines()[-1:]}")
        found = json.loads(times.read_text(encoding="utf-8"))
        self.missing, self.device = found["missing"], found["device"]
        self.runs[kind].append(
            StartRun(
                found["first_pixel"] - began,
                ended - began,
                {PYTHON: found["began"] - began} | found["before"],
                found["after"] | {EXIT: ended - found["ended"]},
                found["modules"],
            )
        )

    def row(self) -> StartRow:
        """All runs."""
        return StartRow(self.shot, self.width, self.name, *self.runs, self.missing)


def measure(plan: StartPlan) -> StartBench:
    """Run every shot at every width by every checkout, the checkouts in turn.

    Raises:
        PullfocusError: a run failed.
    """
    rows: list[StartRow] = []
    device = ""
    checkouts = {HERE: _CHECKOUT} | ({} if plan.against is None else {AGAINST: plan.against})
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for shot, width in _pictures(plan):
            arguments = _arguments(shot, folder, width)
            courses = [
                _Course(shot, width, checkout, path, arguments, folder / f"{shot} {width} {i}")
                for i, (checkout, path) in enumerate(checkouts.items())
            ]
            for _ in range(plan.rounds):
                for course in courses:
                    course.empty_caches()
                for kind in (0, 1, *[2] * plan.runs):
                    for course in courses:
                        course.run(kind)
            rows += [course.row() for course in courses]
            device = courses[0].device
    return StartBench(device, rows, _goals(rows))


def _pictures(plan: StartPlan) -> list[tuple[str, int]]:
    """Shots and widths: the small shot at all widths, others at the last one."""
    return [(shot, width) for shot in plan.shots for width in (plan.widths if shot == "small" else plan.widths[-1:])]


def _arguments(shot: str, folder: Path, width: int) -> tuple[str, ...]:
    """Write a shot; the stage's file, then the options of `record`."""
    place = folder / shot
    place.mkdir(exist_ok=True)
    if shot == "demo":
        return (str(write_demo(place)), "-w", str(width), "--frames", str(DEMO_FRAME))
    return (str(write_small_shot(place)), "-w", str(width))


def _goals(rows: list[StartRow]) -> list[Goal]:
    goals = []
    for row in rows:
        if row.shot == "small" and row.checkout == HERE:
            name = f"first pixel of the small shot, {row.width} px wide, with warm caches, s, at most"
            time = median(run.first_pixel_s for run in row.warm)
            goals.append(Goal(name, FIRST_PIXEL_S, time, time <= FIRST_PIXEL_S))
    return goals


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.start.plan.add_arguments` declares them.

    Raises:
        SettingsError: a number is too small.
        PullfocusError: a run failed.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    result = measure(plan_from_arguments(arguments))
    say(result, report(result), arguments.json)


def report(result: StartBench) -> str:
    """The tables."""
    lines = [
        f"{result.device}; `pullfocus record` as a new process, milliseconds",
        "First run: empty caches of the product and the driver. Warm: from the third run on, median (least to most).",
    ]
    for row in result.rows:
        lines += ["", *_table(row)]
    return "\n".join([*lines, "", *goal_lines(result.goals)]) + "\n"


def _table(row: StartRow) -> list[str]:
    kinds = (row.first, row.second, row.warm)
    heading = f"{row.shot} shot, {row.width} px, {row.checkout}"
    lines = [f"{heading:40}  first run    second      warm"]
    lines.append(_line("until the first pixel", [[run.first_pixel_s for run in runs] for runs in kinds]))
    lines += [
        _line(f"  {stage}", [[run.before_s.get(stage, 0.0) for run in runs] for runs in kinds])
        for stage in STAGES
        if any(stage in run.before_s for runs in kinds for run in runs)
    ]
    lines.append(_line("from there to the end", [[run.done_s - run.first_pixel_s for run in runs] for runs in kinds]))
    lines += [
        _line(f"  {stage}", [[run.after_s.get(stage, 0.0) for run in runs] for runs in kinds])
        for stage in STAGES
        if any(stage in run.after_s for runs in kinds for run in runs)
    ]
    lines.append(_line("in all", [[run.done_s for run in runs] for runs in kinds]))
    lines.append(f"{'modules loaded':40}  {'':9}  {'':8}  {row.warm[-1].modules:8}")
    if row.missing:
        lines.append(f"not measured, since that checkout lacks them: {', '.join(row.missing)}")
    return lines


def _line(name: str, kinds: Sequence[Sequence[float]]) -> str:
    first, second, warm = ([1000 * value for value in values] for values in kinds)
    spread = f"({min(warm):.0f} to {max(warm):.0f})"
    return f"{name:40}  {median(first):9.0f}  {median(second):8.0f}  {median(warm):8.0f}  {spread}"
