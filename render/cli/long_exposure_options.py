"""The options of `record` that take one picture over many frames, and how that goes."""

from __future__ import annotations

import argparse
import math
import time as clock
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from render.cli.camera_options import Viewed
from render.cli.report import FrameProgress, say
from render.errors import SettingsError
from render.film import GradeChoice
from render.model.frame_settings import FrameSettings
from render.model.shutter_intervals import MAX_ND_STOPS, ShutterInterval, parse_shutter_intervals
from render.output import write_frame
from render.pictures.long_exposure import LongExposure, LongExposureState
from render.shot import Shot

KEEPS_EXPOSURE = "auto"


@dataclass(frozen=True)
class LongExposureWish:
    """What is asked for.

    Attributes:
        openings: when the shutter is open.
        nd_stops: of a neutral density filter; None for one that keeps the exposure.
    """

    openings: tuple[ShutterInterval, ...]
    nd_stops: float | None = None

    @property
    def begin(self) -> float:
        """When the shutter opens first."""
        return self.openings[0].first

    @property
    def intervals(self) -> list[tuple[float, float]]:
        """Begin and end of each interval of all openings."""
        return [interval for opening in self.openings for interval in opening.intervals()]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare them, for `asked_long_exposure`."""
    group = parser.add_argument_group("a long exposure")
    group.add_argument(
        "--long-exposure",
        metavar="FIRST:LAST",
        help="one picture, whose shutter opens at frame FIRST and closes at frame LAST; 1:25,49:73 opens it twice, 1:241x2 looks"
        " at two frames at a time. --rays are those of each frame; without --motion it is looked at so often that no trail"
        " has gaps. Ctrl-C closes the shutter and writes what is exposed",
    )
    group.add_argument(
        "--nd",
        metavar="STOPS",
        default=KEEPS_EXPOSURE,
        help="of a neutral density filter for the long exposure; auto takes what keeps the exposure of a single frame, 0 is none",
    )


def asked_long_exposure(arguments: argparse.Namespace) -> LongExposureWish | None:
    """What the options ask for, if anything.

    Args:
        arguments: as `add_arguments` declares them, and ``frames``.

    Raises:
        SettingsError: they cannot be read, or do not go together.
    """
    if arguments.long_exposure is None:
        if arguments.nd != KEEPS_EXPOSURE:
            raise SettingsError("--nd is of a long exposure: it needs --long-exposure")
        return None
    if arguments.frames is not None:
        raise SettingsError("--long-exposure says itself which frames it takes: leave out --frames")
    return LongExposureWish(tuple(parse_shutter_intervals(arguments.long_exposure)), _stops(arguments.nd))


def _stops(typed: str) -> float | None:
    if typed == KEEPS_EXPOSURE:
        return None
    try:
        stops = float(typed)
    except ValueError:
        stops = math.nan
    if not 0 <= stops <= MAX_ND_STOPS:
        raise SettingsError(f"--nd takes a number of stops from 0 to {MAX_ND_STOPS} or {KEEPS_EXPOSURE}, got {typed!r}")
    return stops


def record_long_exposure(
    shot: Shot,
    camera: str | None,
    wish: LongExposureWish,
    file: Path,
    settings: FrameSettings,
    stock: str | None,
    grade: GradeChoice | None,
    viewed: Viewed,
) -> list[dict[str, Any]]:
    """Expose and write the picture; what was written, for --json.

    Args:
        shot: the shot.
        camera: prim path; None for one that frames the whole stage.
        wish: when the shutter is open.
        file: to write.
        settings: how each interval is rendered.
        stock: a film of the library, or None for the shot's own.
        grade: what is wanted in place of the shot's own.
        viewed: what is drawn over a graded picture.

    Raises:
        KeyboardInterrupt: it was stopped; what had been exposed till then is written.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: not before the shot is found good

    began = clock.perf_counter()
    intervals = wish.intervals
    with FrameRenderer() as renderer, FrameProgress(len(intervals)) as progress:
        exposure = LongExposure(
            renderer, shot, camera, wish.begin, settings, nd_stops=wish.nd_stops, stock=stock, choice=grade
        )
        try:
            for begin, end in intervals:
                from_here = clock.perf_counter()
                progress.begin(f"frame {begin:g}")
                exposure.expose(begin, end, progress.within)
                progress.finish(f"exposed to frame {end:g}", clock.perf_counter() - from_here)
        except KeyboardInterrupt:
            if exposure.state.intervals:
                _write(exposure, file, viewed)
                say(f"stopped: {file} holds {_words(exposure.state)} of the exposure")
            raise
        _write(exposure, file, viewed)
        state = exposure.state
    say(f"{file}: {_words(state)} with {state.nd_stops:.1f} stops of neutral density")
    seconds = round(clock.perf_counter() - began, 3)
    return [{"time": wish.begin, "file": str(file), "seconds": seconds, "longExposure": _as_json(state)}]


def _write(exposure: LongExposure, file: Path, viewed: Viewed) -> None:
    picture = exposure.picture()
    write_frame(file, picture.frame, viewed(picture.graded, picture.camera), picture.metadata)


def _words(state: LongExposureState) -> str:
    return f"{state.open_seconds:.4g} s ({state.open_frames:g} frame{'' if state.open_frames == 1 else 's'})"


def _as_json(state: LongExposureState) -> dict[str, Any]:
    return {
        "openFrames": state.open_frames,
        "openSeconds": state.open_seconds,
        "intervals": state.intervals,
        "ndStops": state.nd_stops,
    }
