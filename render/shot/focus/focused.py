"""Where a camera's focus points stand at one time, and the focus that they ask for."""

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
from render.shot.focus.focus_reading import FocusReading
from render.shot.focus.focus_request import coc_limit_mm
from render.shot.focus.focus_solving import FocusTrack
from render.trace.field_focus import FieldFocus, field_focus
from usd_schemas import FocusData, FocusPoint

_ON_THE_WAY = 1e-4  # share of w: less than that off is there


@dataclass(frozen=True, eq=False)
class Focused:
    """A camera at one time, its focus solved.

    Attributes:
        camera: with its own film gate, focused at the solution.
        focus: what the camera asks of the focus.
        points: its focus points.
        targets: the same points as the lens sees them.
        positions_m: ``(k, 3)`` where they stand in the world; NaN where the target is missing.
        problems: why points have no place, by name.
        solution: whose focus it is, and why.
        note: what could not be done as asked, in a sentence; or empty.
        at_fault: names of points that say what has no meaning.
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
        """What focusing does to the lens."""
        return focus_law(self.camera).at_stops(self.camera.f_stop)

    @cached_property
    def _field(self) -> FieldFocus | None:
        """Where the lens is sharpest beside its focal surface."""
        return field_focus(self.camera)

    @property
    def depth_of_field(self) -> DepthOfField:
        """What is sharp before and behind the plane of focus on the view axis. What a surface bends from it is told by place."""
        plane = focal_surface(self.camera).plane
        return self._depth_of_field(plane.w0, float(self.law.coc_slope_mm_m(np.array([plane.w0]))[0]))

    def depth_of_field_at(self, slope: tuple[float, float]) -> DepthOfField:
        """What is sharp before and behind the focal surface at a place of the picture.

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
        limit_at_f1 = self.coc_limit_mm * self.camera.f_stop
        return DepthOfField(
            near_m=1 / (w_f + reach) if w_f + reach > 0 else math.inf,
            far_m=1 / (w_f - reach) if w_f > reach else math.inf,
            hyperfocal_m=(1 - limit_at_f1 * pitch) / (limit_at_f1 * start),
        )

    def focused_m_at(self, slope: tuple[float, float]) -> float:
        """Depth of the focal surface at a place of the picture; infinite where it is passed at its vanishing line.

        Args:
            slope: of the place in object space, x right and y up.
        """
        w_f = float(self._sharpness(np.array(slope))[0])
        return 1 / w_f if w_f > 0 else math.inf

    def coc_mm(self, depth_m: float, slope: tuple[float, float] = (0.0, 0.0)) -> float:
        """Diameter on the film of the circle of confusion of a point; NaN where it is not in front of the camera.

        Args:
            depth_m: its depth.
            slope: where it stands, in slopes of object space, x right and y up.
        """
        return float(self.cocs_mm(np.array([depth_m]), np.array([slope]))[0])

    def cocs_mm(self, depths_m: DoubleArray, slopes: DoubleArray) -> DoubleArray:
        """``(k,)`` the same of k points.

        Args:
            depths_m: ``(k,)``.
            slopes: ``(k, 2)``; what they are where a depth is not in front of the camera does not matter.
        """
        ahead = depths_m > 0
        w_f, growth = self._sharpness(np.where(ahead[:, None], slopes, 0.0))
        return np.where(ahead, growth * np.abs(1 / np.where(ahead, depths_m, 1.0) - w_f), math.nan)

    def _sharpness(self, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """``(...)`` where places ``(..., 2)`` are focused, 1/m, and how fast the circle of confusion grows from there, mm·m."""
        surface = focal_surface(self.camera)
        w, pupil = focused_at(surface, slopes)
        growth = self.law.coc_slope_mm_m(np.array([surface.plane.w0]))[0]
        if self._field is None:
            return w, np.asarray(growth * pupil)
        shift, seen = self._field.at(slopes)
        return w + shift / pupil, np.asarray(growth * pupil * seen)


def focused(reading: FocusReading, track: FocusTrack, index: int) -> Focused:
    """A camera at one time of what was read.

    Args:
        reading: of the camera.
        track: its focus at the same times.
        index: of the time.

    Raises:
        CameraError: a number of the camera or of a point has no meaning.
    """
    plane, solution = track.plane(index), track.solutions.at(index)
    wanted, w0 = float(track.wanted_w[index]), plane.w0
    if abs(wanted - w0) > _ON_THE_WAY * max(wanted, w0):
        to = f"{1 / wanted:.4g} m" if wanted > 0 else "infinity"
        solution = replace(solution, reason=f"{solution.reason}, on the way to {to}")
    own = reading.cameras[index]
    distance_m = 1 / w0 if w0 > 0 else math.inf
    if w0 == focus_w(own):  # to the last digit, as it is authored
        distance_m = own.focus_distance_m or math.inf
    solution = replace(solution, focus_distance_m=distance_m)
    camera = replace(own, focus_distance_m=distance_m, f_stop=float(track.f_stops[index]))
    try:
        surface = _surface(reading, camera, plane, track, index)
    except SettingsError as error:  # the numbers are the shot's, not the caller's
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error
    return Focused(
        camera=replace(camera, focal_surface=surface),
        focus=reading.focus[index],
        points=reading.points[index],
        targets=reading.targets.at(index),
        positions_m=reading.positions_m[index],
        problems=reading.problems[index],
        solution=solution,
        note="; ".join(
            note for note in (track.notes[index], _slowness(track, index), _crowding(surface, solution)) if note
        ),
        at_fault=frozenset(reading.numbers.faults[index]),
    )


def _slowness(track: FocusTrack, index: int) -> str:
    """That the hand on the focus ring cannot be as fast as it would have to be, in a sentence; or empty."""
    is_slow = track.slowed_w[index] > _ON_THE_WAY * max(float(track.wanted_w[index]), track.plane(index).w0)
    return "the hand on the focus ring is slower than the focus that is asked for" if is_slow else ""


def _crowding(surface: FocalSurface | None, solution: FocusSolution) -> str:
    """That a focal surface has no room for all points that count, in a sentence; or empty."""
    if surface is None or surface.controls is None or solution.states.count("used") <= MAX_CONTROLS:
        return ""
    return f"a focal surface has room for {MAX_CONTROLS} focus points, so only the strongest shape it"


def _surface(
    reading: FocusReading, camera: Camera, plane: FocalPlane, track: FocusTrack, index: int
) -> FocalSurface | None:
    """The focal surface; None where it is the upright plane at the camera's focus distance."""
    focus, frame = reading.focus[index], _frame(camera)
    surface = FocalSurface(plane, halves=_halves(reading, index, frame))
    if focus.mode == "surface" and focus.expressive > 0:
        growth = focus_law(camera).at_stops(camera.f_stop).coc_slope_mm_m(np.array([plane.w0]))
        controls = focal_controls(
            _surface_points(reading, track, index),
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
    """The gate in slopes, as much narrower as a lens that breathes makes its picture larger."""
    stretch = PinholeView.from_camera(camera, 1, 1).fx * camera.horizontal_aperture_mm / camera.focal_length_mm
    return Frame.of(camera, stretch)


def _surface_points(reading: FocusReading, track: FocusTrack, index: int) -> SurfacePoints:
    t = reading.targets
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


def _halves(reading: FocusReading, index: int, frame: Frame) -> tuple[HalfLens, ...]:
    d = reading.diopters[index]
    unit = reading.metres_in_a_unit
    both = (
        (d.offset1, d.width1, d.focus_distance1 * unit),
        (d.offset2, d.width2, d.focus_distance2 * unit),
    )
    return half_lenses(both[: max(0, d.count)], math.radians(d.angle), frame)


def without_points(camera: Camera) -> Focused:
    """A camera that is no prim, and so has no focus points.

    Args:
        camera: such as one that frames the whole stage.
    """
    return Focused(camera, FocusData(), (), (), np.empty((0, 3)), {}, _kept_by_hand(camera, 0))


def _kept_by_hand(camera: Camera, point_count: int) -> FocusSolution:
    by_hand: PointState = "by_hand"
    return FocusSolution(
        focus_distance_m=camera.focus_distance_m or math.inf,
        source="camera",
        reason="the focus mode is manual, so the camera's own focus distance is kept",
        shares=(0.0,) * point_count,
        states=(by_hand,) * point_count,
    )
