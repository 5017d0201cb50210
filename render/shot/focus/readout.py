"""Readouts of a solved focus: the lens in numbers, and its focus points in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from render.focus.solve import PointState
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.focus_law import ring_scale
from render.shot.focus.curve import lens_angles
from render.shot.focus.focused_camera import FocusedCamera
from render.shot.focus.inputs import ProjectedPoints, project_points
from usd_schemas import FocusPoint


@dataclass(frozen=True)
class PlacedPoint:
    """A focus point at one time, as the camera sees it.

    Attributes:
        point: what is authored, at that time.
        state: whether it counts for the focus, or why not.
        share: its share of the total weight, 0 to 1.
        position_m: in the world, metres, +Y up; None where its target is missing.
        depth_m: along the view axis, negative behind the camera; NaN where its target is missing.
        screen: position in the picture: (0, 0) is the top left corner and (1, 1) the bottom right one, and a point outside
            the picture lies outside these; None where it is not in front of the camera.
        visible_in_frame: whether it lies inside the picture and the clipping range (something may still hide it).
        coc_mm: diameter on the film of its circle of confusion; NaN where it is not in front of the camera.
        focus_distance_m: depth of the focal surface where it stands in the picture; may be infinite, NaN where it is not in front
            of the camera.
        is_sharp: whether its circle of confusion is within `FocusedCamera.coc_limit_mm`; False without a place.
        problem: why it has no position, or empty.
    """

    point: FocusPoint
    state: PointState
    share: float
    position_m: tuple[float, float, float] | None
    depth_m: float
    screen: tuple[float, float] | None
    visible_in_frame: bool
    coc_mm: float
    focus_distance_m: float
    is_sharp: bool
    problem: str = ""


@dataclass(frozen=True)
class Readout:
    """The lens of a camera at one time.

    Attributes:
        camera: prim path of the camera, empty for a framing camera, which is no prim.
        focus_mode: manual, points, tiltPlane or surface.
        focus_distance_m: depth of the plane of focus; may be infinite.
        f_stop: f-number; 0 is a pinhole.
        focal_length_mm: focal length.
        near_m: nearest depth that counts as sharp.
        far_m: farthest; may be infinite.
        hyperfocal_m: the focus from which on the far limit is infinite.
        coc_limit_mm: largest diameter on the film of a circle of confusion that counts as sharp.
        source: whether ``points`` decided the focus or the ``camera``'s own distance was kept.
        reason: one sentence that says why.
        note: sentence on what could not be done as requested; or empty.
        tilt_rad: turn of the lens, positive looks up.
        swing_rad: turn of the lens before the tilt, positive looks left.
        lens_name: engraved on the lens; empty where it has no name.
        lens_model: model of the lens: pinhole, thin, seidel, spherical, heightField or prescription.
        orthographic: whether its rays are parallel, so that its focal length has no meaning.
        close_focus_m: depth of the nearest focus on the lens's ring.
        pupil_to_film_mm: from the entrance pupil to the film, focused at infinity and at the close focus.
    """

    camera: str
    focus_mode: str
    focus_distance_m: float
    f_stop: float
    focal_length_mm: float
    near_m: float
    far_m: float
    hyperfocal_m: float
    coc_limit_mm: float
    source: str
    reason: str
    note: str = ""
    tilt_rad: float = 0.0
    swing_rad: float = 0.0
    lens_name: str = ""
    lens_model: str = "thin"
    orthographic: bool = False
    close_focus_m: float = 0.0
    pupil_to_film_mm: tuple[float, float] = (0.0, 0.0)


def place_points(focused: FocusedCamera, picture: Camera) -> list[PlacedPoint]:
    """Place the focus points in a picture.

    Args:
        focused: the solved camera.
        picture: the same camera, its gate conformed to the picture's shape.
    """
    projected = project_points(picture, focused.positions_m)
    cocs_mm = focused.cocs_mm(projected.depths_m, projected.slopes)
    is_ahead = projected.depths_m > 0
    focused_m = focused.focused_m_at_all(np.where(is_ahead[:, None], projected.slopes, 0.0))
    return [
        _place_point(focused, picture, projected, i, float(cocs_mm[i]), float(focused_m[i]))
        for i in range(len(focused.points))
    ]


def _place_point(
    focused: FocusedCamera, picture: Camera, projected: ProjectedPoints, i: int, coc_mm: float, focused_m: float
) -> PlacedPoint:
    point, depth_m = focused.points[i], float(projected.depths_m[i])
    is_ahead = depth_m > 0
    return PlacedPoint(
        point=point,
        state=focused.solution.states[i],
        share=focused.solution.shares[i],
        position_m=None if point.name in focused.problems else _triple(focused.positions_m[i]),
        depth_m=depth_m - picture.set_back_m,
        screen=(float(projected.screens[i, 0]), float(projected.screens[i, 1])) if is_ahead else None,
        visible_in_frame=bool(projected.inside[i]),
        coc_mm=coc_mm,
        focus_distance_m=focused_m - picture.set_back_m if is_ahead else math.nan,
        is_sharp=coc_mm <= focused.coc_limit_mm,
        problem=focused.problems.get(point.name, ""),
    )


def make_readout(focused: FocusedCamera) -> Readout:
    """Read the solved lens in numbers.

    Args:
        focused: the solved camera.
    """
    field, camera = focused.stated_depth_of_field, focused.camera
    tilt_rad, swing_rad = lens_angles(focused)
    ring = ring_scale(camera)
    return Readout(
        camera=camera.path,
        focus_mode=focused.focus.mode,
        focus_distance_m=camera.stated_focus_m,
        f_stop=camera.f_stop,
        focal_length_mm=camera.stated_focal_length_mm,
        near_m=field.near_m,
        far_m=field.far_m,
        hyperfocal_m=field.hyperfocal_m,
        coc_limit_mm=focused.coc_limit_mm,
        source=focused.solution.source,
        reason=focused.solution.reason,
        note=focused.note,
        tilt_rad=tilt_rad,
        swing_rad=swing_rad,
        lens_name=camera.lens.name,
        lens_model=camera.lens.model,
        orthographic=camera.orthographic is not None,
        close_focus_m=ring.close_focus_m,
        pupil_to_film_mm=ring.to_film_mm,
    )


def _triple(values: DoubleArray) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
