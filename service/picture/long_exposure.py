"""What the picture process is asked for while a long exposure goes on: an interval at a time, so that others get between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from render.errors import NotFoundError
from service.picture.frames import Darkroom
from service.picture.picture_size import height_at
from service.storage.store import ShotRecord

if TYPE_CHECKING:
    from render.pictures.long_exposure import LongExposure, LongExposureState

MAX_HELD = 4
"""Exposed pictures that the process keeps; the one that was begun first is lost when there is one more."""


@dataclass(frozen=True)
class Exposed:
    """How much is on the film: as `render.pictures.long_exposure.LongExposureState`, which the process that speaks HTTP imports
    without USD."""

    open_frames: float = 0.0
    open_seconds: float = 0.0
    intervals: int = 0
    nd_stops: float = 0.0


@dataclass(frozen=True)
class BeginExposure:
    """Load the film; the shutter is closed.

    Attributes:
        key: names the exposure.
        record: of which shot.
        edits: its edit layer when it was begun; later edits are not seen.
        camera: prim path, or None for the default camera.
        begin: USD time code.
        height: pixels, or None for the film gate's shape.
        max_px: pixels of it all; more are not rendered.
        settings: the other fields of `render.frame.FrameSettings`.
        nd_stops: of a filter; None keeps the exposure.
        film: a stock of the library, or None.
    """

    key: str
    record: ShotRecord
    edits: str
    camera: str | None
    begin: float
    height: int | None
    max_px: int
    settings: dict[str, Any]
    nd_stops: float | None
    film: str | None

    def run(self, room: Darkroom) -> None:
        """Raises what `LongExposure` raises."""
        from render.frame import FrameSettings
        from render.pictures.long_exposure import LongExposure

        with room.opened.use(self.record, self.edits) as shot:
            width = self.settings["width"]
            height = self.height or height_at(shot, self.camera, self.begin, width, self.max_px, "body.width")
            settings = FrameSettings(**self.settings, height=height)
            exposure = LongExposure(
                room.renderer, shot, self.camera, self.begin, settings, nd_stops=self.nd_stops, stock=self.film
            )
        room.exposures[self.key] = exposure
        while len(room.exposures) > MAX_HELD:
            room.exposures.pop(next(iter(room.exposures)))


@dataclass(frozen=True)
class ExposeInterval:
    """Have the shutter open for an interval.

    Attributes:
        key: of the exposure.
        record: of its shot.
        edits: as when it was begun.
        begin: USD time code.
        end: likewise.
    """

    key: str
    record: ShotRecord
    edits: str
    begin: float
    end: float

    def run(self, room: Darkroom) -> Exposed:
        """Raises `NotFoundError` where the process that held it is gone, and what `LongExposure.expose` raises."""
        with room.opened.use(self.record, self.edits) as shot:
            exposure = _held(room, self.key)
            exposure.shot = shot  # which may have been opened anew since
            exposure.expose(self.begin, self.end)
            return _exposed(exposure.state)


@dataclass(frozen=True)
class DevelopExposure:
    """Look at what is on the film so far.

    Attributes:
        key: of the exposure.
        record: of its shot.
        edits: as when it was begun.
        format: png, jpeg or exr.
    """

    key: str
    record: ShotRecord
    edits: str
    format: str

    def run(self, room: Darkroom) -> bytes:
        """The encoded picture: what `pullfocus record --long-exposure` writes. Raises what `LongExposure.picture` raises."""
        from render.output import encode

        with room.opened.use(self.record, self.edits) as shot:
            exposure = _held(room, self.key)
            exposure.shot = shot
            picture = exposure.picture()
        return encode(self.format, picture.frame, picture.graded, picture.metadata)


@dataclass(frozen=True)
class DropExposure:
    """Throw the film away.

    Attributes:
        key: of the exposure.
    """

    key: str

    def run(self, room: Darkroom) -> None:
        """Let go of it, where it is still there."""
        room.exposures.pop(self.key, None)


def _held(room: Darkroom, key: str) -> LongExposure:
    if key not in room.exposures:
        raise NotFoundError(
            "The picture process that held the long exposure is gone, or holds newer ones: begin it anew.",
            code="exposure_lost",
        )
    return room.exposures[key]


def _exposed(state: LongExposureState) -> Exposed:
    return Exposed(state.open_frames, state.open_seconds, state.intervals, state.nd_stops)
