"""Plan of the page bench, and its arguments. Imports little, so that the command line starts at once."""

from __future__ import annotations

import argparse
from dataclasses import dataclass

from render.errors import SettingsError
from render.lab.bench.bench import Bench

MOST_MINUTES = 24 * 60.0
MINUTES, QUICK_MINUTES = 10.0, 0.1


@dataclass(frozen=True)
class PagePlan:
    """Plan of the measurements.

    Attributes:
        width: of the window, CSS pixels.
        height: of the window, CSS pixels.
        pixel_ratio: device pixels for each of them.
        opens: number of fresh opens, each in a browser that has nothing of the page.
        repeats: number of inputs of each kind.
        moves: number of moves in each drag of a key.
        scrub_s: time of each drag of the scrubber through the whole shot, s.
        cached_frames: number of frames that are cached and played.
        play_s: time that they play, s.
        shared_edits: number of edits that another browser has to see.
        minutes: time of random use; 0 for none.
        seed: seed of the random use.
        browser: path of a Chromium; None for the one that is found.
    """

    width: int = 1440
    height: int = 900
    pixel_ratio: float = 1.0
    opens: int = 5
    repeats: int = 10
    moves: int = 20
    scrub_s: float = 4.0
    cached_frames: int = 24
    play_s: float = 10.0
    shared_edits: int = 24
    minutes: float = MINUTES
    seed: int = 1
    browser: str | None = None

    @property
    def is_judged(self) -> bool:
        """Whether the goals, which are set for a window of 1440x900, apply."""
        return (self.width, self.height, self.pixel_ratio) == (PagePlan.width, PagePlan.height, PagePlan.pixel_ratio)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the bench's arguments."""
    parser.add_argument(
        "--json", metavar="FILE|-", help="write what was found for programs too; - in place of the table"
    )
    parser.add_argument("--quick", action="store_true", help="a small window and few inputs: does it all work")
    parser.add_argument(
        "--minutes", metavar="N", type=float, help=f"time of random use, 0 for none; without it {MINUTES:g}"
    )
    parser.add_argument("--seed", metavar="N", type=int, default=PagePlan.seed, help="of the random use")
    parser.add_argument("--browser", metavar="PATH", help="a Chromium; without it the one that is installed")


def plan_from_arguments(arguments: argparse.Namespace) -> PagePlan:
    """Plan from the command line's arguments.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the time is out of range.
    """
    minutes = arguments.minutes
    if minutes is None:
        minutes = QUICK_MINUTES if arguments.quick else MINUTES
    if not 0 <= minutes <= MOST_MINUTES:
        raise SettingsError(f"--minutes must be from 0 to {MOST_MINUTES:g}, got {minutes:g}")
    chosen = {"minutes": minutes, "seed": arguments.seed, "browser": arguments.browser}
    if not arguments.quick:
        return PagePlan(**chosen)
    return PagePlan(
        900, 560, 0.5, opens=1, repeats=2, moves=2, scrub_s=1.0, cached_frames=2, play_s=1.0, shared_edits=2, **chosen
    )


BENCH = Bench(
    "page",
    "the page in a real browser: response of its controls, drags, scrubbing, playing, opening, and memory under random use",
    add_arguments,
    "service.bench.page.run",
)
"""Found through the entry point group ``pullfocus.benches``."""
