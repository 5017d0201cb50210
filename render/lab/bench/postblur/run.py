"""The bench of single-image blurs: time and memory of FLAG and of the naive gather as the blur grows (Moersch & Hamilton 2014,
figure 9), and how near each engine comes to the lens tracer and to the accumulation buffer.

pullfocus bench postblur
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from render.errors import SettingsError
from render.files import check_writable, write_atomic
from render.frame import FrameRenderer
from render.lab.bench.postblur.plan import AHEAD_FROM, SUFFIXES, PostBlurPlan, plan_from_arguments
from render.lab.bench.postblur.quality import QualityRow, quality
from render.lab.bench.postblur.speed import Growth, growth, memory_mb
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.postblur.flag import BAND_BYTES, flag_bytes
from render.postblur.focus_split import SPLIT_PX

GOAL_LINEAR, GOAL_QUADRATIC = 1.2, 1.7
GOAL_GAIN_DB = 3.0
FULL_HD = (1920, 1080)


@dataclass(frozen=True)
class PostBlurBench:
    """Results of the single-image bench; the fields are the keys of its JSON.

    Attributes:
        device: that drew.
        side: pixels of the square picture that is blurred for time.
        clock: clock of exponents and ratios: ``processor`` where the CPU does the work, which leaves out other load of a
            busy machine; else ``wall``.
        flag_exponent: e of the c + k·rᵉ that FLAG's times follow, where all radii are alike.
        naive_exponent: the same for the naive gather.
        crossover_px: radius from which on FLAG is ahead, the smallest measured or between two; None where it is not at the
            largest.
        radii: radii of the blur in pixels.
        flag_ms: time of FLAG at each radius, by that clock.
        naive_ms: the same for the naive gather.
        memory_mb: megabytes (10⁶) that FLAG holds at each beside the picture.
        bound_mb: limit on its arrays, unless the rows that reach one stretch of rows need more.
        full_hd_mb: most memory of the engine ``flag`` for a part of a 1920x1080 picture: circles wider than it takes
            at full resolution are spread at less.
        even: all times where the radii are equal.
        mixed: all times where the radii change over the picture from 0 to the radius.
        quality: engines compared with references.
        goals: goals and whether they are met.
    """

    device: str
    side: int
    clock: str
    flag_exponent: float
    naive_exponent: float
    crossover_px: float | None
    radii: list[int]
    flag_ms: list[float]
    naive_ms: list[float]
    memory_mb: list[float]
    bound_mb: float
    full_hd_mb: float
    even: Growth
    mixed: Growth
    quality: list[QualityRow]
    goals: list[Goal]


def measure(plan: PostBlurPlan) -> PostBlurBench:
    """Measure everything.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    with FrameRenderer() as renderer:
        by_processor = renderer.graphics.is_software
        even, mixed = (
            growth(renderer.graphics.ctx, plan, mixed=mixed, by_processor=by_processor) for mixed in (False, True)
        )
        rows = list(quality(renderer, plan))
        device = renderer.graphics.renderer
    return PostBlurBench(
        device=device,
        side=plan.side,
        clock="processor" if by_processor else "wall",
        flag_exponent=even.flag_exponent,
        naive_exponent=even.naive_exponent,
        crossover_px=even.crossover_px,
        radii=list(plan.radii),
        flag_ms=even.flag_cpu_ms if by_processor else even.flag_ms,
        naive_ms=even.naive_cpu_ms if by_processor else even.naive_ms,
        memory_mb=memory_mb(plan),
        bound_mb=BAND_BYTES / 1e6,
        full_hd_mb=max(flag_bytes(FULL_HD, SPLIT_PX, two_sided=odd) for odd in (False, True)) / 1e6,
        even=even,
        mixed=mixed,
        quality=rows,
        goals=goals(plan, even, mixed, rows),
    )


