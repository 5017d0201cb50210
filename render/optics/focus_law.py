"""Dependence of a camera's lens on its focus: growth of the circle of confusion, size of the pupil, focus range.

Glass is treated to first order, at the d line: the position of its group decides the focus, the size of the entrance pupil and
the size of the picture. So the law holds at any f-number, which is that of the real beam from infinity
(`render.optics.prescription.f_numbers`); how the beam changes with focus is first-order. All of it scales with the focal length.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import Prescription
from render.model.lens_law import NO_LIMIT_W, LensLaw
from render.optics.prescription.f_numbers import widest_f_number
from render.optics.prescription.focus_mechanism import LONGEST_WAY, FocusMechanism
from render.optics.prescription.focusing import focus_across
from render.optics.prescription.mounting import has_surfaces, scale_to
from render.optics.prescription.paraxial import entrance_pupil
from render.optics.prescription.zooming import zoom_of

_STEPS = 33
_AT_INFINITY_W = 1e-9  # of the nearest focus of a lens that does not focus at all
_ZOOM_STEP = 2e-3  # logarithm of the focal length
_LIFE_SIZE_SHARE = 0.1  # of a picture at the close focus of a lens that has none engraved, as most lenses have it
_PLACES = 257  # of the group that focuses, from rest to the end of its way


def focus_laws(cameras: Sequence[Camera]) -> LensLaw:
    """The laws of cameras, such as one over its frames, as one.

    Args:
        cameras: at least one.

    Raises:
        InputError: a lens has a prescription that is not a lens.
    """
    return LensLaw.stacked([focus_law(camera) for camera in cameras])


def focus_law(camera: Camera) -> LensLaw:
    """Focus law of a camera's lens at its f-number; the camera's own focus does not matter.

    The nearest focus is the one engraved on the lens, where one is; else glass reaches as far as it can move, but a lens that
    moves as a whole no farther than two focal lengths.

    Args:
        camera: with its lens.

    Raises:
        InputError: the lens has a prescription that is not a lens.
    """
    if has_surfaces(camera):
        return _law_of_glass(camera)
    return LensLaw.thin(
        camera.focal_length_mm, camera.f_stop, breathing=_by_image_distance(camera), near_w=_engraved_thin_w(camera)
    )


@dataclass(frozen=True)
class RingScale:
    """Distances on the focus ring of a lens, which ends at infinity and at its close focus.

    Attributes:
        close_focus_m: depth of the close focus, from the entrance pupil.
        to_film_mm: from the entrance pupil to the film, focused at infinity and at the close focus.
    """

    close_focus_m: float
    to_film_mm: tuple[float, float]


def ring_scale(camera: Camera) -> RingScale:
    """Read the scale of a camera's focus ring.

    The close focus is the one engraved on the lens. A lens without ends at a tenth of life size, or before it where its glass
    focuses no nearer.

    Args:
        camera: with its lens; its own focus does not matter.

    Raises:
        InputError: the lens has a prescription that is not a lens.
    """
    focal_m, w = camera.focal_length_mm / 1000, float(focus_law(camera).near_w[0])
    if camera.lens.close_focus_m <= 0:
        w = min(w, 1 / (focal_m * (1 + 1 / _LIFE_SIZE_SHARE)))
    if has_surfaces(camera):
        way, scale = _way_of(camera)
        infinity_mm, close_mm = np.interp([0.0, w * scale / 1000], way.nearness, way.to_film_mm * scale).tolist()
    else:
        infinity_mm, close_mm = camera.focal_length_mm, 1000 / max(1 / focal_m - w, 1e-9)
    return RingScale(1 / w, (infinity_mm, close_mm))


def _by_image_distance(camera: Camera) -> bool:
    """Whether circles of confusion grow with the image distance: ``C = v·A·|w − w_f|`` (Kyaw 2013, equation 5.3).

    The equation is ``v²·|S − u| / (u·S·N'·P)`` with ``v / (N'·P)`` the diameter A of the entrance pupil. Its form 5.4 for distant
    scenes, with the f-number N for N' and P = 1, is larger by v/f.
    """
    return camera.breathing or camera.circles_by_image_distance


@dataclass(frozen=True, eq=False)
class _Way:
    """The way of what focuses a lens, from infinity to the nearest focus that it reaches: ``(p,)`` each.

    Attributes:
        nearness: 1/mm, from the entrance pupil, rising from 0.
        pupils: diameter of the entrance pupil over that of the stop.
        scales_mm: image scale.
        to_film_mm: from the entrance pupil to the film.
        widest_f_stop: f-number of the real beam wide open.
    """

    nearness: DoubleArray
    pupils: DoubleArray
    scales_mm: DoubleArray
    to_film_mm: DoubleArray
    widest_f_stop: float


def _law_of_glass(camera: Camera) -> LensLaw:
    focal_mm = camera.focal_length_mm
    way, scale = _way_of(camera)
    marked_w = _engraved_w(way, scale, camera.lens.close_focus_m)
    near_w = max(min(1000 * float(way.nearness[-1]) / scale, marked_w), _AT_INFINITY_W)
    w = np.linspace(0.0, near_w, _STEPS)
    pupils, scales_mm = (
        np.interp(w * scale / 1000, way.nearness, column) for column in (way.pupils, way.scales_mm * scale)
    )
    radii_at_f1_mm = focal_mm / 2 * pupils / way.pupils[0]
    slopes = (scales_mm if _by_image_distance(camera) else focal_mm) * 2 * radii_at_f1_mm / 1000
    return LensLaw(
        slopes_at_f1_mm_m=slopes[None],
        pupils_at_f1_mm=radii_at_f1_mm[None],
        f_stops=np.array([max(camera.f_stop, way.widest_f_stop)]),
        near_w=np.array([near_w]),
        far_w=np.zeros(1),
        widest_f_stops=np.array([way.widest_f_stop]),
    )


def _way_of(camera: Camera) -> tuple[_Way, float]:
    """The way of a lens alike, and how many times larger the camera's is."""
    prescription = camera.lens.prescription
    if prescription is None:
        raise ValueError(f"the lens of camera {camera.path} has no surfaces")
    like_mm = round_focal_length(prescription, camera.focal_length_mm)  # few lenses for a pull, each scaled a little
    scale = camera.focal_length_mm / like_mm
    return _way(prescription, like_mm, _round_length(camera.covered_mm / scale)), scale


