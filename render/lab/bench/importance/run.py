"""The importance bench: Fearing's five experiments (1995, section 6.1), by importance ordering and by the linear method.

pullfocus bench importance
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import moderngl
import numpy as np

from render.files import check_writable, write_atomic
from render.frame import FrameRenderer
from render.gl.shaders import ProgramCache
from render.lab.bench.clock import Spent, StageClock
from render.lab.bench.importance.plan import Plan, plan_from_arguments
from render.lab.bench.importance.results import CutoffRow, ExperimentRow, ImportanceBench, SizesRow
from render.lab.bench.importance.scene import (
    CUTOFF_EXPERIMENT,
    EXPERIMENTS,
    FOCAL_MM,
    SIZED_EXPERIMENTS,
    Experiment,
    Picture,
    StillLife,
)
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.lab.reference.metrics import psnr_db
from render.model.arrays import FloatArray
from render.postblur.importance_field import ImportanceField, UpdateLimit
from render.postblur.linear import NO_CUTOFF, FieldSpreader, LinearField
from render.postblur.point_spread import Field
from render.postblur.spread_tables import STEP_PX, Gaussian

GOAL_EQUAL = 1e-4


class _Rig:
    """The pictures of a scene on a device, and what spreads them."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, scene: StillLife) -> None:
        self._ctx, self._programs, self._most_px = ctx, programs, 1.0
        self.scene, size = scene, scene.size
        self._light, self._radii = ctx.texture((size, size), 4, dtype="f4"), ctx.texture((size, size), 1, dtype="f4")
        self._linear = LinearField(FieldSpreader(ctx, programs, cutoff_px=NO_CUTOFF))
        self._ordered: ImportanceField | None = None

    def begin(self, experiment: Experiment) -> None:
        """Make tables, compile what is not compiled, and forget all pictures."""
        if self._ordered is not None:
            self._ordered.release()
        most = [np.abs(self.scene.frame(experiment, t).radii).max() for t in np.linspace(0, 1, 9)]
        self.blur_px = float(max(most))
        self._most_px = 1.05 * self.blur_px
        spreader = FieldSpreader(self._ctx, self._programs, cutoff_px=NO_CUTOFF)
        self._ordered = ImportanceField(self._ctx, self._programs, spreader)
        first, last = (self.scene.frame(experiment, t) for t in (0.0, 0.02))
        for picture in (first, last):
            self.linear(picture)
            self.ordered(picture)
        self._ordered.release()
        spreader.update_tables(Gaussian(), self._most_px)

    def none(self, picture: Picture) -> Spent:
        """Upload a picture, and return its cost."""
        return self._timed(lambda: self._send(picture))

    def linear(self, picture: Picture) -> Spent:
        """Spread a whole picture, and return its cost."""

        def spread() -> None:
            self.linear_sums = self._linear.spread(self._send(picture), 1.0, Gaussian(), self._most_px)

        return self._timed(spread)

    def ordered(self, picture: Picture, share: float = 1.0) -> Spent:
        """Spread the changes, and return their cost."""
        target = self._target

        def spread() -> None:
            self.ordered_sums = target.update(self._send(picture), 1.0, Gaussian(), self._most_px, UpdateLimit(share))

        return self._timed(spread)

    @property
    def changed(self) -> float:
        """Share of the pixels that had changed in the last picture."""
        return self._target.stats.changed / self.scene.size**2

    @property
    def _target(self) -> ImportanceField:
        if self._ordered is None:
            raise ValueError("no experiment has begun")
        return self._ordered

    def pictures(self) -> tuple[FloatArray, FloatArray]:
        """Last pictures of both methods, as averages."""
        return _average(self.linear_sums), _average(self.ordered_sums)

    def _send(self, picture: Picture) -> Field:
        self._light.write(picture.light)
        self._radii.write(picture.radii)
        return Field(self._light, self._radii, 0)

    def _timed(self, work: Callable[[], object]) -> Spent:
        clock = StageClock(self._ctx.finish)
        work()
        clock("work")
        return clock.spent["work"]

    def release(self) -> None:
        """Release the memory."""
        for target in (self._light, self._radii, self._linear, self._ordered):
            if target is not None:
                target.release()


