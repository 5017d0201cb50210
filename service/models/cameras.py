"""Cameras: the state of the lens, the values that can be set, and the depth of field."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator
from pydantic.config import JsonDict

from service.models.base import Distance, Finding, Model, Pair, PointName, PrimPath, TimeCode, Vector3, shown_as
from service.models.lenses import LensModel
from service.models.settings import edit_field
from service.models.shots import CameraChoice

CAMERA_EXAMPLE: JsonDict = {
    "path": "/World/main_cam",
    "time": 24.0,
    "fStop": 2.0,
    "focalLengthMm": 50.0,
    "focusDistanceM": 3.42,
    "focusMode": "points",
    "horizontalApertureMm": 24.89,
    "verticalApertureMm": 14.0,
    "exposureScale": 1.0,
    "lensName": "Planar 50 mm f/1.4",
    "lensModel": "prescription",
    "etag": '"92c4bf18a0860070"',
}
READOUT_EXAMPLE: JsonDict = {
    "camera": "/World/main_cam",
    "time": 24.0,
    "fStop": 2.0,
    "focalLengthMm": 50.0,
    "focusDistanceM": 3.42,
    "focusMode": "points",
    "nearM": 3.28,
    "farM": 3.58,
    "hyperfocalM": 65.7,
    "cocLimitMm": 0.019,
    "source": "points",
    "reason": "focused by driver",
    "note": "",
    "tiltDeg": 0.0,
    "swingDeg": 0.0,
    "lensName": "Planar 50 mm f/1.4",
    "lensModel": "prescription",
    "closeFocusM": 0.41,
    "pupilToFilmMm": [74.2, 82.4],
}


FocusMode = Literal["manual", "points", "tiltPlane", "surface"]


class CameraState(Model):
    """A camera at one time, focus points solved in."""

    model_config = shown_as(CAMERA_EXAMPLE)

    path: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    time: float = Field(description="USD time code.")
    f_stop: float = Field(description="f-number; 0 is a pinhole.")
    focal_length_mm: float
    focus_distance_m: Distance = Field(description="Focus distance; null is infinity.")
    focus_mode: FocusMode = Field(description="Whether it is focused by hand or by its focus points.")
    horizontal_aperture_mm: float
    vertical_aperture_mm: float
    exposure_scale: float = Field(description="Factor of radiance by the camera's exposure attributes.")
    lens_name: str = Field(description="Engraving of the lens, the `title` of one of the library; may be empty.")
    lens_model: LensModel = Field(description="Model of how light passes the lens.")
    etag: str = Field(description="`ETag` for `If-Match`; changes when the camera is edited, its focus points aside.")


class CameraList(Model):
    """The cameras of a shot at one time."""

    model_config = shown_as(
        {
            "default": {"path": "/World/main_cam", "reason": "the only camera"},
            "cameras": [CAMERA_EXAMPLE],
            "unusable": [],
        }
    )

    default: CameraChoice
    cameras: list[CameraState] = Field(description="For a shot without cameras, the one that frames it.")
    unusable: list[Finding] = Field(description="Cameras whose numbers make no picture, and why.")


class PlaceKey(Model):
    """A key of a camera's place."""

    model_config = shown_as({"time": 24.0, "edited": True})

    time: float = Field(description="USD time code.")
    edited: bool = Field(description="Whether it is of the edits; else the shot's own.")


class CameraPlace(Model):
    """The place of a camera in the world at one time, and the keys of its own transform; what it is below may move it too."""

    model_config = shown_as(
        {
            "camera": "/World/main_cam",
            "time": 24.0,
            "positionM": [0.0, 1.6, 0.5],
            "ahead": [0.0, 0.0, -1.0],
            "up": [0.0, 1.0, 0.0],
            "keys": [{"time": 24.0, "edited": True}],
            "edited": True,
            "inShot": True,
            "etag": '"92c4bf18a0860070"',
        }
    )

    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    time: float = Field(description="USD time code.")
    position_m: Vector3 = Field(description="Of its origin in the world: metres, +Y up.")
    ahead: Vector3 = Field(description="Unit vector of the optical axis, in the world.")
    up: Vector3 = Field(description="Unit vector that is up in the picture, in the world.")
    keys: list[PlaceKey] = Field(description="In order of time; the first 20 000 of a camera that has more.")
    edited: bool = Field(description="Whether the edits have any part in the place.")
    in_shot: bool = Field(
        description="Whether the shot itself has the camera, so that `resetCameraPlace` can take it back to the shot's place."
    )
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


