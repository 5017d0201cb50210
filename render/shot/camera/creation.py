"""Creates a camera from the view that a shot without one is shown through: a prim in place of the framing camera."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from render.errors import SettingsError
from render.model.camera import Camera
from render.stage.world import is_y_up, world_from_stage
from usd_schemas import LensCamera, LibraryBody, define_camera, library_body, mount_body
from usd_schemas.units import tenths_from_mm, units_from_metres

DEFAULT_NAME = "main_cam"
"""Name by which USD knows a shot's primary camera (``UsdUtils.GetPrimaryCameraName``), and this package its default one."""
BODY = "super35_3perf"
"""Body of a created camera: its gate is within 1% of 16:9, the shape in which the framing camera is shown."""
F_STOP = 2.8
"""A usual stop of cine lenses. The framing camera is a pinhole, through which no focus could be seen."""


def free_path(stage: Usd.Stage, name: str | None) -> Sdf.Path:
    """Return the path of a new prim at the root of the stage.

    Args:
        stage: the stage.
        name: of the prim; None for `DEFAULT_NAME`, with a number behind it where that is taken.

    Raises:
        SettingsError: the name is no identifier, or there is such a prim already.
    """
    root = Sdf.Path.absoluteRootPath
    if name is None:
        path, number = root.AppendChild(DEFAULT_NAME), 1
        while stage.GetPrimAtPath(path):
            number += 1
            path = root.AppendChild(f"{DEFAULT_NAME}_{number}")
        return path
    return named_path(stage, root, name)


def named_path(stage: Usd.Stage, parent: Sdf.Path, name: str) -> Sdf.Path:
    """Return the path of a new camera below a prim.

    Raises:
        SettingsError: the name is no identifier, or there is such a prim already.
    """
    if not Sdf.Path.IsValidIdentifier(name):
        detail = f"a camera's name must be an identifier (letters, digits and _, no digit first), got {name!r}"
        raise SettingsError(detail, path="name")
    path = parent.AppendChild(name)
    if stage.GetPrimAtPath(path):
        raise SettingsError(f"there is a prim at {path} already", code="name_taken", path=str(path))
    return path


def create_camera(stage: Usd.Stage, path: Sdf.Path, view: Camera) -> LensCamera:
    """Define a plain Camera that sees what a camera without a prim sees, in the stage's edit target and for all time.

    Position, direction, focus distance and clipping range are the view's. It gets the body `BODY`, a thin lens at `F_STOP`, and
    the longest focal length with which all of the view's gate is in its picture.

    Args:
        stage: the stage.
        path: of a prim at its root that is not there yet.
        view: upright and level, as `render.stage.camera.framing` makes it.
    """
    camera, body = define_camera(stage, str(path)), library_body(BODY)
    mount_body(camera, body)
    usd = UsdGeom.Camera(camera.prim)
    _place(usd, stage, view)
    usd.CreateFocalLengthAttr(tenths_from_mm(focal_length_mm(view, body), stage))
    usd.CreateFStopAttr(F_STOP)
    usd.CreateFocusDistanceAttr(units_from_metres(view.focus_distance_m, stage))
    near, far = (units_from_metres(value, stage) for value in (view.near_m, view.far_m))
    usd.CreateClippingRangeAttr(Gf.Vec2f(near, far))
    return camera


def focal_length_mm(view: Camera, body: LibraryBody) -> float:
    """Return the longest focal length with which a body sees all that a view has on its gate."""
    width, height = body.gate_mm
    return view.focal_length_mm * min(width / view.horizontal_aperture_mm, height / view.vertical_aperture_mm)


def _place(usd: UsdGeom.Camera, stage: Usd.Stage, view: Camera) -> None:
    """Author the view's position, and a turn that makes the camera upright: cameras look along -Z, with +Y up, in any stage."""
    stage_from_world = np.linalg.inv(world_from_stage(stage))
    x, y, z, _ = stage_from_world @ view.world_from_camera[:, 3]
    common = UsdGeom.XformCommonAPI(usd)
    common.SetTranslate(Gf.Vec3d(x, y, z))
    if not is_y_up(stage):
        common.SetRotate(Gf.Vec3f(90, 0, 0))
