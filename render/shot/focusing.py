"""Where a camera's focus points stand at one time, and the focus that they ask for."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render.errors import CameraError, InputError, SettingsError
from render.focus import FocusSolution, FocusTarget, PointState, solve_focus
from render.optics.depth_of_field import DepthOfField, coc_slope_mm_m, default_coc_limit_mm, depth_of_field
from render.optics.distortion import shown_at
from render.optics.view import PinholeView
from render.scene import Camera
from render.stage import AnchorReader, read_camera
from usd_schemas import FocusData, FocusPoint, LensCamera, SchemaError
from usd_schemas.units import metres_per_unit

DoubleArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Focused:
    """A camera at one time, its focus solved.

    Attributes:
        camera: with its own film gate, focused at the solution.
        focus: what the camera asks of the focus.
        points: its focus points.
        targets: the same points as the lens sees them.
        positions_m: ``(n, 3)`` where they stand in the world; NaN where the target is missing.
        problems: why points have no place, by name.
        solution: whose focus it is, and why.
    """

    camera: Camera
    focus: FocusData
    points: tuple[FocusPoint, ...]
    targets: tuple[FocusTarget, ...]
    positions_m: DoubleArray
    problems: dict[str, str]
    solution: FocusSolution

    @property
    def coc_limit_mm(self) -> float:
        """Largest diameter of a circle of confusion on the film that counts as sharp."""
        if self.focus.circle_of_confusion > 0:
            return self.focus.circle_of_confusion
        return default_coc_limit_mm(self.camera.horizontal_aperture_mm, self.camera.vertical_aperture_mm)

    @property
    def depth_of_field(self) -> DepthOfField:
        """What is sharp before and behind the plane of focus."""
        c = self.camera
        return depth_of_field(c.focal_length_mm, c.f_stop, c.focus_distance_m, self.coc_limit_mm, breathing=c.breathing)

    def coc_mm(self, depth_m: float) -> float:
        """Diameter on the film of the circle of confusion of a point; NaN where it is not in front of the camera.

        Args:
            depth_m: its depth.
        """
        if not depth_m > 0:
            return math.nan
        c = self.camera
        focus_w = 1 / c.focus_distance_m if c.focus_distance_m > 0 else 0.0
        slope_mm_m = coc_slope_mm_m(c.focal_length_mm, c.f_stop, c.focus_distance_m, breathing=c.breathing)
        return slope_mm_m * abs(1 / depth_m - focus_w)


@dataclass(frozen=True)
class PlacedPoint:
    """A focus point at one time, as the camera sees it.

    Attributes:
        point: what is authored, at that time.
        state: whether it counts for the focus, or why not.
        share: its share of the weight that decides the focus, 0 to 1.
        position_m: in the world, metres, +Y up; None where its target is missing.
        depth_m: along the view axis, negative behind the camera; NaN where its target is missing.
        screen: place in the picture: (0, 0) is the top left corner and (1, 1) the bottom right one, and a point outside
            the picture lies outside these; None where it is not in front of the camera.
        visible_in_frame: whether it lies inside the picture and the clipping range (something may still hide it).
        coc_mm: diameter on the film of its circle of confusion; NaN where it is not in front of the camera.
        problem: why it has no place, or empty.
    """

    point: FocusPoint
    state: PointState
    share: float
    position_m: tuple[float, float, float] | None
    depth_m: float
    screen: tuple[float, float] | None
    visible_in_frame: bool
    coc_mm: float
    problem: str = ""


@dataclass(frozen=True)
class Readout:
    """The lens at one time.

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
        lens_name: what is engraved on the lens; empty where it has no name.
        lens_model: how light passes it: pinhole, thin, seidel, spherical, heightField or prescription.
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
    lens_name: str = ""
    lens_model: str = "thin"


def focus_camera(stage: Usd.Stage, anchors: AnchorReader, camera_path: str, time: float) -> Focused:
    """Read a camera and solve its focus.

    Whether a point is inside the picture is asked of the camera's own film gate: where the focus lies must not depend
    on the size or shape of the picture that somebody looks at.

    The modes ``tiltPlane`` and ``surface`` are focused as ``points`` (`Shot.findings` says so).

    Args:
        stage: the stage.
        anchors: finds focus points on that stage.
        camera_path: of a camera.
        time: USD time code.

    Raises:
        CameraError: it is no camera, or it or its focus points have impossible numbers.
    """
    camera = read_camera(stage, camera_path, time)
    try:
        lens_camera = LensCamera(stage.GetPrimAtPath(camera_path))
        focus = lens_camera.focus.read(time)
        points = tuple(view.read(time) for view in lens_camera.focus_points())
    except SchemaError as error:
        raise CameraError(str(error), path=camera_path) from error
    positions_m, problems = _positions(anchors, points, time)
    targets = _targets(camera, points, positions_m, metres_per_unit(stage))
    solution = _solved(camera, focus, targets)
    camera = replace(camera, focus_distance_m=solution.focus_distance_m)
    return Focused(camera, focus, points, targets, positions_m, problems, solution)


