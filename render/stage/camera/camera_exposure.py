"""UsdGeomCamera's exposure of a camera, each of its numbers checked by its own name."""

from __future__ import annotations

import math

from pxr import Usd, UsdGeom

from render.errors import CameraError
from render.optics.photometry.exposure import MAX_COMPENSATION_STOPS
from render.stage.values import number

_POSITIVE = ("exposure:time", "exposure:iso", "exposure:fStop", "exposure:responsivity")


def camera_number(attribute: Usd.Attribute, time: Usd.TimeCode) -> float:
    """A number of a camera.

    Raises:
        CameraError: the value is not a number.
    """
    try:
        return number(attribute, time)
    except TypeError as problem:
        path = str(attribute.GetPrim().GetPath())
        raise CameraError(f"{attribute.GetName()} of camera {path} {problem}", path=path) from problem


def exposure_scale(usd: UsdGeom.Camera, time: Usd.TimeCode) -> float:
    """Factor on radiance, as UsdGeomCamera computes it. Unlike UsdGeomCamera, raise where a number is out of range.

    Raises:
        CameraError: one of the numbers is beyond what an exposure can have, or all together are; the message names it.
    """
    path = str(usd.GetPath())
    for name in _POSITIVE:
        value = camera_number(usd.GetPrim().GetAttribute(name), time)
        if not 0 < value < math.inf:
            raise CameraError(f"{name} of camera {path} must be a positive number, got {value:g}", path=path)
    stops = camera_number(usd.GetPrim().GetAttribute("exposure"), time)
    if not abs(stops) <= MAX_COMPENSATION_STOPS:
        limits = f"from -{MAX_COMPENSATION_STOPS} to {MAX_COMPENSATION_STOPS} stops"
        raise CameraError(f"exposure of camera {path} must be {limits}, got {stops:g}", path=path)
    scale = float(usd.ComputeLinearExposureScale(time))
    if not math.isfinite(scale):
        together = "exposure and exposure:* together multiply light by more than numbers hold"
        raise CameraError(f"camera {path}: {together}", path=path)
    return scale
