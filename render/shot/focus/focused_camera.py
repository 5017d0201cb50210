"""A camera at one time with its focus solved: focal surface, depth of field and circles of confusion."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from render.errors import CameraError, SettingsError
from render.focus.drawn import Frame, bends, half_lenses
from render.focus.expressive import SurfacePoints, focal_controls
from render.focus.points import FocusTarget
from render.focus.solve import FocusSolution, PointState
from render.focus.surface import focused_at
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.focal_surface import MAX_CONTROLS, FocalPlane, FocalSurface, HalfLens
from render.model.lens_law import LensLaw
from render.optics.depth_of_field import DepthOfField
from render.optics.focus_law import focus_law
from render.optics.thin_lens import focal_surface, focus_w
from render.optics.view import PinholeView
from render.shot.focus.inputs import FocusInputs, coc_limit_mm
from render.shot.focus.track import FocusTrack
from render.trace.field_focus import FieldFocus, field_focus
from usd_schemas import FocusData, FocusPoint

_SAME_W = 1e-4
"""Inverse depths within this share of each other are the same focus."""


@dataclass(frozen=True, eq=False)
class FocusedCamera:
    """A camera at one time, its focus solved.

    Attributes:
        camera: with its own film gate, focused at the solution.
        focus: its focus settings.
        points: its focus points.
        targets: the same points in the lens's terms.
        positions_m: ``(k, 3)`` in the world; NaN where the target is missing.
        problems: why points have no position, by name.
        solution: whose focus it is, and why.
        note: sentence on what could not be done as requested; or empty.
        at_fault: names of points with a value that has no meaning.
    """

    camera: Camera
    focus: FocusData
    points: tuple[FocusPoint, ...]
    targets: tuple[FocusTarget, ...]
    positions_m: DoubleArray
    problems: dict[str, str]
    solution: FocusSolution
    note: str = ""
    at_fault: frozenset[str] = frozenset()

    @property
    def coc_limit_mm(self) -> float:
        """Largest diameter of a circle of confusion on the film that counts as sharp."""
        return coc_limit_mm(self.camera, self.focus)

    @cached_property
    def law(self) -> LensLaw:
        """Law by which focusing changes the lens, at the f-number that it reaches."""
        return focus_law(self.camera)

    @cached_property
    def _field(self) -> FieldFocus | None:
        """Sharpest focus across the field, relative to the focal surface; None for a lens without errors."""
        return field_focus(self.camera)

    @property
    def depth_of_field(self) -> DepthOfField:
        """Depth of field on the view axis, about the plane of focus. `depth_of_field_at` has that of a bent focal surface."""
        plane = focal_surface(self.camera).plane
        return self._depth_of_field(plane.w0, float(self.law.coc_slope_mm_m(np.array([plane.w0]))[0]))

    @property
    def stated_depth_of_field(self) -> DepthOfField:
        """`depth_of_field`, from the camera prim's origin."""
        return self.stated(self.depth_of_field)

    def stated(self, field: DepthOfField) -> DepthOfField:
        """Depth of field from the camera prim's origin, of one from its pupil; an orthographic camera is never hyperfocal."""
        back_m = self.camera.set_back_m
        if back_m == 0:
            return field
        return DepthOfField(field.near_m - back_m, field.far_m - back_m, math.inf)

    def depth_of_field_at(self, slope: tuple[float, float]) -> DepthOfField:
        """Depth of field about the focal surface at a place of the picture.

        Args:
            slope: of the place in object space, x right and y up.
        """
        w_f, growth = self._sharpness(np.array(slope))
        return self._depth_of_field(float(w_f), float(growth))

    def _depth_of_field(self, w_f: float, growth: float) -> DepthOfField:
        if growth == 0:
            return DepthOfField(0.0, math.inf, 0.0)
        reach = self.coc_limit_mm / growth
        start, pitch = (float(part[0]) for part in self.law.reciprocal_near(np.zeros(1)))
        limit_at_f1 = self.coc_limit_mm * float(self.law.f_stops[0])
        return DepthOfField(
            near_m=1 / (w_f + reach) if w_f + reach > 0 else math.inf,
            far_m=1 / (w_f - reach) if w_f > reach else math.inf,
            hyperfocal_m=(1 - limit_at_f1 * pitch) / (limit_at_f1 * start),
        )

    def focused_m_at(self, slope: tuple[float, float]) -> float:
        """Depth of the focal surface at a place of the picture; infinite at and beyond its vanishing line.

        Args:
            slope: of the place in object space, x right and y up.
        """
        return float(self.focused_m_at_all(np.array([slope]))[0])

    def focused_m_at_all(self, slopes: DoubleArray) -> DoubleArray:
        """``(k,)`` depths of the focal surface at k places of the picture, as `focused_m_at`.

        Args:
            slopes: ``(k, 2)``.
        """
        w_f = self._sharpness(slopes)[0]
        with np.errstate(divide="ignore", over="ignore"):
            return np.where(w_f > 0, 1 / w_f, math.inf)

    def sharp_w_at(self, slopes: DoubleArray) -> DoubleArray:
        """``(k, 3)`` inverse depths at k places of the picture, 1/m: of the near limit of sharpness, the focus and the far limit.

        0 is infinity; below 0 there is none in front of the camera. The limits of a pinhole are infinite.

        Args:
            slopes: ``(k, 2)`` of the places in object space, x right and y up.
        """
        return self._limits(*self._sharpness(slopes))

    @property
    def axis_w(self) -> DoubleArray:
        """``(3,)`` `sharp_w_at` on the view axis, about the plane of focus, as `depth_of_field` has it."""
        w0 = focal_surface(self.camera).plane.w0
        return self._limits(np.array(w0), self.law.coc_slope_mm_m(np.array([w0]))[0])

    def _limits(self, w_f: DoubleArray, growth: DoubleArray) -> DoubleArray:
        with np.errstate(divide="ignore"):
            reach = self.coc_limit_mm / np.asarray(growth, np.float64)
        return np.stack([w_f + reach, np.broadcast_to(w_f, reach.shape), w_f - reach], axis=-1)

    def coc_mm(self, depth_m: float, slope: tuple[float, float] = (0.0, 0.0)) -> float:
        """Diameter on the film of the circle of confusion of a point; NaN where it is not in front of the camera.

        Args:
            depth_m: its depth.
            slope: of the point in object space, x right and y up.
        """
        return float(self.cocs_mm(np.array([depth_m]), np.array([slope]))[0])

    def cocs_mm(self, depths_m: DoubleArray, slopes: DoubleArray) -> DoubleArray:
        """``(k,)`` diameters on the film of the circles of confusion of k points, as `coc_mm`.

        Args:
            depths_m: ``(k,)``.
            slopes: ``(k, 2)``; ignored where a depth is not in front of the camera.
        """
        ahead = depths_m > 0
        w_f, growth = self._sharpness(np.where(ahead[:, None], slopes, 0.0))
        return np.where(ahead, growth * np.abs(1 / np.where(ahead, depths_m, 1.0) - w_f), math.nan)

    def _sharpness(self, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """Focus ``(...)`` at slopes ``(..., 2)``, 1/m, and growth of the circle of confusion from there, mm·m."""
        surface = focal_surface(self.camera)
        w, pupil = focused_at(surface, slopes)
        growth = self.law.coc_slope_mm_m(np.array([surface.plane.w0]))[0]
        if self._field is None:
            return w, np.asarray(growth * pupil)
        shift, share = self._field.at(slopes)
        return w + shift / pupil, np.asarray(growth * pupil * share)


def focus_camera(inputs: FocusInputs, track: FocusTrack, index: int) -> FocusedCamera:
    """Focus a camera at one time of its track.

    Args:
        inputs: of the camera.
        track: its focus at the same times.
        index: of the time.

    Raises:
        CameraError: a number of the camera or of a point has no meaning.
    """
    plane, solution = track.plane(index), track.solutions.at(index)
    requested_w, w0 = float(track.requested_w[index]), plane.w0
    if abs(requested_w - w0) > _SAME_W * max(requested_w, w0):
        to = f"{1 / requested_w - inputs.cameras[index].set_back_m:.4g} m" if requested_w > 0 else "infinity"
        solution = replace(solution, reason=f"{solution.reason}, on the way to {to}")
    own = inputs.cameras[index]
    distance_m = 1 / w0 if w0 > 0 else math.inf
    if w0 == focus_w(own):  # keep the last digit as authored
        distance_m = own.focus_distance_m or math.inf
    solution = replace(solution, focus_distance_m=distance_m)
    camera = replace(own, focus_distance_m=distance_m, f_stop=float(track.f_stops[index]))
    try:
        surface = _surface(inputs, camera, plane, track, index)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error
    return FocusedCamera(
        camera=replace(camera, focal_surface=surface),
        focus=inputs.focus[index],
        points=inputs.points[index],
        targets=inputs.unshifted_targets.at(index),
        positions_m=inputs.positions_m[index],
        problems=inputs.problems[index],
        solution=solution,
        note="; ".join(
            note for note in (track.notes[index], _speed_note(track, index), _crowding_note(surface, solution)) if note
        ),
        at_fault=frozenset(inputs.numbers.faults[index]),
    )


def _speed_note(track: FocusTrack, index: int) -> str:
    """A sentence where the hand on the focus ring is too slow; or empty."""
    is_slow = track.slowed_w[index] > _SAME_W * max(float(track.requested_w[index]), track.plane(index).w0)
    return "the hand on the focus ring is slower than the focus that is asked for" if is_slow else ""


def _crowding_note(surface: FocalSurface | None, solution: FocusSolution) -> str:
    """A sentence where more points count than a focal surface has controls; or empty."""
    if surface is None or surface.controls is None or solution.states.count("used") <= MAX_CONTROLS:
        return ""
    return f"a focal surface has room for {MAX_CONTROLS} focus points, so only the strongest shape it"


def _surface(
    inputs: FocusInputs, camera: Camera, plane: FocalPlane, track: FocusTrack, index: int
) -> FocalSurface | None:
    """Build the focal surface; None where it is the upright plane at the camera's focus distance."""
    focus, frame = inputs.focus[index], _frame(camera)
    surface = FocalSurface(plane, halves=_halves(inputs, index, frame))
    if focus.mode == "surface" and focus.expressive > 0:
        growth = focus_law(camera).coc_slope_mm_m(np.array([plane.w0]))
        controls = focal_controls(
            _surface_points(inputs, track, index),
            plane=plane,
            coc_slope_mm_m=float(growth[0]),
            frame_width=frame.width,
            exponent=focus.surface_exponent,
            near_priority=focus.near_priority,
            sides=track.sides[index],
        )
        surface = replace(surface, controls=controls, blend=focus.expressive)
    if focus.field_offsets:
        drawn = np.array(focus.field_offsets, np.float64)
        bent = bends(
            frame.slopes(drawn[:, :2]),
            focus.expressive * drawn[:, 2],
            surface=surface,
            focal_length_mm=camera.focal_length_mm,
            exponent=focus.surface_exponent,
        )
        surface = replace(surface, bends=bent)
    return None if surface.is_plane and plane.is_upright and plane.w0 >= 0 else surface


def _frame(camera: Camera) -> Frame:
    """The film gate in slopes; a lens that breathes makes it narrower as it makes its picture larger."""
    stretch = PinholeView.from_camera(camera, 1, 1).fx * camera.horizontal_aperture_mm / camera.focal_length_mm
    return Frame.from_camera(camera, stretch)


def _surface_points(inputs: FocusInputs, track: FocusTrack, index: int) -> SurfacePoints:
    t = inputs.targets
    with np.errstate(divide="ignore"):
        depths_m = 1 / track.points_w[index]
    return SurfacePoints(
        names=t.names,
        slopes=t.slopes[index],
        depths_m=depths_m,
        weights=t.weights[index],
        soft=t.is_soft,
        blurs_mm=t.blurs_mm[index],
        surface_offsets_m=t.surface_offsets_m[index],
        falloffs=t.falloffs[index],
        extents=t.extents[index],
        fades=track.fades[index],
        field_shifts_w=t.field_shifts_w[index],
    )


def _halves(inputs: FocusInputs, index: int, frame: Frame) -> tuple[HalfLens, ...]:
    d = inputs.diopters[index]
    unit = inputs.metres_in_a_unit
    halves = (
        (d.offset1, d.width1, d.focus_distance1 * unit),
        (d.offset2, d.width2, d.focus_distance2 * unit),
    )
    return half_lenses(halves[: max(0, d.count)], math.radians(d.angle), frame)


def focus_without_points(camera: Camera) -> FocusedCamera:
    """Focus a camera that is no prim, and so has no focus points.

    Args:
        camera: such as one that frames the whole stage.
    """
    return FocusedCamera(camera, FocusData(), (), (), np.empty((0, 3)), {}, _manual_solution(camera, 0))


def _manual_solution(camera: Camera, point_count: int) -> FocusSolution:
    by_hand: PointState = "by_hand"
    return FocusSolution(
        focus_distance_m=camera.focus_distance_m or math.inf,
        source="camera",
        reason="the focus mode is manual, so the camera's own focus distance is kept",
        shares=(0.0,) * point_count,
        states=(by_hand,) * point_count,
    )