def goals(plan: PostBlurPlan, even: Growth, mixed: Growth, rows: list[QualityRow]) -> list[Goal]:
    """Goals from the paper's claims, and the goal that a blurred picture is nearer to the truth than a sharp one."""
    verdicts = []
    for name, picture in (("even radii", even), ("mixed radii", mixed)):
        linear, quadratic = picture.flag_exponent, picture.naive_exponent
        verdicts += [
            Goal(f"{name}: exponent of FLAG's growth, at most", GOAL_LINEAR, linear, linear <= GOAL_LINEAR),
            Goal(
                f"{name}: exponent of the naive gather's growth, at least",
                GOAL_QUADRATIC,
                quadratic,
                quadratic >= GOAL_QUADRATIC,
            ),
        ]
        ahead = min(times for times, radius in zip(picture.ahead, plan.radii, strict=True) if radius >= AHEAD_FROM)
        verdicts.append(Goal(f"{name}: FLAG's lead at any radius from {AHEAD_FROM} px, above", 1.0, ahead, ahead > 1.0))
    gain = min(
        (row.lens_psnr_db or 0.0) - (sharp.lens_psnr_db or 0.0)
        for row in rows
        for sharp in rows
        if row.engine == "flag" and sharp.engine == "pinhole" and row.scene == sharp.scene
    )
    verdicts.append(
        Goal("FLAG nearer to the lens tracer than no blur, dB at least", GOAL_GAIN_DB, gain, gain >= GOAL_GAIN_DB)
    )
    return verdicts


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the tables on standard output, and write the JSON and the drawing.

    Args:
        arguments: as `render.lab.bench.postblur.plan.add_arguments` declares them.

    Raises:
        SettingsError: the plot's file format is unknown.
        GraphicsError: there is no device to draw on.
        OutputError: a file cannot be written.
    """
    check_file(arguments.json)
    if arguments.plot is not None:
        if Path(arguments.plot).suffix not in SUFFIXES:
            raise SettingsError(f"--plot must end in {' or '.join(SUFFIXES)}, got {arguments.plot!r}")
        check_writable(arguments.plot)
    bench = measure(plan_from_arguments(arguments))
    if arguments.plot is not None:
        write_atomic(Path(arguments.plot), draw_plot(bench, Path(arguments.plot).suffix[1:]))
    say(bench, report(bench), arguments.json)


def draw_plot(bench: PostBlurBench, suffix: str) -> bytes:
    """Time and memory against the radius, as a file."""
    from render.lab.bench.postblur.plot import draw_blur_growth  # matplotlib is slow to import

    times = {
        f"{name}, {radii} radii": getattr(side, f"{key}_{'cpu_' if bench.clock == 'processor' else ''}ms")
        for name, key in (("FLAG", "flag"), ("naive gather", "naive"))
        for radii, side in (("even", bench.even), ("mixed", bench.mixed))
    }
    title = f"{bench.device}, {bench.side}x{bench.side}, by the {bench.clock}'s clock"
    return draw_blur_growth(title, bench.radii, times, bench.memory_mb, bench.bound_mb, suffix)


def report(bench: PostBlurBench) -> str:
    """The tables."""
    lines = [
        f"{bench.device}; a picture of {bench.side}x{bench.side} blurred by a disc",
        "Milliseconds by the wall's clock, and in brackets by the processor's, of all threads. 'Ahead' is how many times faster",
        f"FLAG is, by the {bench.clock}'s clock; growth is e of the c + k·rᵉ that fits all times best.",
    ]
    for name, side in (("the same radius everywhere", bench.even), ("radii from 0 to the largest", bench.mixed)):
        lines += ["", f"{name + ':':28} radius px         FLAG               naive gather   ahead   FLAG holds MB"]
        for i, radius in enumerate(bench.radii):
            flag, naive = _spent(side.flag_ms[i], side.flag_cpu_ms[i]), _spent(side.naive_ms[i], side.naive_cpu_ms[i])
            lines.append(
                f"{'':28} {radius:9}  {flag:>17}  {naive:>19}  {side.ahead[i]:6.1f}  {bench.memory_mb[i]:14.1f}"
            )
        crossed = "nowhere" if side.crossover_px is None else f"from {side.crossover_px:.2g} px on"
        lines.append(
            f"  FLAG grows with the radius to the power of {side.flag_exponent:.2f}, the naive gather to that of "
            f"{side.naive_exponent:.2f}; FLAG is ahead {crossed}"
        )
    lines += [
        "",
        f"FLAG holds at most {bench.bound_mb:.1f} MB, unless the rows that reach 16 rows need more; the engine, which",
        f"spreads wide circles at less resolution, holds at most {bench.full_hd_mb:.1f} MB for a part of a 1920x1080 picture.",
        "",
        *_quality_lines(bench.quality),
        "",
        *goal_lines(bench.goals),
    ]
    return "\n".join(lines) + "\n"


def _quality_lines(rows: list[QualityRow]) -> list[str]:
    lines = [
        "scene       engine              ms               PSNR dB, SSIM: of the lens tracer   of the accumulation buffer"
    ]
    for row in rows:
        lens, accumulation = (
            f"{psnr:.1f} {alike:.4f}" if psnr is not None and alike is not None else ""
            for psnr, alike in (
                (row.lens_psnr_db, row.lens_ssim),
                (row.accumulation_psnr_db, row.accumulation_ssim),
            )
        )
        lines.append(
            f"{row.scene:10}  {row.engine:12}  {_spent(row.ms, row.cpu_ms):>16}  {lens:>37}   {accumulation:>26}".rstrip()
        )
    return lines


def _spent(wall_ms: float, cpu_ms: float) -> str:
    return f"{wall_ms:.0f} ({cpu_ms:.0f})"
