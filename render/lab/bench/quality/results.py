"""Results of the quality bench, and its table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from render.lab.bench.progress import goal_lines
from render.lab.bench.quality.plan import GOAL_RAYS, GOAL_SUBJECT, UNLIT, UNLIT_GOAL_RAYS, WIDTH
from render.lab.bench.results import Goal

NOISE_DB, BIAS_DB, TIMES_AS_LONG, UNLIT_GAIN_DB = 42.0, 36.0, 1.2, 3.0


@dataclass(frozen=True)
class Likeness:
    """Likeness of a picture to a reference; None where there is no reference, or the pictures are equal.

    Attributes:
        psnr_db: of pictures clipped to [0, 1] and encoded by the sRGB curve.
        ssim: likewise.
        flip: mean LDR FLIP.
        worst_share: share of the squared error that is in the worst 1 % of the pixels.
    """

    psnr_db: float | None
    ssim: float | None
    flip: float | None
    worst_share: float | None


NOTHING = Likeness(None, None, None, None)


@dataclass(frozen=True)
class QualityRow:
    """A picture.

    Attributes:
        subject: name of the scene, or frame of the demo shot.
        checkout: ``before`` or ``after``.
        width: of the picture in pixels.
        height: of it.
        rays: per pixel.
        noise: likeness to the picture of many rays by the same code.
        bias: likeness to the converged picture, so that it counts noise too.
        seconds: wall time, median.
        cpu_s: processor time of all threads, median.
        kept_s: wall time where layers are kept from before: the share that is not peeling.
    """

    subject: str
    checkout: str
    width: int
    height: int
    rays: int
    noise: Likeness
    bias: Likeness
    seconds: float
    cpu_s: float
    kept_s: float


@dataclass(frozen=True)
class ReferenceRow:
    """A converged picture.

    Attributes:
        subject: name of the scene.
        samples: views or rays.
        halves_psnr_db: PSNR of one half of them against the other.
    """

    subject: str
    samples: int
    halves_psnr_db: float | None


@dataclass(frozen=True)
class QualityBench:
    """Results of the quality bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        noise_rays: rays of the pictures that noise is measured against.
        rows: pictures.
        references: converged pictures.
        goals: goals and whether they are met; only those whose subjects were measured at the size of the goals.
    """

    device: str
    noise_rays: int
    rows: list[QualityRow]
    references: list[ReferenceRow]
    goals: list[Goal]


def judge(rows: Sequence[QualityRow]) -> list[Goal]:
    """Goals with their measured values."""
    found = {(row.subject, row.checkout, row.rays): row for row in rows}
    goals: list[Goal] = []
    after, before = (found.get((GOAL_SUBJECT, which, GOAL_RAYS)) for which in ("after", "before"))
    if after is not None and after.width == WIDTH:
        goals += _at_least(f"{GOAL_SUBJECT}, {GOAL_RAYS} rays: noise in dB", NOISE_DB, after.noise.psnr_db)
        goals += _at_least(f"{GOAL_SUBJECT}, {GOAL_RAYS} rays: bias in dB", BIAS_DB, after.bias.psnr_db)
        if before is not None:
            name = f"{GOAL_SUBJECT}, {GOAL_RAYS} rays: times as long as before"
            goals += _at_most(f"{name}, wall time", TIMES_AS_LONG, after.seconds / before.seconds)
            goals += _at_most(f"{name}, processor time", TIMES_AS_LONG, after.cpu_s / before.cpu_s)
    for name in UNLIT:
        after, before = (found.get((name, which, UNLIT_GOAL_RAYS)) for which in ("after", "before"))
        if after is None or before is None or after.width != round(WIDTH * 640 / 480):
            continue
        if after.bias.psnr_db is not None and before.bias.psnr_db is not None:
            gain = after.bias.psnr_db - before.bias.psnr_db
            goals += _at_least(f"{name}, {UNLIT_GOAL_RAYS} rays: dB gained", UNLIT_GAIN_DB, gain)
    return goals


def report(bench: QualityBench) -> str:
    """The table."""
    return "\n".join([*_head(bench), *map(_line, bench.rows), *_references(bench), "", *goal_lines(bench.goals)]) + "\n"


def _head(bench: QualityBench) -> Iterator[str]:
    yield f"{bench.device}; noise is against {bench.noise_rays} rays, bias against converged pictures"
    yield "Pictures are clipped to [0, 1] and encoded by the sRGB curve. Worst: share of squared error in the worst 1 % of pixels"
    yield "Seconds by the wall's clock, in brackets by the processor's, of all threads; kept: with the layers of before."
    yield ""
    yield (
        f"{'subject':20} {'size':>9} {'rays':>5} {'code':>7}   {'noise dB':>8} {'SSIM':>6} {'FLIP':>6} {'worst':>5}"
        f"   {'bias dB':>8} {'SSIM':>6} {'FLIP':>6} {'worst':>5}   {'seconds':>15} {'kept':>6}"
    )


def _line(row: QualityRow) -> str:
    seconds = f"{row.seconds:.2f} ({row.cpu_s:.2f})"
    return (
        f"{row.subject:20} {f'{row.width}x{row.height}':>9} {row.rays:5} {row.checkout:>7}   {_likeness(row.noise)}"
        f"   {_likeness(row.bias)}   {seconds:>15} {row.kept_s:6.2f}"
    )


def _likeness(like: Likeness) -> str:
    if like.psnr_db is None:
        return f"{'equal' if like.ssim is not None else '-':>8} {'':6} {'':6} {'':5}"
    return f"{like.psnr_db:8.2f} {like.ssim:6.4f} {like.flip:6.4f} {like.worst_share:5.0%}"


def _references(bench: QualityBench) -> Iterator[str]:
    yield ""
    for row in bench.references:
        halves = (
            "-"
            if row.halves_psnr_db is None
            else f"{row.halves_psnr_db:.1f} dB, so its own noise is at some {row.halves_psnr_db + 6:.0f} dB"
        )
        yield f"{row.subject:20} converged from {row.samples} samples; one half of them against the other {halves}"


def _at_most(goal: str, want: float, got: float) -> list[Goal]:
    return [Goal(f"{goal}, at most", want, got, got <= want)]


def _at_least(goal: str, want: float, got: float | None) -> list[Goal]:
    return [] if got is None else [Goal(f"{goal}, at least", want, got, got >= want)]
