"""Plan of the quality bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

from render.errors import SettingsError
from render.lab.bench.demo_plan import add_before_argument, check_before
from render.model.limits import MAX_RAYS, check_picture_size

WIDTH, GOAL_RAYS, UNLIT_GOAL_RAYS = 480, 100, 256
GOAL_SUBJECT = "demo_64"
GLASS = "planar_50"
GLASS_FRAME, GLASS_WIDTH, GLASS_RAYS = 64, 160, 96
"""Frame, width and rays of the comparison with the ray-by-ray reference, which is slow: a minute for some million rays."""
VIEWS, NOISE_RAYS = 1024, 4096
DEMO_FRAMES = (40, 64, 88)
UNLIT = ("bars", "lights", "thicket")
GENERATED = ("town", "statues", "dragons")
SUBJECTS = (
    *(f"demo_{frame}" for frame in DEMO_FRAMES),
    *(f"demo_{frame}_{GLASS}" for frame in DEMO_FRAMES),
    *GENERATED,
    *UNLIT,
    f"glass_{GLASS_FRAME}",
)


@dataclass(frozen=True)
class QualityPlan:
    """Plan of the measurements.

    Attributes:
        subjects: names from `SUBJECTS`.
        width: pictures of the demo shot and of lit scenes are so wide; unlit scenes are as much larger as 640 is than 480.
        rays: rays per pixel of each row.
        noise_rays: rays of the picture that noise is measured against.
        views: of the accumulation buffer for converged pictures.
        glass_rays: of the ray-by-ray reference.
        repeats: each picture is drawn so many times, for the median of its time.
        references: folder that keeps converged pictures; None for a temporary one.
        before: another checkout to compare with.
        pictures: folder for pictures as PNG.
    """

    subjects: tuple[str, ...] = SUBJECTS
    width: int = WIDTH
    rays: tuple[int, ...] = (25, 64, 100, 256)
    noise_rays: int = NOISE_RAYS
    views: int = VIEWS
    glass_rays: int = GLASS_RAYS
    repeats: int = 3
    references: Path | None = None
    before: Path | None = None
    pictures: Path | None = None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument("--quick", action="store_true", help="small pictures and few rays: does it all work")
    parser.add_argument(
        "--scene",
        metavar="NAME",
        choices=SUBJECTS,
        action="append",
        help=f"one of {', '.join(SUBJECTS)}, and may be given again; without it all",
    )
    parser.add_argument("--width", metavar="PX", type=int, help=f"of the pictures; without it {WIDTH}")
    parser.add_argument("--rays", metavar="N,N", help="rays per pixel of the rows; without it 25,64,100,256")
    parser.add_argument(
        "--noise-rays", metavar="N", type=int, help=f"of the pictures that noise is against; without it {NOISE_RAYS}"
    )
    parser.add_argument("--views", metavar="N", type=int, help=f"of the converged pictures; without it {VIEWS}")
    parser.add_argument(
        "--references",
        metavar="FOLDER",
        type=Path,
        help="keep converged pictures there, and go on with those that it has",
    )
    add_before_argument(parser)
    parser.add_argument("--pictures", metavar="FOLDER", type=Path, help=f"write the pictures of {GOAL_RAYS} rays there")


def plan_from_arguments(arguments: argparse.Namespace) -> QualityPlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: one is out of range, or the checkout to compare with is none.
    """
    plan = QUICK if arguments.quick else QualityPlan()
    width = plan.width if arguments.width is None else arguments.width
    check_picture_size(width, max(1, round(width * 9 / 16)))
    views = _samples("--views", arguments.views, plan.views)
    noise_rays = _samples("--noise-rays", arguments.noise_rays, plan.noise_rays)
    check_before(arguments)
    return QualityPlan(
        tuple(arguments.scene or plan.subjects),
        width,
        plan.rays if arguments.rays is None else _rays(arguments.rays),
        noise_rays,
        views,
        plan.glass_rays,
        plan.repeats,
        arguments.references,
        arguments.before,
        arguments.pictures,
    )


QUICK = QualityPlan(width=64, rays=(4, 16), noise_rays=64, views=8, glass_rays=4, repeats=1)


def _samples(name: str, typed: int | None, default: int) -> int:
    count = default if typed is None else typed
    if not 2 <= count <= MAX_RAYS:
        raise SettingsError(f"{name} must be from 2 to {MAX_RAYS}, got {count}")
    return count


def _rays(typed: str) -> tuple[int, ...]:
    try:
        rays = tuple(int(count) for count in typed.split(","))
    except ValueError:
        rays = ()
    if not rays or not all(1 <= count <= MAX_RAYS for count in rays):
        raise SettingsError(f"--rays must be whole numbers from 1 to {MAX_RAYS}, as 25,100; got {typed!r}")
    return rays
