"""Time of FLAG and of the naive gather over the blur's radius: the same picture, blur shape and context.

Moersch & Hamilton 2014, section 4 and figure 9.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.lab.bench.clock import Repeats, Spent, time_work
from render.lab.bench.postblur.plan import PostBlurPlan
from render.model.arrays import FloatArray
from render.model.lens import IrisShape
from render.postblur.blur_shape import make_blur_shape
from render.postblur.flag import Flag, flag_bytes
from render.postblur.gather import Gather
from render.postblur.point_spread import Field

SLOW = Repeats(1, most=3)
"""Repetitions of the naive gather."""
EXPONENTS = np.arange(0.2, 3.2, 0.01)
"""Exponents of growth that are tried."""


@dataclass(frozen=True)
class Growth:
    """Time against radius over one picture. Milliseconds.

    Attributes:
        flag_ms: wall time of FLAG at each radius.
        flag_cpu_ms: by the processor's, of all threads.
        naive_ms: of the naive gather.
        naive_cpu_ms: likewise.
        flag_exponent: of the radius that FLAG's time grows with.
        naive_exponent: likewise.
        ahead: speed of FLAG over the naive gather at each radius.
        crossover_px: radius from which on FLAG is ahead, the smallest measured or between two; None where it is not at the
            largest.
    """

    flag_ms: list[float]
    flag_cpu_ms: list[float]
    naive_ms: list[float]
    naive_cpu_ms: list[float]
    flag_exponent: float
    naive_exponent: float
    ahead: list[float]
    crossover_px: float | None


def memory_mb(plan: PostBlurPlan) -> list[float]:
    """Megabytes (10⁶) that FLAG holds at each radius beside the picture."""
    return [flag_bytes((plan.side, plan.side), radius, two_sided=False) / 1e6 for radius in plan.radii]


def growth(ctx: moderngl.Context, plan: PostBlurPlan, *, mixed: bool, by_processor: bool) -> Growth:
    """Measure both at every radius.

    Args:
        ctx: a context.
        plan: sizes, radii and repetitions.
        mixed: radii that change over the picture, from 0 to the largest, in place of one.
        by_processor: judge by the processor's clock, which does the work.
    """
    programs = ProgramCache(ctx)
    blurs = Flag(ctx, programs), Gather(ctx, programs)
    spent = [_spent(ctx, blurs, plan, float(radius), mixed=mixed) for radius in plan.radii]
    return fit_growth(plan, spent, by_processor=by_processor)


def _spent(
    ctx: moderngl.Context, blurs: tuple[Flag, Gather], plan: PostBlurPlan, radius_px: float, *, mixed: bool
) -> tuple[Spent, Spent]:
    """Time of FLAG and of the naive gather at one radius."""
    shape = make_blur_shape(IrisShape(), behind=True)
    with Resources() as scope:
        field, target = _picture(ctx, scope, plan.side, radius_px, mixed=mixed)
        flag, gather = (partial(by.blur, field, shape, radius_px, target) for by in blurs)
        flag()  # compiles; a driver may do so for a size that it has not met
        if radius_px == plan.radii[0]:
            gather()
        return time_work(ctx.finish, flag, plan.repeats), time_work(ctx.finish, gather, SLOW)


def fit_growth(plan: PostBlurPlan, spent: Sequence[tuple[Spent, Spent]], *, by_processor: bool) -> Growth:
    """Growth of the times of FLAG and of the naive gather, measured at each of the plan's radii."""
    flag, naive = ([pair[i] for pair in spent] for i in (0, 1))
    times = [[one.cpu_ms if by_processor else one.wall_ms for one in side] for side in (flag, naive)]
    exponents = [exponent(plan.radii, side) for side in times]
    return Growth(
        flag_ms=[one.wall_ms for one in flag],
        flag_cpu_ms=[one.cpu_ms for one in flag],
        naive_ms=[one.wall_ms for one in naive],
        naive_cpu_ms=[one.cpu_ms for one in naive],
        flag_exponent=exponents[0],
        naive_exponent=exponents[1],
        ahead=[slow / fast for fast, slow in zip(*times, strict=True)],
        crossover_px=crossover(plan.radii, *times),
    )


def exponent(radii: Sequence[float], times: Sequence[float]) -> float:
    """The power of the radius that a time grows with: e of the c + k·rᵉ whose relative errors are least.

    Args:
        radii: three or more.
        times: at each, above 0; c and k are not below 0.
    """
    r, t = np.asarray(radii, np.float64), np.asarray(times, np.float64)
    best, found = math.inf, 0.0
    for power in EXPONENTS:
        both = np.stack([1 / t, r**power / t], axis=1)
        for terms in (both, both[:, 1:]):  # with c, and without it where it would be below 0
            weights = np.linalg.lstsq(terms, np.ones_like(t), rcond=None)[0]
            error = float(np.sum((terms @ weights - 1) ** 2))
            if weights.min() >= 0 and error < best:
                best, found = error, float(power)
    return found


def crossover(radii: Sequence[float], fast: Sequence[float], slow: Sequence[float]) -> float | None:
    """Radius from which the first is faster, between two measured ones or the smallest; None where it is slower at the
    largest.
    """
    lead = np.log(np.asarray(slow) / np.asarray(fast))
    behind = np.flatnonzero(lead <= 0)
    if not len(behind):
        return float(radii[0])
    last = int(behind[-1])
    if last == len(lead) - 1:
        return None
    return float(np.exp(np.interp(0.0, lead[last : last + 2], np.log(np.asarray(radii, float)[last : last + 2]))))


def _picture(
    ctx: moderngl.Context, scope: Resources, side: int, radius_px: float, *, mixed: bool
) -> tuple[Field, moderngl.Texture]:
    """Field of noise, out of focus everywhere, and the target of its blur."""
    light = np.random.default_rng(0).random((side, side, 4)).astype(np.float32)
    light[..., 3] = 1
    radii = np.full((side, side), radius_px) * (_waves(side) if mixed else 1.0)
    both = np.stack([radii, radii], axis=-1).astype("f4")
    field = Field(
        scope.keep(ctx.texture((side, side), 4, light.tobytes(), dtype="f4")),
        scope.keep(ctx.texture((side, side), 2, both.tobytes(), dtype="f4")),
        0,
    )
    return field, scope.keep(ctx.texture((side, side), 4, dtype="f4"))


def _waves(side: int) -> FloatArray:
    """Shares from 0 to 1, alike at every radius."""
    y, x = np.mgrid[0:side, 0:side] / side
    waves: FloatArray = (0.5 + 0.5 * np.sin(9 * x + 2 * y) * np.cos(7 * y - x)).astype(np.float32)
    return waves