def measure(plan: Plan) -> ImportanceBench:
    """Measure everything.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    rows, cutoff = [], []
    with FrameRenderer() as renderer:
        ctx, is_software = renderer.graphics.ctx, renderer.graphics.is_software
        programs = ProgramCache(ctx)
        for size in plan.sizes:
            rig = _Rig(ctx, programs, StillLife(size))
            linear = plan.linear_frames(size)
            rows += [_experiment(rig, one, plan.frames, linear, is_software=is_software) for one in EXPERIMENTS]
            if size == plan.sizes[0]:
                cutoff = [_cut_off(rig, share, plan.frames) for share in plan.shares]
            rig.release()
        sizes = list(_sizes(ctx, programs, plan, is_software=is_software))
        device = renderer.graphics.renderer
    return ImportanceBench(device, STEP_PX, rows, sizes, cutoff, _goals(rows))


def _sizes(ctx: moderngl.Context, programs: ProgramCache, plan: Plan, *, is_software: bool) -> Iterator[SizesRow]:
    """The experiments whose speed-up depends on what Fearing leaves open, over it."""
    linear = max(2, round(plan.linear_share * plan.frames))
    for star_radius_mm in plan.star_radii_mm:
        for film_mm in plan.films_mm:
            scene = StillLife(plan.sizes[0], film_mm, star_radius_mm)
            rig = _Rig(ctx, programs, scene)
            for one in SIZED_EXPERIMENTS:
                row = _experiment(rig, one, plan.frames, linear, is_software=is_software)
                share = 2 * star_radius_mm * FOCAL_MM / film_mm / one.at(0.0).star[2]
                found = row.changed, row.speedup, one.goal or 0.0
                yield SizesRow(one.name, star_radius_mm, film_mm, share, rig.blur_px, *found)
            rig.release()


def _experiment(
    rig: _Rig, experiment: Experiment, frames: int, linear_frames: int, *, is_software: bool
) -> ExperimentRow:
    size = rig.scene.size
    rig.begin(experiment)
    at = np.unique(np.linspace(0, frames - 1, linear_frames).round().astype(int))
    none, ordered, linear, changed, apart = [], [], [], [], 0.0
    for number, picture in enumerate(rig.scene.frames(experiment, frames)):
        none.append(rig.none(picture))
        ordered.append(rig.ordered(picture))
        changed.append(rig.changed)
        if number in at:
            linear.append(rig.linear(picture))
            apart = max(apart, float(np.abs(np.subtract(*rig.pictures())).max()))
    linear_s, ordered_s = _means(linear), _means(ordered)
    later = _means(linear[1:]), _means(ordered[1:])
    clock = int(is_software)
    return ExperimentRow(
        experiment.name,
        experiment.title,
        size,
        frames,
        len(linear),
        frames * linear_s[0],
        frames * ordered_s[0],
        frames * _means(none)[0],
        frames * linear_s[1],
        frames * ordered_s[1],
        linear_s[clock] / ordered_s[clock],
        later[0][clock] / later[1][clock],
        float(np.mean(changed[1:])),
        apart,
    )


def _means(spent: Sequence[Spent]) -> tuple[float, float]:
    """Mean wall time and processor time in seconds."""
    return float(np.mean([one.wall_ms for one in spent])) / 1e3, float(np.mean([one.cpu_ms for one in spent])) / 1e3


def _cut_off(rig: _Rig, share: float, frames: int) -> CutoffRow:
    rig.begin(CUTOFF_EXPERIMENT)
    milliseconds, alike = 0.0, []
    looked_at = set(np.linspace(1, frames - 1, min(frames - 1, 10)).round().astype(int).tolist())
    for number, picture in enumerate(rig.scene.frames(CUTOFF_EXPERIMENT, frames)):
        milliseconds += rig.ordered(picture, share if number else 1.0).wall_ms
        if number in looked_at:
            rig.linear(picture)
            alike.append(psnr_db(*rig.pictures()))
    return CutoffRow(100 * share, milliseconds / 1e3, _finite(alike[-1]), _finite(min(alike)))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _average(sums: moderngl.Texture) -> FloatArray:
    """Weighted light over weights."""
    array = np.frombuffer(sums.read(), np.float32).reshape(sums.height, sums.width, 4)
    return np.asarray(array[..., :3] / np.maximum(array[..., 3:], 1e-12))


def _goals(rows: Sequence[ExperimentRow]) -> list[Goal]:
    """Goals of the experiments that do not depend on the star's size; `_size_lines` say where the others' factors are met."""
    wanted = {one.name: one.goal or 0.0 for one in EXPERIMENTS if one not in SIZED_EXPERIMENTS}
    goals = [
        Goal(
            f"{row.title}, {row.size}x{row.size}: times faster than linear, at least",
            wanted[row.name],
            row.speedup,
            row.speedup >= wanted[row.name],
        )
        for row in rows
        if row.name in wanted
    ]
    apart = max(row.most_apart for row in rows)
    return [*goals, Goal("all changes made, most apart from linear, at most", GOAL_EQUAL, apart, apart <= GOAL_EQUAL)]


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON and the plot.

    Args:
        arguments: as `render.lab.bench.importance.plan.add_arguments` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    plan = plan_from_arguments(arguments)
    check_file(arguments.json)
    if arguments.plot is not None:
        check_writable(arguments.plot)
    bench = measure(plan)
    if arguments.plot is not None:
        from render.lab.bench.importance.plot import draw_cutoff  # takes a second to import

        write_atomic(Path(arguments.plot), draw_cutoff(bench))
    say(bench, report(bench), arguments.json)


def report(bench: ImportanceBench) -> str:
    """The tables."""
    lines = [
        f"{bench.device}; a radius that changes by less than {bench.step_px:g} px is none",
        "Seconds of all frames by the wall's clock, and in brackets by the processor's, of all threads. The linear method is",
        "measured on so many frames, and scaled from them. Times: of speed, by the processor's clock where it does the work.",
        "",
        "experiment  size     linear (cpu)  frames     importance (cpu)    none   times  after the first  changed  most apart",
    ]
    for row in bench.experiments:
        linear = f"{row.linear_s:8.1f} {f'({row.linear_cpu_s:.1f})':>9}  {row.linear_frames:4}"
        ordered = f"{row.importance_s:8.1f} {f'({row.importance_cpu_s:.1f})':>9}  {row.none_s:6.1f}"
        times = f"{row.speedup:6.1f}  {row.speedup_without_first:15.1f}"
        lines.append(
            f"{row.name:10}  {row.size:4}  {linear}   {ordered}  {times}  {100 * row.changed:5.1f} %  {row.most_apart:10.1g}"
        )
    lines += _size_lines(bench.sizes)
    lines += ["", "changes made    seconds   last frame's PSNR dB   the worst frame's"]
    for cut in bench.cutoff:
        alike = (f"{psnr:.1f}" if psnr is not None else "equal" for psnr in (cut.psnr_db, cut.worst_psnr_db))
        lines.append(f"{cut.m:10.0f} %  {cut.seconds:9.2f}   {next(alike):>20}   {next(alike):>17}")
    lines += ["", *goal_lines(bench.goals)]
    return "\n".join(lines) + "\n"


def _size_lines(sizes: Sequence[SizesRow]) -> Iterator[str]:
    """Speed-ups over the sizes that Fearing leaves open, and where they reach his."""
    yield ""
    yield "The first two experiments over the star's radius and the film's width, which Fearing does not tell: times, + where"
    yield "they reach his. The star's width as it begins is a share of the picture's; blur is the largest radius."
    for one in SIZED_EXPERIMENTS:
        rows = [row for row in sizes if row.name == one.name]
        films = sorted({row.film_mm for row in rows})
        met = [row for row in rows if row.meets]
        yield ""
        blur = ", ".join(f"{max(row.blur_px for row in rows if row.film_mm == film):.0f}" for film in films)
        yield f"{one.title}: {one.goal:g} times, met at {len(met)} of {len(rows)} sizes; blur {blur} px"
        yield "star mm   " + "".join(f"{f'film {film:g} mm':>22}" for film in films)
        for radius_mm in sorted({row.star_radius_mm for row in rows}):
            cells = sorted((row for row in rows if row.star_radius_mm == radius_mm), key=lambda row: row.film_mm)
            text = (f"{row.speedup:.1f}{'+' if row.meets else ' '} (star {row.star_share:.0%})" for row in cells)
            yield f"{radius_mm:7g}   " + "".join(f"{cell:>22}" for cell in text)
