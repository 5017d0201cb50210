"""Focus report: the lens and the sharpness of each focus point in the pictures of some frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Usd

from render.errors import CameraError, SettingsError
from render.model.camera import Camera
from render.model.gate_height import gate_height_px
from render.optics.photometry.illuminance import LightPath
from render.shot.focus.focused_camera import FocusedCamera
from render.shot.focus.readout import PlacedPoint, Readout, make_readout, place_points
from render.shot.focus.solver import FocusSolver
from usd_schemas import LensCamera


@dataclass(frozen=True)
class ReportedPoint:
    """A focus point in the picture of one frame.

    Attributes:
        placed: the point, as `Shot.focus.points` has it.
        signed_coc_mm: diameter on the film of its circle of confusion, negative in front of the focus; NaN where it is not in
            front of the camera.
        signed_coc_px: the same in pixels of the picture.
    """

    placed: PlacedPoint
    signed_coc_mm: float
    signed_coc_px: float

    @property
    def is_judged(self) -> bool:
        """Whether it has to be sharp: it is on, with a weight, of the kind ``sharp``, and in the picture."""
        point = self.placed.point
        is_shown = self.placed.screen is not None and self.placed.visible_in_frame
        return point.enabled and point.weight > 0 and point.kind == "sharp" and is_shown

    @property
    def is_soft(self) -> bool:
        """Whether it has to be sharp and is not."""
        return self.is_judged and not self.placed.is_sharp


@dataclass(frozen=True)
class ReportedFrame:
    """The lens and the focus points in the picture of one frame.

    Attributes:
        time: USD time code.
        readout: the lens.
        t_stop: f-number over the root of the share of light that the glass lets through; 0 for a pinhole, infinite where nothing
            comes through.
        points: the focus points of the camera.
    """

    time: float
    readout: Readout
    t_stop: float
    points: tuple[ReportedPoint, ...]


def report_frames(
    solver: FocusSolver, stage: Usd.Stage, camera_path: str | None, times: Sequence[float], size: tuple[int, int | None]
) -> list[ReportedFrame]:
    """Report the focus in the pictures of a camera.

    Args:
        solver: solves the focus.
        stage: the shot.
        camera_path: of a camera; None for the default one.
        times: rising USD time codes.
        size: width and height of the pictures, px; a height of None is that of the film gate.

    Raises:
        CameraError: there is no such camera, or its numbers are impossible.
        SettingsError: the width is out of range.
    """
    solved = solver.solve_all(camera_path, times)
    return [_report(solver, stage, focused, time, size) for focused, time in zip(solved, times, strict=True)]


def _report(
    solver: FocusSolver, stage: Usd.Stage, focused: FocusedCamera, time: float, size: tuple[int, int | None]
) -> ReportedFrame:
    width, height = size
    aspect = width / (height or gate_height_px(focused.camera, width))
    picture = solver.fit_to_picture(focused, time, aspect)
    px_per_mm = width / picture.horizontal_aperture_mm
    return ReportedFrame(
        time=time,
        readout=make_readout(focused),
        t_stop=_t_stop(stage, focused.camera, time),
        points=tuple(_report_point(placed, px_per_mm) for placed in place_points(focused, picture)),
    )


def _report_point(placed: PlacedPoint, px_per_mm: float) -> ReportedPoint:
    is_near = placed.depth_m < placed.focus_distance_m
    signed_mm = -placed.coc_mm if is_near else placed.coc_mm
    return ReportedPoint(placed, signed_mm, signed_mm * px_per_mm)


def _t_stop(stage: Usd.Stage, camera: Camera, time: float) -> float:
    if not camera.f_stop > 0:
        return 0.0
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    glass = LensCamera(prim).lens.read(time).transmittance if prim else 1.0
    try:
        return LightPath(camera.f_stop, glass).t_stop
    except SettingsError as error:  # the number is the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error
