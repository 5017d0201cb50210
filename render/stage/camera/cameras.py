"""Cameras of a stage in the renderer's units: metres, millimetres, Y-up."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Literal, get_args

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdUtils

from render.errors import CameraError, SettingsError, StageError
from render.model.camera import Camera
from render.model.shutter import Shutter
from render.stage.assembly.poses import world_pose
from render.stage.camera.camera_exposure import camera_number, exposure_scale
from render.stage.camera.clipping import read_clip_planes, read_clipping_range
from render.stage.camera.framing import framing_camera
from render.stage.camera.lenses import make_iris, make_lens
from render.stage.camera.orthographic import stand_back
from render.stage.camera_list import list_cameras
from render.stage.opening import confinement, read_quietly
from render.stage.options import DRAWN_PURPOSES
from render.stage.render_settings import stage_settings
from render.stage.values import format_value
from render.stage.world import rigid_frame, world_from_stage
from usd_schemas import LensCamera
from usd_schemas import Shutter as ShutterData
from usd_schemas.units import metres_from_units, mm_from_tenths

Conform = Literal[
    "expandAperture", "cropAperture", "adjustApertureWidth", "adjustApertureHeight", "adjustPixelAspectRatio"
]
# Near clipping distance of cameras that give 0 or less: points at the pinhole cannot be projected.
_NEAREST_M = 1e-4


@dataclass(frozen=True)
class CameraChoice:
    """Choice of the camera, with its reason.

    Attributes:
        path: of a camera on the stage, or None where there is none to prefer.
        reason: why this one, in words that follow a camera's name.
        framing: where path is None, a camera that has everything in view.
    """

    path: str | None
    reason: str
    framing: Camera | None = None


def default_camera(
    stage: Usd.Stage,
    *,
    time: float | None = None,
    aspect: float | None = None,
    cameras: Sequence[str] | None = None,
    purposes: Sequence[str] = DRAWN_PURPOSES,
    mask: Sequence[str] | None = None,
) -> CameraChoice:
    """The camera that is meant where none is named.

    The one that the stage's render settings name, else one called ``main_cam``, else the only one, cameras that edits have made
    aside; else a camera that frames the stage as usdrecord's does.

    Args:
        stage: the stage.
        time: the time code to frame at, where framing is needed; by default the stage's first.
        aspect: width over height of the picture, for the framing camera.
        cameras: what `list_cameras` gives, where that is known.
        purposes: of what the framing camera has in view.
        mask: of what the framing camera has in view, as in `framing_camera`.

    Raises:
        StageError: there is no camera and nothing to frame; code ``empty_stage``.
    """
    cameras = list_cameras(stage) if cameras is None else cameras
    settings = stage_settings(stage)
    with read_quietly(stage):
        named_camera = settings.camera_path if settings else None
    if settings and named_camera in cameras:
        return CameraChoice(named_camera, f"the render settings {settings.path} name it")
    main = str(UsdUtils.GetPrimaryCameraName())
    named = [path for path in cameras if Sdf.Path(path).name == main]
    if named:
        return CameraChoice(named[0], f"it is called {main}")
    if len(cameras) == 1:
        return CameraChoice(cameras[0], "it is the only one")
    own = list(islice((path for path in cameras if _is_own(stage, path)), 2))
    if len(own) == 1:
        return CameraChoice(own[0], "it is the only one that is no edit")
    if cameras and not own:
        return CameraChoice(cameras[0], "it is the first of those that edits have made")
    why = f"none of the {len(cameras)} cameras is called {main}" if cameras else "the stage has no camera"
    at = stage.GetStartTimeCode() if time is None else time
    framing = framing_camera(stage, at, purposes=purposes, mask=mask)
    return CameraChoice(None, f"{why}, so the whole stage is framed", conform_camera(framing, aspect))


def _is_own(stage: Usd.Stage, path: str) -> bool:
    """Whether a camera is defined by the shot's files, and not by a session layer alone, as edits are."""
    with_session, without = (stage.GetLayerStack(includeSessionLayers=included) for included in (True, False))
    sessions = [layer for layer in with_session if layer not in without]
    specs = stage.GetPrimAtPath(path).GetPrimStack()
    return any(spec.specifier != Sdf.SpecifierOver and spec.layer not in sessions for spec in specs)


