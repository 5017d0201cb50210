"""Goals of the lens engine and their measured values. The comparison in wall time is the goal."""

from __future__ import annotations

from collections.abc import Iterator

from render.lab.bench.results import Goal, LensBench, SceneRow, Sweeps

RATIO_ON_CPU, RATIO_ON_GPU = 8.0, 15.0
PSNR_DB, SSIM = 47.0, 0.995
MANY_SURFACES, MANY_OVER_THIN = 13, 1.25
SECOND_FOUR_SHARE = 0.40
LAYERS_MB = 64.0


def judge(bench: LensBench) -> list[Goal]:
    """Goals with their measured values."""
    ratio = RATIO_ON_CPU if bench.software else RATIO_ON_GPU
    goals = [goal for row in bench.scenes for goal in _of_scene(row, ratio)]
    goals += _of_sweeps(bench.sweeps)
    return [*goals, _at_most("megabytes of four layers of 1024x768", LAYERS_MB, bench.layers_mb_1024x768)]


def _of_scene(row: SceneRow, ratio: float) -> Iterator[Goal]:
    yield _at_least(f"{row.name}: times faster than the reference", ratio, row.ratio)
    yield _at_least(f"{row.name}: PSNR in dB", PSNR_DB, row.psnr_db)
    yield _at_least(f"{row.name}: SSIM", SSIM, row.ssim)


def _of_sweeps(sweeps: Sweeps) -> Iterator[Goal]:
    for row in sweeps.surfaces:
        if row.surfaces == MANY_SURFACES and not row.disperses:
            yield _at_most(f"tracing {MANY_SURFACES} surfaces over the ideal lens", MANY_OVER_THIN, row.trace_over_thin)
    by_count = {row.layers: row.trace_ms for row in sweeps.layers}
    if 4 in by_count and 8 in by_count:
        share = 1 - by_count[4] / by_count[8]
        yield _at_most("share of tracing that the second four of eight layers take", SECOND_FOUR_SHARE, share)


def _at_least(goal: str, want: float, got: float) -> Goal:
    return Goal(f"{goal}, at least", want, got, got >= want)


def _at_most(goal: str, want: float, got: float) -> Goal:
    return Goal(f"{goal}, at most", want, got, got <= want)
