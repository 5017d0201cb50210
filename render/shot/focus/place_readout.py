"""The lens read off at one place of the picture: what is in focus there, and how large a thing's circle of confusion is."""

from __future__ import annotations

import math
from dataclasses import dataclass

from render.errors import InputError, NotFoundError, SettingsError
from render.model.camera import Camera
from render.optics.distortion import undistort_position
from render.optics.view import PinholeView
from render.shot.focus.focused_camera import FocusedCamera
from render.shot.focus.inputs import project_points


@dataclass(frozen=True)
class PlaceReadout:
    """The lens at one place of the picture at one time.

    Attributes:
        screen: the place: (0, 0) is the top left corner of the picture and (1, 1) the bottom right one.
        depth_m: of the thing there, along the view axis; infinite for the sky.
        focus_distance_m: depth of the focal surface there; may be infinite.
        near_m: nearest depth that is sharp there.
        far_m: farthest; may be infinite.
        hyperfocal_m: the focus from which on the far limit on the view axis is infinite.
        coc_mm: diameter on the film of the thing's circle of confusion.
        coc_limit_mm: largest diameter that counts as sharp.
    """

    screen: tuple[float, float]
    depth_m: float
    focus_distance_m: float
    near_m: float
    far_m: float
    hyperfocal_m: float
    coc_mm: float
    coc_limit_mm: float

    @property
    def is_sharp(self) -> bool:
        """Whether the thing counts as sharp."""
        return self.coc_mm <= self.coc_limit_mm


def read_place(focused: FocusedCamera, picture: Camera, screen: tuple[float, float], depth_m: float) -> PlaceReadout:
    """Read the lens at a place of the picture.

    Args:
        focused: the solved camera.
        picture: the same camera, its gate conformed to the picture's shape.
        screen: the place, from (0, 0) top left to (1, 1) bottom right.
        depth_m: of the thing there, from the camera's origin; may be infinite.

    Raises:
        SettingsError: the place or the depth is no number, or the depth is not in front of the camera.
    """
    if not all(map(math.isfinite, screen)):
        raise SettingsError(f"a place in the picture must be two finite numbers, got {screen}", code="bad_place")
    depth_m += picture.set_back_m
    if not depth_m > 0:
        raise SettingsError(
            f"a depth to read off must be in front of the camera, got {depth_m - picture.set_back_m:g} m",
            code="bad_place",
        )
    view = PinholeView.from_camera(picture, 1, 1)
    x, y = undistort_position(view, picture, *screen)
    return _read(focused, ((x - view.cx) / view.fx, -(y - view.cy) / view.fy), screen, depth_m)


def read_point(focused: FocusedCamera, picture: Camera, name: str) -> PlaceReadout:
    """Read the lens at a focus point.

    Args:
        focused: the solved camera.
        picture: the same camera, its gate conformed to the picture's shape.
        name: of the point.

    Raises:
        NotFoundError: the camera has no such point.
        InputError: it has no place, or none in front of the camera.
    """
    names = [point.name for point in focused.points]
    if name not in names:
        known = ", ".join(names) or "none"
        raise NotFoundError(f"camera {picture.path} has no focus point named {name!r}, it has: {known}", path=name)
    if name in focused.problems:
        raise InputError(focused.problems[name], code="no_place", path=name)
    projected = project_points(picture, focused.positions_m[[names.index(name)]])
    depth_m = float(projected.depths_m[0])
    if not depth_m > 0:
        raise InputError(f"focus point {name} lies behind the camera, {-depth_m:g} m", code="no_place", path=name)
    (x, y), (right, up) = projected.screens[0].tolist(), projected.slopes[0].tolist()
    return _read(focused, (right, up), (x, y), depth_m)


def _read(
    focused: FocusedCamera, slope: tuple[float, float], screen: tuple[float, float], depth_m: float
) -> PlaceReadout:
    field, set_back_m = focused.stated(focused.depth_of_field_at(slope)), focused.camera.set_back_m
    return PlaceReadout(
        screen=screen,
        depth_m=depth_m - set_back_m,
        focus_distance_m=focused.focused_m_at(slope) - set_back_m,
        near_m=field.near_m,
        far_m=field.far_m,
        hyperfocal_m=field.hyperfocal_m,
        coc_mm=focused.coc_mm(depth_m, slope),
        coc_limit_mm=focused.coc_limit_mm,
    )