def read_camera(
    stage: Usd.Stage, path: str, time: float, *, aspect: float | None = None, conform: str | None = None
) -> Camera:
    """Read the camera at a prim path and time.

    Args:
        stage: the stage.
        path: of a Camera or LensCamera prim.
        time: USD time code.
        aspect: width over height of the picture; None keeps the film gate as it is.
        conform: how the gate becomes the picture's shape: a token of UsdRenderSettings' aspectRatioConformPolicy; by
            default the stage's own render settings, else ``expandAperture``.

    Raises:
        CameraError: there is no camera at the path, or its numbers are impossible.
        StageError: its transform is not finite, or the render settings' conform policy is invalid.
    """
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    if not prim or not prim.IsA(UsdGeom.Camera):
        raise _no_camera(stage, path, prim)
    with read_quietly(stage):
        camera = _read(UsdGeom.Camera(prim), stage, Usd.TimeCode(time))
    _check(camera)
    return conform_to_stage(camera, stage, aspect, conform)


def conform_to_stage(camera: Camera, stage: Usd.Stage, aspect: float | None, conform: str | None = None) -> Camera:
    """Conform a camera's film gate to the picture's shape, by the stage's own policy unless another is given.

    Args:
        camera: the camera, with its own gate.
        stage: its stage.
        aspect: as in `read_camera`.
        conform: as in `read_camera`.

    Raises:
        StageError: the render settings' conform policy is invalid.
        SettingsError: as in `conform_camera`.
    """
    return conform_camera(camera, aspect, conform or _stage_policy(stage))


def _read(usd: UsdGeom.Camera, stage: Usd.Stage, code: Usd.TimeCode) -> Camera:
    path, projection = str(usd.GetPath()), usd.GetProjectionAttr().Get(code)
    if projection == UsdGeom.Tokens.perspective:
        return _add_lens(_gate(usd, stage, code), usd, stage, code)
    if projection != UsdGeom.Tokens.orthographic:
        message = f"projection of camera {path} must be perspective or orthographic, got {format_value(projection)}"
        raise CameraError(message, code="bad_projection", path=path)
    camera = _add_lens(_gate(usd, stage, code), usd, stage, code)
    _check(camera)
    near, _ = read_clipping_range(usd, code)
    return stand_back(camera, stage, code, metres_from_units(near, stage))


def conform_camera(camera: Camera, aspect: float | None, conform: str = "expandAperture") -> Camera:
    """Conform a camera's film gate to the picture's shape, by one of UsdRenderSettings' policies.

    ``expandAperture`` shows more than the gate, ``cropAperture`` less; the width or the height alone may be adjusted; with
    ``adjustPixelAspectRatio`` the gate stays and pixels are not square.

    Raises:
        SettingsError: the policy is not known, or the aspect is no positive number.
    """
    if conform not in get_args(Conform):
        raise SettingsError(f"the conform policy must be one of {', '.join(get_args(Conform))}, got {conform}")
    if aspect is None or conform == "adjustPixelAspectRatio":
        return camera
    if not (math.isfinite(aspect) and aspect > 0):
        raise SettingsError(f"the picture's aspect ratio must be a positive number, got {aspect}")
    width, height = camera.horizontal_aperture_mm, camera.vertical_aperture_mm
    is_wider = aspect > width / height
    adjusts_width = {
        "expandAperture": is_wider,
        "cropAperture": not is_wider,
        "adjustApertureWidth": True,
        "adjustApertureHeight": False,
    }[conform]
    if adjusts_width:
        return replace(camera, horizontal_aperture_mm=height * aspect)
    return replace(camera, vertical_aperture_mm=width / aspect)


def _stage_policy(stage: Usd.Stage) -> str:
    settings = stage_settings(stage)
    if settings is None:
        return "expandAperture"
    policy, path = settings.conform_policy, settings.path
    if policy not in get_args(Conform):
        raise StageError(
            f"aspectRatioConformPolicy of {path} must be one of {', '.join(get_args(Conform))}, got {policy}", path=path
        )
    return policy


def _no_camera(stage: Usd.Stage, path: str, prim: Usd.Prim | None) -> CameraError:
    cameras = list_cameras(stage)
    known = f"the cameras are {', '.join(cameras)}" if cameras else "the stage has no camera"
    if prim:
        return CameraError(
            f"{path} is a {prim.GetTypeName() or 'prim without a type'}, not a camera: {known}", path=path
        )
    return CameraError(f"there is no camera at {path}: {known}", code="no_such_camera", path=path)


