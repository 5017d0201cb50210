"""Options of `pullfocus record` that expose one picture over many frames."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass

from render.errors import SettingsError
from render.model.shutter_intervals import MAX_ND_STOPS, ShutterInterval, parse_shutter_intervals

AUTO_ND = "auto"


@dataclass(frozen=True)
class LongExposureOptions:
    """A long exposure.

    Attributes:
        shutter_intervals: when the shutter is open.
        nd_stops: of a neutral density filter; None for one that keeps the exposure of a single frame.
    """

    shutter_intervals: tuple[ShutterInterval, ...]
    nd_stops: float | None = None

    @property
    def begin(self) -> float:
        """USD time code at which the shutter opens first."""
        return self.shutter_intervals[0].first

    @property
    def intervals(self) -> list[tuple[float, float]]:
        """Begin and end of each interval that is rendered."""
        return [interval for shutter_interval in self.shutter_intervals for interval in shutter_interval.intervals()]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_long_exposure`."""
    group = parser.add_argument_group("a long exposure")
    group.add_argument(
        "--long-exposure",
        metavar="FIRST:LAST",
        help="one picture, whose shutter opens at frame FIRST and closes at frame LAST; 1:25,49:73 opens it twice, 1:241x2"
        " renders two frames at a time. --rays are per frame; without --motion there are as many shutter samples"
        " as trails without gaps need. Ctrl-C closes the shutter and writes the exposure so far",
    )
    group.add_argument(
        "--nd",
        metavar="STOPS",
        default=AUTO_ND,
        help="neutral density filter of the long exposure; auto keeps the exposure of a single frame, 0 is no filter",
    )


def read_long_exposure(arguments: argparse.Namespace) -> LongExposureOptions | None:
    """Read the options; None without --long-exposure.

    Args:
        arguments: as `add_arguments` declares them, and ``frames``.

    Raises:
        SettingsError: they cannot be read, or contradict each other.
    """
    if arguments.long_exposure is None:
        if arguments.nd != AUTO_ND:
            raise SettingsError("--nd is for long exposures: it needs --long-exposure")
        return None
    if arguments.frames is not None:
        raise SettingsError("--long-exposure sets its own frames: leave out --frames")
    return LongExposureOptions(tuple(parse_shutter_intervals(arguments.long_exposure)), _read_stops(arguments.nd))


def _read_stops(typed: str) -> float | None:
    if typed == AUTO_ND:
        return None
    try:
        stops = float(typed)
    except ValueError:
        stops = math.nan
    if not 0 <= stops <= MAX_ND_STOPS:
        raise SettingsError(f"--nd takes a number of stops from 0 to {MAX_ND_STOPS} or {AUTO_ND}, got {typed!r}")
    return stops