class CameraEdit(Model):
    """Values to set on a camera; a value left out stays as it is."""

    model_config = shown_as({"fStop": 2.8, "focusDistanceM": 3.5})

    f_stop: float | None = edit_field("f_stop")
    focal_length_mm: float | None = edit_field("focal_length_mm")
    focus_distance_m: float | None = edit_field("focus_distance_m")
    focus_mode: FocusMode | None = Field(default=None, description="`points` gives the focus back to the focus points.")
    lens: str | None = Field(
        default=None,
        max_length=80,
        description="Mounts a lens of the library by its name; null is the thin lens. Sets the lens's focal length, and raises "
        "f-numbers below its own; an `fStop` and a `focalLengthMm` in the same edit are set after it. Left out, the lens stays.",
    )
    body: str | None = Field(
        default=None,
        max_length=80,
        description="Sets a body of the library, for all time: its gate and its photosites. The lens stays.",
    )
    time: TimeCode | None = Field(
        default=None,
        description="USD time code of a key; without it, keys are removed and the values hold for all time.",
    )


class Readout(Model):
    """Readout of the lens at one time: the numbers that a focus puller reads off."""

    model_config = shown_as(READOUT_EXAMPLE)

    camera: str | None
    time: float
    f_stop: float
    focal_length_mm: float
    focus_distance_m: Distance = Field(description="null is infinity.")
    focus_mode: FocusMode
    near_m: float = Field(description="Nearest depth that is sharp.")
    far_m: Distance = Field(description="Farthest depth that is sharp; null is infinity.")
    hyperfocal_m: Distance
    coc_limit_mm: float = Field(description="Largest circle of confusion, as a diameter on the film, that is sharp.")
    source: str = Field(description="Whether focus points set the focus, or the camera's own focus distance was kept.")
    reason: str = Field(description="Reason, one sentence.")
    note: str = Field(description="Sentence about a setting that the lens cannot follow; or empty.")
    tilt_deg: float = Field(description="Tilt of the lens; positive is up.")
    swing_deg: float = Field(description="Swing of the lens, applied before the tilt; positive is left.")
    lens_name: str = Field(description="Engraving of the lens, the `title` of one of the library; may be empty.")
    lens_model: LensModel = Field(description="Model of how light passes the lens.")
    close_focus_m: float = Field(
        description="Depth of the nearest focus on the ring of the lens, from the entrance pupil: the one engraved on it, "
        "or that at a tenth of life size."
    )
    pupil_to_film_mm: Pair = Field(
        description="Distance from the entrance pupil to the film, focused at infinity and at the close focus."
    )


class PlaceQuery(Model):
    """Point of the picture: a focus point, or a position."""

    is_text = True

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/main_cam"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    point: PointName | None = Field(
        default=None, description="A focus point's name, in place of `x` and `y`.", examples=["pip"]
    )
    x: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="Position from the picture's left edge (0) to its right one (1).",
        examples=[0.43],
    )
    y: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="Position from the picture's top edge (0) to its bottom one (1).",
        examples=[0.55],
    )
    depth_m: float | None = Field(
        default=None,
        gt=0,
        le=1e9,
        description="Depth at that position, along the view axis; when left out, that of the surface seen there.",
        examples=[3.42],
    )
    aspect: float | None = Field(
        default=None,
        ge=0.01,
        le=100,
        description="Width over height of the picture; the film gate's when left out.",
        examples=[1.7778],
    )

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        is_position = self.x is not None and self.y is not None
        if (self.point is None) != is_position or (self.point is not None and self.depth_m is not None):
            raise ValueError("a place is a focus point's name, or x and y, and with these a depth if need be")
        return self


class PlaceReadout(Model):
    """Readout of the lens at one place of the picture at one time."""

    model_config = shown_as(
        {
            "camera": "/World/main_cam",
            "time": 24.0,
            "point": "pip",
            "screen": [0.43, 0.55],
            "depthM": 3.42,
            "focusDistanceM": 3.4,
            "nearM": 3.26,
            "farM": 3.55,
            "hyperfocalM": 65.7,
            "cocMm": 0.0021,
            "cocLimitMm": 0.019,
            "sharp": True,
        }
    )

    camera: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    time: float = Field(description="USD time code.")
    point: str | None = Field(description="Name of the requested focus point, if any.")
    screen: Pair = Field(description="Point of the picture, 0 to 1 from its top left corner.")
    depth_m: Distance = Field(description="Depth of the surface there, along the view axis; null is infinity.")
    focus_distance_m: Distance = Field(description="Depth of the focal surface at that point; null is infinity.")
    near_m: Distance = Field(description="Nearest depth that is sharp at that point; null is infinity.")
    far_m: Distance = Field(description="Farthest depth that is sharp at that point; null is infinity.")
    hyperfocal_m: Distance = Field(description="Hyperfocal distance on the view axis; null is infinity.")
    coc_mm: float = Field(description="Diameter on the film of the surface's circle of confusion.")
    coc_limit_mm: float = Field(description="Largest circle of confusion, as a diameter on the film, that is sharp.")
    sharp: bool = Field(description="Whether the surface is sharp.")
