"""Scale bench: seconds and memory against triangles, prims, instances, moving meshes, lights and picture width, and their growth.

pullfocus bench scale
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np

from render.gl.context import GraphicsContext
from render.lab.bench.progress import check_file, say
from render.lab.bench.scale.case import RAYS
from render.lab.bench.scale.plan import ScalePlan, SceneSize, plan_from_arguments
from render.lab.bench.scale.stage import write_stage

MEASURES = (
    *("open_s", "open_cpu_s", "first_s", "first_cpu_s", "frame_s", "frame_cpu_s", "memory_mb"),
    *("sketch_s", "sketch_cpu_s", "whole_s", "whole_cpu_s"),
)
_HEADS = ("open s", "cpu", "first s", "cpu", "frame s", "cpu", "MB", "sketch s", "cpu", "whole s", "cpu")
_POLL_S = 0.2


@dataclass(frozen=True)
class ScaleRow:
    """One case.

    Attributes:
        axis: name of the axis.
        value: place on it.
        size: size of the stage and the picture.
        outcome: ``done``, or why there are no measures: ``timeout``, ``memory`` or ``failed``.
        open_s: seconds from the file to the scene.
        open_cpu_s: the same by the processor's clock, of all threads, which other work hardly touches.
        first_s: seconds from the file to the first picture, the context and the shaders included.
        first_cpu_s: the same by the processor's clock.
        frame_s: seconds for a later frame, in which the camera has moved.
        frame_cpu_s: the same by the processor's clock.
        memory_mb: peak of resident memory until then, 10⁶ bytes.
        sketch_s: seconds for a sketch while dragging, with simpler levels of meshes where they are far away.
        sketch_cpu_s: the same by the processor's clock.
        whole_s: seconds for a sketch of whole meshes, in turns with the others.
        whole_cpu_s: the same by the processor's clock.
        drawn_triangles: triangles of the scene, instances counted.
        error: last line of a failure.
    """

    axis: str
    value: int
    size: SceneSize
    outcome: str
    open_s: float | None = None
    open_cpu_s: float | None = None
    first_s: float | None = None
    first_cpu_s: float | None = None
    frame_s: float | None = None
    frame_cpu_s: float | None = None
    memory_mb: float | None = None
    sketch_s: float | None = None
    sketch_cpu_s: float | None = None
    whole_s: float | None = None
    whole_cpu_s: float | None = None
    drawn_triangles: int | None = None
    error: str = ""


@dataclass(frozen=True)
class Growth:
    """Growth along one axis: a measure grows as the exponent's power of the value.

    Attributes:
        axis: name of the axis.
        measure: one of `MEASURES`.
        exponent: least squares over the logarithms of all cases that are done; None for fewer than two.
        at_end: exponent between the last two.
    """

    axis: str
    measure: str
    exponent: float | None
    at_end: float | None


@dataclass(frozen=True)
class ScaleBench:
    """Results of the scale bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        rays: rays per pixel.
        rows: cases in the order of the plan.
        growth: growth of each measure along each axis.
    """

    device: str
    rays: int
    rows: list[ScaleRow]
    growth: list[Growth]


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.scale.plan.add_arguments` declares them.

    Raises:
        SettingsError: a limit is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    plan = plan_from_arguments(arguments)
    result = measure_all(plan, lambda row: print(_line(row), file=sys.stderr, flush=True))
    say(result, report(result), arguments.json)


def measure_all(plan: ScalePlan, on_row: Callable[[ScaleRow], None]) -> ScaleBench:
    """Measure each case of a plan in a process of its own.

    Args:
        plan: cases and their limits.
        on_row: called after each case.
    """
    with GraphicsContext() as graphics:
        device = graphics.renderer
    rows = []
    for axis, value, size in plan.cases():
        with tempfile.TemporaryDirectory() as folder:
            stage = write_stage(Path(folder), size)
            rows.append(replace(_measure(stage, size, plan), axis=axis, value=value))
        on_row(rows[-1])
    return ScaleBench(device, RAYS, rows, growth_of(rows))


def growth_of(rows: Sequence[ScaleRow]) -> list[Growth]:
    """Growth of each measure along each axis.

    Args:
        rows: cases; those without measures are left out.
    """
    found = []
    for axis in dict.fromkeys(row.axis for row in rows):
        done = [row for row in rows if row.axis == axis and row.outcome == "done"]
        sizes = np.log([row.value for row in done])
        for measure in MEASURES:
            costs = np.log([max(getattr(row, measure), 1e-9) for row in done])
            slopes: list[float | None] = [None, None]
            if len(done) > 1:
                slopes = [float(np.polyfit(sizes[part], costs[part], 1)[0]) for part in (slice(None), slice(-2, None))]
            found.append(Growth(axis, measure, *slopes))
    return found


def report(result: ScaleBench) -> str:
    """The tables."""
    lines = [
        f"{result.device}; {result.rays} rays, pictures of 16:9. Seconds from the file to the scene (open) and to the first",
        "picture (first), and of a later frame, with the camera elsewhere: by the wall's clock, and by the processor's, of all",
        "threads. Memory is the peak that was resident, 10^6 bytes. Sketch: the picture while the camera is dragged, with",
        "simpler levels of meshes that are far away; whole: the same of whole meshes. A measure grows as the value to the power",
        "of the exponent: fitted to all cases, and between the last two.",
    ]
    heads = "".join(f"{head:>10}" for head in _HEADS)
    for axis in dict.fromkeys(row.axis for row in result.rows):
        lines += ["", f"{axis:>12}{heads}"]
        lines += [_line(row, named=False) for row in result.rows if row.axis == axis]
        slopes = [one for one in result.growth if one.axis == axis]
        lines.append(f"{'exponent':>12}" + "".join(_cell(one.exponent, 2) for one in slopes))
        lines.append(f"{'at the end':>12}" + "".join(_cell(one.at_end, 2) for one in slopes))
    return "\n".join(lines) + "\n"


def _measure(stage: Path, size: SceneSize, plan: ScalePlan) -> ScaleRow:
    """Measures of one stage, or why there are none; ``axis`` and ``value`` are left to the caller."""
    row = ScaleRow("", 0, size, "failed")
    result, log = stage.with_name("result.json"), stage.with_name("log")
    with log.open("wb") as output:
        command = [sys.executable, "-m", "render.lab.bench.scale.case", str(stage), str(size.width), str(result)]
        with subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT) as process:
            over = _watch(process, plan)
    if over is not None:
        return replace(row, outcome=over)
    if process.returncode != 0 or not result.exists():
        lines = log.read_text(errors="replace").strip().splitlines()
        return replace(row, error=lines[-1] if lines else f"exit status {process.returncode}")
    return replace(row, outcome="done", **json.loads(result.read_text()))


def _watch(process: subprocess.Popen[bytes], plan: ScalePlan) -> str | None:
    """Wait for a process and end it beyond a limit of the plan; returns the limit's name."""
    until = perf_counter() + plan.timeout_s
    while True:
        try:
            process.wait(_POLL_S)
        except subprocess.TimeoutExpired:
            over = (
                "timeout"
                if perf_counter() > until
                else "memory"
                if _resident(process.pid) > plan.memory_gb * 1e9
                else None
            )
            if over is not None:
                process.kill()
                return over
        else:
            return None


def _resident(pid: int) -> float:
    """Resident memory of a process in bytes; 0 where the system does not tell."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0.0
    return next((1024.0 * int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS:")), 0.0)


def _line(row: ScaleRow, *, named: bool = True) -> str:
    head = f"{row.axis:>12}" if named else ""
    if row.outcome != "done":
        return f"{head}{row.value:>12,}    {row.outcome}{f': {row.error}' if row.error else ''}"
    cells = "".join(_cell(getattr(row, measure), 0 if measure == "memory_mb" else 2) for measure in MEASURES)
    return f"{head}{row.value:>12,}{cells}"


def _cell(value: float | None, digits: int) -> str:
    return f"{f'{value:.{digits}f}' if value is not None else '-':>10}"
