"""Cameras: the state of the lens, the values that can be set, and the depth of field."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Distance, Finding, Model, TimeCode, shown_as
from service.models.lenses import LensModel
from service.models.shots import CameraChoice

CAMERA_EXAMPLE: JsonDict = {
    "path": "/World/Camera",
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
    "camera": "/World/Camera",
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
}


FocusMode = Literal["manual", "points", "tiltPlane", "surface"]


class CameraState(Model):
    """A camera at one time, focus points solved in."""

    model_config = shown_as(CAMERA_EXAMPLE)

    path: str | None = Field(description="Prim path; null for the camera that frames a shot which has none.")
    time: float = Field(description="USD time code.")
    f_stop: float = Field(description="f-number; 0 is a pinhole.")
    focal_length_mm: float
    focus_distance_m: Distance = Field(description="Where the lens is focused; null is infinity.")
    focus_mode: FocusMode = Field(description="Whether it is focused by hand or by its focus points.")
    horizontal_aperture_mm: float
    vertical_aperture_mm: float
    exposure_scale: float = Field(description="Factor of radiance by the camera's exposure attributes.")
    lens_name: str = Field(description="Engraving of the lens, the `title` of one of the library; may be empty.")
    lens_model: LensModel = Field(description="Model of how light passes the lens.")
    etag: str = Field(
        description="Its `ETag`, which changes when the camera is edited, its focus points aside: for `If-Match`."
    )


class CameraList(Model):
    """The cameras of a shot at one time."""

    model_config = shown_as(
        {
            "default": {"path": "/World/Camera", "reason": "the only camera"},
            "cameras": [CAMERA_EXAMPLE],
            "unusable": [],
        }
    )

    default: CameraChoice
    cameras: list[CameraState] = Field(description="Of a shot without any: the one that frames it.")
    unusable: list[Finding] = Field(description="Cameras whose numbers make no picture, and why.")


class CameraEdit(Model):
    """Values to set on a camera; a value left out stays as it is."""

    model_config = shown_as({"fStop": 2.8, "focusDistanceM": 3.5})

    f_stop: float | None = Field(default=None, ge=0, le=1000, description="f-number; 0 is a pinhole.")
    focal_length_mm: float | None = Field(default=None, gt=0, le=100_000)
    focus_distance_m: float | None = Field(
        default=None,
        ge=0,
        le=1e9,
        description="0 focuses at infinity. Without a `focusMode`, it sets that to `manual`.",
    )
    focus_mode: FocusMode | None = Field(default=None, description="`points` gives the focus back to the focus points.")
    lens: str | None = Field(
        default=None,
        max_length=80,
        description="Mounts a lens of the library by its name, null the thin lens. It brings its focal length, and raises "
        "f-numbers that it has not; an `fStop` and a `focalLengthMm` beside it are set after that. Left out, the lens stays.",
    )
    body: str | None = Field(
        default=None,
        max_length=80,
        description="Gives the camera another body of the library, for all time: its gate and its photosites. The lens stays.",
    )
    time: TimeCode | None = Field(
        default=None, description="USD time code of a key; without it, keys go and the values hold for all time."
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
    source: str = Field(description="Whether focus points decided, or the camera's own focus distance was kept.")
    reason: str = Field(description="One sentence that says why.")
    note: str = Field(description="Sentence about a setting that the lens cannot follow; or empty.")
    tilt_deg: float = Field(description="Turn of the lens: positive looks up.")
    swing_deg: float = Field(description="Turn of the lens, before the tilt: positive looks left.")
    lens_name: str = Field(description="Engraving of the lens, the `title` of one of the library; may be empty.")
    lens_model: LensModel = Field(description="Model of how light passes the lens.")


class PlaceReadout(Model):
    """Readout of the lens at one place of the picture at one time."""

    model_config = shown_as(
        {
            "camera": "/World/Camera",
            "time": 24.0,
            "point": "driver",
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
    screen: tuple[float, float] = Field(description="The place, 0 to 1 from the picture's top left corner.")
    depth_m: Distance = Field(description="Of the thing there, along the view axis; null is infinity.")
    focus_distance_m: Distance = Field(description="Depth of the focal surface at that place; null is infinity.")
    near_m: Distance = Field(description="Nearest depth that is sharp at that place; null is infinity.")
    far_m: Distance = Field(description="Farthest depth that is sharp at that place; null is infinity.")
    hyperfocal_m: Distance = Field(description="Of the lens, on the view axis.")
    coc_mm: float = Field(description="Diameter on the film of the thing's circle of confusion.")
    coc_limit_mm: float = Field(description="Largest circle of confusion, as a diameter on the film, that is sharp.")
    sharp: bool = Field(description="Whether the thing is.")