@lru_cache(maxsize=64)
def _way(prescription: Prescription, focal_length_mm: float, diagonal_mm: float) -> _Way:
    glass = scale_to(prescription, focal_length_mm, diagonal_mm / 2)
    mechanism = FocusMechanism.from_prescription(glass)
    low, high = mechanism.travel()
    ends = sorted((max(low, -LONGEST_WAY * focal_length_mm), high), key=abs)
    return max((_way_to(mechanism, end) for end in ends), key=lambda way: float(way.nearness[-1]))


def _way_to(mechanism: FocusMechanism, end_mm: float) -> _Way:
    """The part of the way to an end on which the focus comes nearer."""
    rows: list[tuple[float, float, float, float]] = []
    for shift_mm in np.linspace(0.0, end_mm, _PLACES):
        seen = mechanism.film_through_lens(float(shift_mm))
        nearness = seen.nearness if rows else 0.0  # at rest it is focused at infinity, however it is rounded
        if nearness is None or (rows and nearness <= rows[-1][0]):
            break
        moved = mechanism.shifted_vertices(float(shift_mm))
        if rows and not _focuses_across(mechanism, moved, nearness):
            break
        pupil_mm, pupil = entrance_pupil(replace(mechanism.system, vertices_mm=moved), mechanism.stop)
        rows.append((nearness, abs(pupil), seen.scale_mm, mechanism.film_mm - pupil_mm))
    nearness, pupils, scales_mm, to_film_mm = np.array(rows).T
    return _Way(nearness, pupils, scales_mm, to_film_mm, widest_f_number(mechanism.prescription))


def _focuses_across(mechanism: FocusMechanism, moved_mm: DoubleArray, nearness: float) -> bool:
    """Whether a lens that is sharp from top to bottom can also be from side to side, where cylinders move for that."""
    if mechanism.prescription.focus_group_across is None:
        return True
    try:
        focus_across(mechanism, moved_mm, nearness, 0.0, "paraxial")
    except SettingsError:
        return False
    return True


def round_focal_length(prescription: Prescription, focal_length_mm: float) -> float:
    """Focal length to two digits; of a zoom, whose groups stand elsewhere at each, to a share of 0.2 % within its range."""
    zoom = zoom_of(prescription)
    if zoom is None or not zoom.holds(focal_length_mm):
        return _round_length(focal_length_mm)
    rounded = math.exp(round(math.log(focal_length_mm) / _ZOOM_STEP) * _ZOOM_STEP)
    return min(max(rounded, zoom.shortest_mm), zoom.longest_mm)


def _round_length(length_mm: float) -> float:
    return float(f"{length_mm:.2g}")


def _engraved_w(way: _Way, scale: float, close_focus_m: float) -> float:
    """Inverse depth, from the entrance pupil, of the close focus engraved from the film."""
    if close_focus_m <= 0 or len(way.nearness) < 2:
        return NO_LIMIT_W
    before_film_mm = (1 / way.nearness[1:] + way.to_film_mm[1:]) * scale  # falls, then may rise again past 1:1
    nearest = int(np.argmin(before_film_mm)) + 1
    if 1000 * close_focus_m <= before_film_mm[nearest - 1]:
        return NO_LIMIT_W
    # what is engraved less the nearness is smooth even at infinity: D·nearness = 1 + to_film·nearness
    missing = 1000 * close_focus_m / scale * way.nearness - 1 - way.to_film_mm * way.nearness
    at = float(np.interp(0.0, missing[: nearest + 1], way.nearness[: nearest + 1]))
    return 1000 * at / scale


def _engraved_thin_w(camera: Camera) -> float:
    """The same of a thin lens: ``d + v = D`` with ``1/v = 1/f − 1/d``."""
    engraved_m, focal_m = camera.lens.close_focus_m, camera.focal_length_mm / 1000
    if engraved_m <= 4 * focal_m:  # at less, no lens of that focal length has an image on the film
        return 1 / (2 * focal_m) if engraved_m > 0 else float("inf")
    return 2 / (engraved_m + float(np.sqrt(engraved_m**2 - 4 * engraved_m * focal_m)))
