"""Framing: a gate's field of view, crop factor, and the frames that pictures of other shapes are composed in.

A gate is the exposed area of the film or sensor. Through an anamorphic lens of squeeze s it shows a picture s times as wide as
itself, so shapes and fields of view are those of a gate ``s · width`` wide.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from render.errors import SettingsError
from render.near_names import hint

FULL_FRAME_MM = (36.0, 24.0)
MAX_ASPECT = 20.0
"""Width over height, or height over width: three times the widest panorama that was ever projected."""
_RATIO = re.compile(r"(\d+(?:\.\d+)?):(\d+(?:\.\d+)?)")

ASPECTS: Mapping[str, float] = MappingProxyType(
    {
        "2.39:1": 2.39,  # scope (SMPTE ST 195)
        "2:1": 2.0,
        "1.85:1": 1.85,
        "16:9": 16 / 9,
        "1.66:1": 1.66,
        "1.37:1": 1.375,  # Academy
        "4:3": 4 / 3,
        "1:1": 1.0,
        "4:5": 4 / 5,
        "9:16": 9 / 16,
    }
)
"""Shapes that pictures are delivered in: name, and width over height."""


@dataclass(frozen=True)
class Gate:
    """Exposed area of the film or sensor.

    Attributes:
        width_mm: width on the film or sensor.
        height_mm: height on the film or sensor.
        squeeze: anamorphic squeeze of the lens; 1 is spherical.
        resolution: photosites across and up; (0, 0) for film.

    Raises:
        SettingsError: a side or the squeeze is not a positive number.
    """

    width_mm: float
    height_mm: float
    squeeze: float = 1.0
    resolution: tuple[int, int] = (0, 0)

    def __post_init__(self) -> None:
        for name, value in (("width", self.width_mm), ("height", self.height_mm), ("squeeze", self.squeeze)):
            if not (value > 0 and math.isfinite(value)):
                raise SettingsError(f"the {name} of a gate must be a positive number, got {value:g}", code="bad_gate")

    @property
    def diagonal_mm(self) -> float:
        """Diagonal of the gate: the diameter of the image circle that a lens must cover."""
        return math.hypot(self.width_mm, self.height_mm)

    @property
    def aspect(self) -> float:
        """Width over height of the picture as it is seen."""
        return self.width_mm * self.squeeze / self.height_mm

    @property
    def crop_factor(self) -> float:
        """Crop factor: ratio of the focal lengths that show the same field, corner to corner, on full frame and on this gate."""
        seen_mm = math.hypot(self.width_mm * self.squeeze, self.height_mm)
        return math.hypot(*FULL_FRAME_MM) / seen_mm

    @property
    def horizontal_crop_factor(self) -> float:
        """Crop factor from side to side, which decides where pictures are cropped to another shape."""
        return FULL_FRAME_MM[0] / (self.width_mm * self.squeeze)


@dataclass(frozen=True)
class FieldOfView:
    """Full field angles of a distortion-free lens focused at infinity."""

    horizontal_rad: float
    vertical_rad: float
    diagonal_rad: float


@dataclass(frozen=True)
class FramingGuide:
    """The largest picture of a shape within a gate, in its middle.

    Attributes:
        name: of the shape.
        aspect: width over height as it is seen.
        width_share: of the gate's width.
        height_share: of the gate's height.
        width_mm: on the film or sensor.
        height_mm: height on the film.
        resolution: photosites within it, across and up; (0, 0) for film.
    """

    name: str
    aspect: float
    width_share: float
    height_share: float
    width_mm: float
    height_mm: float
    resolution: tuple[int, int]


def shape(name: str) -> float:
    """Width over height of a picture.

    Args:
        name: of `ASPECTS`, or a ratio such as ``2.2:1``.

    Raises:
        SettingsError: the name is unknown, with the nearest names in the message; or the shape is out of range.
    """
    if name in ASPECTS:
        return ASPECTS[name]
    ratio = _RATIO.fullmatch(name)
    if ratio is None or not (float(ratio[1]) > 0 and float(ratio[2]) > 0):
        raise SettingsError(
            f"there is no picture of the shape {name!r}: {hint(name, ASPECTS)}, or a ratio such as 2.2:1",
            code="bad_aspect",
        )
    aspect = float(ratio[1]) / float(ratio[2])
    if not 1 / MAX_ASPECT <= aspect <= MAX_ASPECT:
        raise SettingsError(
            f"a picture's shape is from 1:{MAX_ASPECT:g} to {MAX_ASPECT:g}:1, got {name!r}", code="bad_aspect"
        )
    return aspect


def field_of_view(gate: Gate, focal_length_mm: float) -> FieldOfView:
    """Angles of view.

    Args:
        gate: exposed area.
        focal_length_mm: as it is engraved; an anamorphic lens's is that of its vertical.

    Raises:
        SettingsError: the focal length is not a positive number.
    """
    if not (focal_length_mm > 0 and math.isfinite(focal_length_mm)):
        raise SettingsError(
            f"focal length must be a positive number of mm, got {focal_length_mm:g}", code="bad_lens_setting"
        )
    width_mm = gate.width_mm * gate.squeeze
    sides = width_mm, gate.height_mm, math.hypot(width_mm, gate.height_mm)
    return FieldOfView(*(2 * math.atan(side / (2 * focal_length_mm)) for side in sides))


def framing_guides(gate: Gate, aspects: Mapping[str, float] = ASPECTS) -> tuple[FramingGuide, ...]:
    """The frames of usual shapes within a gate, widest first as they are given.

    Args:
        gate: exposed area.
        aspects: name, and width over height.
    """
    return tuple(framing_guide(gate, aspect, name) for name, aspect in aspects.items())


def framing_guide(gate: Gate, aspect: float, name: str = "") -> FramingGuide:
    """The frame of a shape within a gate.

    Args:
        gate: exposed area.
        aspect: width over height as it is seen.
        name: of the shape; without one, such as ``2.2:1``.

    Raises:
        SettingsError: the aspect is not a positive number.
    """
    if not (aspect > 0 and math.isfinite(aspect)):
        raise SettingsError(f"the aspect ratio of a frame must be a positive number, got {aspect:g}", code="bad_aspect")
    across, up = min(1.0, aspect / gate.aspect), min(1.0, gate.aspect / aspect)
    photosites = round(gate.resolution[0] * across), round(gate.resolution[1] * up)
    return FramingGuide(
        name or f"{aspect:g}:1", aspect, across, up, gate.width_mm * across, gate.height_mm * up, photosites
    )
