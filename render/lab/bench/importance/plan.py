"""Plan of the importance bench, and its arguments. Imports no OpenGL, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

from render.errors import SettingsError

MOST_LINEAR_PX = 7 * 1024 * 1024
"""Pixels of an experiment's frames that the linear method is measured on at most: of larger ones some frames stand for all."""
LEAST_SIZE, MOST_SIZE, MOST_FRAMES = 32, 2048, 10_000


@dataclass(frozen=True)
class Plan:
    """Plan of the measurements.

    Attributes:
        sizes: sides of the pictures in pixels; the cutoff is measured at the first.
        frames: frames of each experiment.
        shares: shares of the changes that are spread, Fearing's M.
        star_radii_mm: sizes of the star for the experiments whose speed-up depends on it, at the first size of the pictures.
        films_mm: widths of the film for these.
        linear_share: share of the frames on which the linear method is measured there.
    """

    sizes: tuple[int, ...] = (256, 1024)
    frames: int = 100
    shares: tuple[float, ...] = (0.05, 0.1, 0.15, 0.25, 0.5, 0.75, 1.0)
    star_radii_mm: tuple[float, ...] = (1.75, 2.5, 3.5, 5.0, 7.0)
    films_mm: tuple[float, ...] = (5.0, 7.0, 10.0, 14.0)
    linear_share: float = 0.1

    def linear_frames(self, size: int) -> int:
        """Number of frames on which an experiment's linear method is measured, at least two where there are more."""
        return min(self.frames, max(MOST_LINEAR_PX // size**2, 2))


QUICK = Plan((64,), 5, (0.25, 1.0), star_radii_mm=(2.5, 5.0), films_mm=(7.0,), linear_share=0.5)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument("--plot", metavar="FILE.png", help="draw quality and time against the share of changes made")
    parser.add_argument("--quick", action="store_true", help="small pictures and few of them: does it all work")
    parser.add_argument("--frames", metavar="N", type=int, help=f"of each experiment; without it {Plan().frames}")
    parser.add_argument("--sizes", metavar="N,N", help="pixels along each side of the pictures; without it 256,1024")


def plan_from_arguments(arguments: argparse.Namespace) -> Plan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: one is out of range.
    """
    plan = QUICK if arguments.quick else Plan()
    frames = plan.frames if arguments.frames is None else arguments.frames
    if not 2 <= frames <= MOST_FRAMES:
        raise SettingsError(f"--frames must be from 2 to {MOST_FRAMES}, got {frames}")
    sizes = plan.sizes if arguments.sizes is None else _sizes(arguments.sizes)
    return replace(plan, sizes=sizes, frames=frames)


def _sizes(typed: str) -> tuple[int, ...]:
    try:
        sizes = tuple(int(size) for size in typed.split(","))
    except ValueError:
        sizes = ()
    if not sizes or not all(LEAST_SIZE <= size <= MOST_SIZE for size in sizes):
        raise SettingsError(
            f"--sizes must be whole numbers from {LEAST_SIZE} to {MOST_SIZE}, as 256,1024; got {typed!r}"
        )
    return sizes
