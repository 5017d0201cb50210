"""Distortion along chief rays: the slope seen at a place of the picture, and the place where a point of the world appears.

Places are slopes of the ideal lens, ``(x - cx) / fx``; a lens with distortion shows another slope there. Both grow together, so
either follows from the other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.data_sheet import DataSheet
from render.model.lens import SeidelErrors
from render.optics.data_sheet import seen_slopes
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.meridians import turned
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.prescription.principal_rays import principal_rays
from render.optics.thin_lens import focus_w
from render.optics.view import PinholeView

_SAMPLES = 257
_BISECTIONS = 50


@dataclass(frozen=True, eq=False)
class ChiefRays:
    """Chief rays of a lens, in the plane of focus.

    Attributes:
        ideal: ``(n,)`` slopes from 0 that the picture's places stand for, growing.
        seen: ``(n,)`` slope in object space seen there, growing, without the squeeze.
        squeeze: anamorphic squeeze, by which distortion is narrower from side to side.
        seen_across: ``(n,)`` slope seen from side to side, of a lens with cylinders: off its two axes, each side's distortion is
            taken for that on its own axis at the same height.
    """

    ideal: DoubleArray
    seen: DoubleArray
    squeeze: float = 1.0
    seen_across: DoubleArray | None = None

    def undistort_slopes(self, slopes: DoubleArray) -> DoubleArray:
        """Return the object-space slopes imaged at picture slopes ``(..., 2)``. Distortion is constant beyond the last ray."""
        return np.asarray(slopes * self.stretch(np.linalg.norm(slopes, axis=-1)))

    def distort_slopes(self, slopes: DoubleArray) -> DoubleArray:
        """Return the picture slopes at which object-space slopes ``(..., 2)`` are imaged."""
        low = np.zeros(np.shape(slopes)[:-1])
        # where the distortion stays, the height follows at once; else it lies before the last chief ray
        high = np.linalg.norm(slopes / self.stretch(low + self.ideal[-1]), axis=-1)
        high = np.where(high < self.ideal[-1], self.ideal[-1], high)
        for _ in range(_BISECTIONS):
            middle = (low + high) / 2
            is_short = np.linalg.norm(slopes / self.stretch(middle), axis=-1) > middle
            low, high = np.where(is_short, middle, low), np.where(is_short, high, middle)
        return np.asarray(slopes / self.stretch((low + high) / 2))

    def stretch(self, heights: DoubleArray) -> DoubleArray:
        """Ratio ``(..., 2)`` of seen slope to picture slope along x and y, at the heights ``(...)``."""
        inside = np.clip(heights, 1e-9 * self.ideal[-1], self.ideal[-1])
        ratio = np.interp(inside, self.ideal, self.seen) / inside
        if self.seen_across is not None:
            return np.stack([np.interp(inside, self.ideal, self.seen_across) / inside, ratio], axis=-1)
        return np.stack([1 + (ratio - 1) / self.squeeze, ratio], axis=-1)


def chief_rays(camera: Camera) -> ChiefRays | None:
    """Chief rays of the camera's lens; None where they are straight.

    A height field's distortion is that of the lens without it.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance.
    """
    scale = camera.lens.scales.distortion
    if has_surfaces(camera) and camera.lens.has_cylinders:
        return _through_cylinders(mount_lens(camera), focus_w(camera), camera.lens.squeeze)
    if has_surfaces(camera):
        rays = _through_surfaces(mount_lens(camera), focus_w(camera))
    elif camera.lens.model == "seidel" and camera.lens.seidel is not None and camera.f_stop > 0:
        rays = _through_thin_lens(camera.lens.seidel, camera.focal_length_mm)
    elif camera.lens.model == "dataSheet" and camera.lens.data_sheet is not None and camera.f_stop > 0:
        rays = _by_data_sheet(camera.lens.data_sheet, camera.focal_length_mm)
    else:
        return None
    seen = np.maximum.accumulate(rays.ideal + scale * (rays.seen - rays.ideal))
    return ChiefRays(rays.ideal, seen, camera.lens.squeeze)


@lru_cache(maxsize=32)
def _through_surfaces(lens: FocusedLens, focus_w_per_m: float) -> ChiefRays:
    rays = principal_rays(lens)
    seen = rays.slopes + rays.pupil_mm / 1000 * focus_w_per_m
    return ChiefRays(rays.heights_mm / lens.image_scale_mm, np.maximum.accumulate(seen))


@lru_cache(maxsize=32)
def _through_cylinders(lens: FocusedLens, focus_w_per_m: float, squeeze: float) -> ChiefRays:
    """Chief rays along both axes, as far as both reach; factors on distortion do not act on them."""
    own = _through_surfaces(lens, focus_w_per_m)
    across = _through_surfaces(replace(lens, prescription=turned(lens.prescription)), focus_w_per_m)
    stretched = across.ideal * squeeze
    ideal = own.ideal[own.ideal <= stretched[-1]]
    seen_across = np.maximum.accumulate(np.interp(ideal, stretched, across.seen))
    return ChiefRays(ideal, own.seen[: len(ideal)], seen_across=seen_across)


def _through_thin_lens(errors: SeidelErrors, focal_length_mm: float) -> ChiefRays:
    ideal = np.linspace(0.0, 4.0, _SAMPLES)
    reference_m = focal_length_mm / (2000 * errors.reference_f_stop)
    height = ideal * focal_length_mm / errors.reference_height_mm
    return ChiefRays(ideal, ideal + errors.w311 * height**3 * D_LINE_NM * 1e-9 / reference_m)


def _by_data_sheet(sheet: DataSheet, focal_length_mm: float) -> ChiefRays:
    last = sheet.heights_mm[-1] / focal_length_mm
    ideal = np.append(np.linspace(0.0, last, _SAMPLES), [last + 4.0] if last else [4.0])
    return ChiefRays(ideal, seen_slopes(sheet, ideal * focal_length_mm, focal_length_mm))


def undistort_position(view: PinholeView, camera: Camera, x: float, y: float) -> tuple[float, float]:
    """Return the pixel position in an undistorted picture of what the camera's lens images at (x, y)."""
    chief = chief_rays(camera)
    if chief is None:
        return x, y
    slope_x, slope_y = chief.undistort_slopes(np.array([(x - view.cx) / view.fx, (y - view.cy) / view.fy]))
    return float(view.cx + view.fx * slope_x), float(view.cy + view.fy * slope_y)


def distort_positions(view: PinholeView, camera: Camera, places: DoubleArray) -> DoubleArray:
    """Return the pixel positions in the camera's picture of positions ``(n, 2)`` in an undistorted picture; NaN stays NaN."""
    chief = chief_rays(camera) if len(places) else None
    if chief is None:
        return places
    centre, focal = np.array([view.cx, view.cy]), np.array([view.fx, view.fy])
    return np.asarray(centre + focal * chief.distort_slopes((places - centre) / focal))
