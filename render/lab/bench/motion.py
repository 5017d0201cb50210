"""Motion bench: cost of motion by velocities and by peeling every moment, on the demo shot, and their difference.

pullfocus bench motion
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from render.demo.shot import write_demo
from render.frame import Frame, FrameRenderer
from render.lab.bench.clock import Repeats, Spent, time_work
from render.lab.bench.motion_plan import COUNTS, FRAME, asked_picture
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.lab.reference.metrics import psnr_db, ssim
from render.model.arrays import FloatArray
from render.model.frame_settings import FrameSettings
from render.pictures.picture import expose_frame
from render.shot import Shot

GOAL_RATIO, GOAL_PSNR = 4.0, 35.0
REPEATS = Repeats(3, most=3)


@dataclass(frozen=True)
class MotionRow:
    """One way to take a moving picture. Milliseconds.

    Attributes:
        way: ``still``, ``velocities`` or ``moments``.
        moments: of the shutter's opening.
        ms: reading the scene, peeling and tracing, wall time.
        cpu_ms: by the processor's, of all threads.
        ratio: over the still frame's: by the processor's clock where it does the work, which then counts no other work of a busy
            machine; by the wall's where a graphics device does.
        psnr_db: against as many moments, each peeled; for the still, against the velocities' reference.
        ssim: the same comparison.
    """

    way: str
    moments: int
    ms: float
    cpu_ms: float
    ratio: float
    psnr_db: float | None
    ssim: float | None


@dataclass(frozen=True)
class MotionBench:
    """Results of the motion bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        width: picture width in pixels.
        height: picture height in pixels.
        rays: rays per pixel, over all moments.
        rows: the ways.
        goals: goals and whether they are met.
    """

    device: str
    width: int
    height: int
    rays: int
    rows: list[MotionRow]
    goals: list[Goal]


class _MotionRig:
    """The demo shot with a renderer."""

    def __init__(self, renderer: FrameRenderer, folder: Path, picture: FrameSettings) -> None:
        self._renderer, self._picture = renderer, picture
        self._shot = Shot.open(write_demo(folder))
        self._lens = self._shot.camera_at(None, FRAME, picture.width, picture.height)

    def trace(self, repeats: Repeats, **changes: object) -> tuple[FloatArray, Spent]:
        """Render and expose a picture, and return its cost; nothing but uploads is kept from the one before."""
        settings = replace(self._picture, **changes)  # type: ignore[arg-type]
        frames: list[Frame] = []

        def take() -> None:
            self._shot.scene_at(FRAME - 1)
            frames.append(expose_frame(self._renderer, self._shot, None, self._lens, FRAME, settings))

        spent = time_work(self._renderer.graphics.ctx.finish, take, repeats)
        return frames[-1].color * self._lens.exposure_scale, spent


def measure(picture: FrameSettings, repeats: Repeats, counts: Sequence[int]) -> MotionBench:
    """Measure everything on the demo shot.

    Args:
        picture: its moments are those that are peeled one by one too.
        repeats: of what is not.
        counts: of moments, for velocities; the picture's among them.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    with tempfile.TemporaryDirectory() as folder, FrameRenderer() as renderer:
        rig = _MotionRig(renderer, Path(folder), picture)
        for way in ("moments", "velocities"):  # compiles shaders, and sends the scene
            rig.trace(Repeats(1, 1), rays=8, motion=2, motion_by=way)
        still_picture, still = rig.trace(repeats, motion=1)
        rows = []
        for count in counts:
            exact, exact_spent = rig.trace(Repeats(1, 1), motion=count) if count == picture.motion else (None, None)
            fast, spent = rig.trace(repeats, motion=count, motion_by="velocities")
            rows.append(_row("velocities", count, spent, still, fast, exact))
            if exact is not None and exact_spent is not None:
                rows.append(_row("moments", count, exact_spent, still, None, None))
                rows.insert(0, _row("still", 1, still, still, still_picture, exact))
        device = renderer.graphics.renderer
        if not renderer.graphics.is_software:
            rows = [replace(row, ratio=row.ms / still.wall_ms) for row in rows]
    return MotionBench(device, picture.width, picture.height, picture.rays, rows, _goals(rows, picture.motion))


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.motion_plan.add_arguments` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    picture = asked_picture(arguments)
    result = measure(picture, *((Repeats(1, 1), (picture.motion,)) if arguments.quick else (REPEATS, COUNTS)))
    say(result, report(result), arguments.json)


def report(result: MotionBench) -> str:
    """The table."""
    lines = [
        f"{result.device}; the demo shot's frame {FRAME}, {result.width}x{result.height}, {result.rays} rays over all moments",
        "Milliseconds by the wall's clock, and in brackets by the processor's, of all threads.",
        "PSNR and SSIM are against as many moments, each peeled.",
        "",
        "way         moments        ms               over the still   PSNR dB     SSIM",
    ]
    for row in result.rows:
        alike = f"{row.psnr_db:10.1f} {row.ssim:8.4f}" if row.psnr_db is not None and row.ssim is not None else ""
        lines.append(
            f"{row.way:10}  {row.moments:7}  {row.ms:8.0f} {f'({row.cpu_ms:.0f})':>9}   {row.ratio:15.2f}{alike}"
        )
    lines += ["", *goal_lines(result.goals)]
    return "\n".join(lines) + "\n"


def _row(
    way: str, moments: int, spent: Spent, still: Spent, picture: FloatArray | None, exact: FloatArray | None
) -> MotionRow:
    alike = (
        (psnr_db(picture, exact), ssim(picture, exact)) if picture is not None and exact is not None else (None, None)
    )
    return MotionRow(way, moments, spent.wall_ms, spent.cpu_ms, spent.cpu_ms / still.cpu_ms, *alike)


def _goals(rows: list[MotionRow], moments: int) -> list[Goal]:
    (row,) = (row for row in rows if row.way == "velocities" and row.moments == moments)
    alike = row.psnr_db or 0.0
    return [
        Goal(
            f"{moments} moments by velocities, over the still frame below",
            GOAL_RATIO,
            row.ratio,
            row.ratio < GOAL_RATIO,
        ),
        Goal("velocities against moments, PSNR in dB at least", GOAL_PSNR, alike, alike >= GOAL_PSNR),
    ]