def _gate(usd: UsdGeom.Camera, stage: Usd.Stage, time: Usd.TimeCode) -> Camera:
    """Pose of the camera, and its film gate."""
    transforms = UsdGeom.XformCache(time)

    def mm(attribute: Usd.Attribute) -> float:
        return mm_from_tenths(camera_number(attribute, time), stage)

    near, far = read_clipping_range(usd, time)
    pose = world_pose(usd.GetPrim(), transforms, world_from_stage(stage))
    frame = rigid_frame(pose)
    return Camera(
        world_from_camera=frame,
        focal_length_mm=mm(usd.GetFocalLengthAttr()),
        horizontal_aperture_mm=mm(usd.GetHorizontalApertureAttr()),
        vertical_aperture_mm=mm(usd.GetVerticalApertureAttr()),
        horizontal_offset_mm=mm(usd.GetHorizontalApertureOffsetAttr()),
        vertical_offset_mm=mm(usd.GetVerticalApertureOffsetAttr()),
        near_m=max(metres_from_units(near, stage), _NEAREST_M),
        far_m=metres_from_units(far, stage),
        clip_planes=read_clip_planes(usd, time, pose, frame),
        path=str(usd.GetPath()),
    )


def _add_lens(camera: Camera, usd: UsdGeom.Camera, stage: Usd.Stage, time: Usd.TimeCode) -> Camera:
    """Add focus, iris, shutter and exposure to a camera, with its lens shifted against the film."""
    lens = LensCamera(usd.GetPrim())
    focus = camera_number(usd.GetFocusDistanceAttr(), time)
    at = time.GetValue()
    aperture, glass, moved = lens.aperture.read(at), lens.lens.read(at), lens.tilt_shift.read(at)
    shutter = lens.film.read(at).shutter
    confined_to = confinement(stage)
    return replace(
        camera,
        horizontal_offset_mm=camera.horizontal_offset_mm + moved.shift_mm,
        vertical_offset_mm=camera.vertical_offset_mm + moved.rise_mm,
        f_stop=0.0 if glass.model == "pinhole" else camera_number(usd.GetFStopAttr(), time),
        focus_distance_m=0.0 if focus == math.inf else metres_from_units(focus, stage),
        exposure_scale=exposure_scale(usd, time),
        iris=make_iris(aperture, camera.path, confined_to),
        lens=make_lens(glass, camera.path, confined_to),
        shutter_open=camera_number(usd.GetShutterOpenAttr(), time),
        shutter_close=camera_number(usd.GetShutterCloseAttr(), time),
        shutter=_shutter(shutter, stage, camera.path),
        breathing=glass.breathing,
        circles_by_image_distance=glass.circle_distance == "imageDistance",
    )


def _shutter(shutter: ShutterData, stage: Usd.Stage, path: str) -> Shutter:
    if not 0 <= shutter.travel_s < math.inf:
        raise CameraError(
            f"film:shutter:travelTime of camera {path} must be 0 s or more, got {shutter.travel_s:g} s",
            code="bad_shutter",
            path=path,
        )
    travel = shutter.travel_s * stage.GetTimeCodesPerSecond()
    try:
        return Shutter(shutter.type, shutter.direction, travel, tuple(shutter.efficiency))
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {path}: {error.detail}", code="bad_shutter", path=path) from error


def _check(camera: Camera) -> None:
    """Raise CameraError for invalid numbers of a camera."""
    lengths = {
        "focalLength": camera.focal_length_mm,
        "horizontalAperture": camera.horizontal_aperture_mm,
        "verticalAperture": camera.vertical_aperture_mm,
    }
    for name, value in lengths.items():
        _require(camera, math.isfinite(value) and value > 0, name, "a positive number", f"{value:g} mm")
    settings = {
        "fStop": camera.f_stop,
        "focusDistance": camera.focus_distance_m,
        "clippingRange": camera.near_m,
    }
    for name, value in settings.items():
        _require(camera, math.isfinite(value) and value >= 0, name, "0 or more", f"{value:g}")
    finite = {
        "shutter:open": camera.shutter_open,
        "shutter:close": camera.shutter_close,
    }
    for name, value in finite.items():
        _require(camera, math.isfinite(value), name, "a finite number of frames", f"{value:g}", code="bad_shutter")
    offsets = {
        "horizontalApertureOffset": camera.horizontal_offset_mm,
        "verticalApertureOffset": camera.vertical_offset_mm,
    }
    for name, value in offsets.items():
        _require(camera, math.isfinite(value), name, "a finite number", f"{value:g} mm")
    _require(
        camera,
        camera.far_m > camera.near_m,
        "clippingRange",
        "near before far",
        f"{camera.near_m:g} m to {camera.far_m:g} m",
    )
    rotation = camera.world_from_camera[:3, :3]
    _require(
        camera,
        abs(np.linalg.det(rotation)) > 0.5,
        "transform",
        "one that turns and scales by more than 0",
        "a flat one",
    )


def _require(camera: Camera, holds: bool, name: str, expected: str, got: str, code: str = "bad_camera") -> None:
    if not holds:
        raise CameraError(f"{name} of camera {camera.path} must be {expected}, got {got}", code=code, path=camera.path)
