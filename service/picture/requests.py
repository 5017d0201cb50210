"""Values that the HTTP process and the picture process exchange. Imports neither USD nor GL."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from render.model.burn_in import BurnIn
from service.models.cameras import Readout
from service.models.focus import PointSharpness
from service.models.live import Stage
from service.models.picture_limits import PictureLimits
from service.storage.store import ShotRecord

THUMBNAIL = "thumbnail"
"""Name, among the files of a frame, of a small picture of it."""


@dataclass(frozen=True)
class FrameRequest:
    """A frame of a shot and how it is rendered.

    Attributes:
        record: the shot.
        edits: text of its edit layer at the time of the request.
        camera: prim path, or None for the default camera.
        time: USD time code.
        height: px, or None for the shape of the film gate.
        limits: what the picture may have, where the film gate gives the height.
        settings: the other fields of `render.frame.FrameSettings`, ``width`` among them.
        finish: ``film``, ``display``, ``view`` and ``look`` in place of the shot's; None keeps the shot's.
        burn_in: facts in the corners of graded pictures; None for none.
    """

    record: ShotRecord
    edits: str
    camera: str | None
    time: float
    height: int | None
    limits: PictureLimits
    settings: Mapping[str, Any]
    finish: Mapping[str, str | None]
    burn_in: BurnIn | None = None


@dataclass(frozen=True)
class LivePicture:
    """An encoded picture of a live request.

    Attributes:
        stage: its quality.
        format: file format of ``data``.
        width: px.
        height: px.
        took_ms: times as in `service.models.live.LiveTiming`, except ``answered_ms``.
        rays: rays per pixel.
        scale: pixels per requested pixel, along one side.
        share: fraction of the final picture's work that is done.
        data: the encoded picture.
        focus: its focus map, encoded as `service.picture.focus_maps.encode_focus_map` does; empty where it has none.
    """

    stage: Stage
    format: Literal["jpeg", "png"]
    width: int
    height: int
    took_ms: dict[str, float]
    rays: int
    scale: float
    share: float
    data: bytes
    focus: bytes = b""

    @property
    def is_final(self) -> bool:
        """True for the exact picture, which no better one follows."""
        return self.stage == "final"


@dataclass(frozen=True)
class LiveNumbers:
    """Numbers of a live request with changes.

    Attributes:
        readout: readout of the lens.
        points: sharpness of the focus points.
    """

    readout: Readout
    points: list[PointSharpness]


@dataclass(frozen=True)
class ExposureProgress:
    """Progress of a long exposure; see `render.pictures.long_exposure.LongExposureState`.

    Attributes:
        open_frames: time that the shutter was open, in frames.
        open_seconds: the same in seconds.
        intervals: intervals that are exposed.
        nd_stops: density of the neutral density filter.
    """

    open_frames: float = 0.0
    open_seconds: float = 0.0
    intervals: int = 0
    nd_stops: float = 0.0


@dataclass(frozen=True)
class DrawnFrame:
    """A frame of a render.

    Attributes:
        files: content of its files by format, with a small JPEG as `THUMBNAIL`.
        time_codes_per_second: of the shot.
    """

    files: dict[str, bytes]
    time_codes_per_second: float