def without_points(camera: Camera) -> Focused:
    """A camera that is no prim, and so has no focus points.

    Args:
        camera: such as one that frames the whole stage.
    """
    return Focused(camera, FocusData(), (), (), np.empty((0, 3)), {}, _kept_by_hand(camera, 0))


def place_points(focused: Focused, picture: Camera) -> list[PlacedPoint]:
    """The focus points as they stand in a picture.

    Args:
        focused: the solved camera.
        picture: the same camera, its gate conformed to the picture's shape.
    """
    screens, depths_m, inside = see(picture, focused.positions_m)
    return [
        PlacedPoint(
            point=point,
            state=focused.solution.states[i],
            share=focused.solution.shares[i],
            position_m=None if point.name in focused.problems else _triple(focused.positions_m[i]),
            depth_m=float(depths_m[i]),
            screen=(float(screens[i, 0]), float(screens[i, 1])) if depths_m[i] > 0 else None,
            visible_in_frame=bool(inside[i]),
            coc_mm=focused.coc_mm(float(depths_m[i])),
            problem=focused.problems.get(point.name, ""),
        )
        for i, point in enumerate(focused.points)
    ]


def read_out(focused: Focused) -> Readout:
    """The solved lens in numbers.

    Args:
        focused: the solved camera.
    """
    field, camera = focused.depth_of_field, focused.camera
    return Readout(
        camera=camera.path,
        focus_mode=focused.focus.mode,
        focus_distance_m=camera.focus_distance_m,
        f_stop=camera.f_stop,
        focal_length_mm=camera.focal_length_mm,
        near_m=field.near_m,
        far_m=field.far_m,
        hyperfocal_m=field.hyperfocal_m,
        coc_limit_mm=focused.coc_limit_mm,
        source=focused.solution.source,
        reason=focused.solution.reason,
        lens_name=camera.lens.name,
        lens_model=camera.lens.model,
    )


def see(camera: Camera, positions_m: DoubleArray) -> tuple[DoubleArray, DoubleArray, NDArray[np.bool_]]:
    """Where world points stand in a camera's picture, of whatever size.

    Args:
        camera: its gate is the picture.
        positions_m: ``(n, 3)`` in the world; NaN for none.

    Returns:
        ``(n, 2)`` places from (0, 0) top left to (1, 1) bottom right; ``(n,)`` depth in metres; ``(n,)`` whether it lies
        inside the picture and the clipping range.
    """
    view = PinholeView.from_camera(camera, 1, 1)  # a picture of 1 × 1
    straight, depths_m = view.project(positions_m)
    screens = shown_at(view, camera, straight)
    with np.errstate(invalid="ignore"):
        inside = np.all((screens >= 0) & (screens <= 1), axis=-1)
        inside &= (depths_m >= camera.near_m) & (depths_m <= camera.far_m)
    return screens, depths_m, inside


def _positions(
    anchors: AnchorReader, points: tuple[FocusPoint, ...], time: float
) -> tuple[DoubleArray, dict[str, str]]:
    positions_m = np.full((len(points), 3), np.nan)
    problems = {}
    for index, point in enumerate(points):
        try:
            position_m = anchors.position(point, time)
        except InputError as error:
            problems[point.name] = error.detail
            continue
        if np.all(np.isfinite(position_m)):
            positions_m[index] = position_m
        else:
            problems[point.name] = f"focus point {point.name} has no finite place: {position_m}"
    return positions_m, problems


def _targets(
    camera: Camera, points: tuple[FocusPoint, ...], positions_m: DoubleArray, metres_in_a_unit: float
) -> tuple[FocusTarget, ...]:
    _, depths_m, inside = see(camera, positions_m)
    return tuple(
        FocusTarget(
            name=point.name,
            depth_m=float(depths_m[i]),
            weight=point.weight,
            kind=point.kind,
            blur_mm=point.blur,
            surface_offset_m=point.surface_offset * metres_in_a_unit,
            enabled=point.enabled,
            in_frame=bool(inside[i]),
        )
        for i, point in enumerate(points)
    )


def _solved(camera: Camera, focus: FocusData, targets: tuple[FocusTarget, ...]) -> FocusSolution:
    """The solution by the camera's focus mode.

    The blur of soft points is solved for a lens that does not breathe: one that does gives them up to the share
    focal length / focus distance more.
    """
    if focus.mode == "manual":
        return _kept_by_hand(camera, len(targets))
    try:
        return solve_focus(
            targets,
            camera.focus_distance_m,
            coc_slope_mm_m=coc_slope_mm_m(camera.focal_length_mm, camera.f_stop),
            keep_outside=focus.off_screen == "keep",
            near_priority=focus.near_priority,
        )
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error


def _kept_by_hand(camera: Camera, point_count: int) -> FocusSolution:
    by_hand: PointState = "by_hand"
    return FocusSolution(
        focus_distance_m=camera.focus_distance_m or math.inf,
        source="camera",
        reason="the focus mode is manual, so the camera's own focus distance is kept",
        shares=(0.0,) * point_count,
        states=(by_hand,) * point_count,
    )


def _triple(values: DoubleArray) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
