"""Depth of field, in the renderer's own terms: near and far limit, and the hyperfocal distance.

Everything follows from the one equation (DESIGN section 2). A point at inverse depth ``w`` is imaged, by a lens of
focal length ``f`` and entrance-pupil diameter ``A = f / N`` that is focused at inverse depth ``w_f``, as a disk of
diameter

    c = f · A · |w − w_f|

on the film. So the limits of depth of field lie at ``w_f ± C / (f · A)`` for the largest diameter ``C`` that still
counts as sharp, and the hyperfocal distance, the focus whose far limit just reaches infinity, is ``h = f · A / C``.

How this differs from the textbook (Ray, *Applied Photographic Optics*, 3rd ed. 2002, ch. 22). A real lens that
focuses by moving images on a film plane at ``v = f·s / (s − f)`` behind it, not at ``f``: its picture grows when it
focuses closer (it breathes), and so do its disks of confusion, which gives ``H = f² / (N·C) + f``. USD cameras keep the
field of view that ``focalLength`` and the apertures say, whatever the focus, so the default here has ``f`` in place of
``v`` and no ``+ f``. With ``breathing``, or ``lens:circleDistance`` at imageDistance, the image distance is the physical
one and the textbook's formulas come out exactly. It is equation 5.3 of Kyaw (2013), ``C = v²·|S − u| / (u·S·N'·P)``, in which
``v / (N'·P)`` is ``A``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from render.errors import SettingsError

GATE_DIAGONALS_PER_LIMIT = 1500.0
"""Film-gate diagonal over the largest disk that counts as sharp.

The customary ``d / 1500``: 0.029 mm on a 36 × 24 mm gate, 0.021 mm on Super 35, in line with the 1/1000 inch
(0.025 mm) of cinematographers' tables for 35 mm film. Others hold ``d / 1730`` (the so-called Zeiss formula). It comes
from a person who resolves 5 line pairs for each mm on a print 25 cm wide seen from 25 cm (Ray 2002, ch. 22).
"""


@dataclass(frozen=True)
class DepthOfField:
    """Limits of sharpness.

    Attributes:
        near_m: nearest depth that is sharp; 0 for a pinhole.
        far_m: farthest depth that is sharp; may be infinite.
        hyperfocal_m: the focus distance from which on the far limit is infinite; 0 for a pinhole.
    """

    near_m: float
    far_m: float
    hyperfocal_m: float


def default_coc_limit_mm(horizontal_aperture_mm: float, vertical_aperture_mm: float) -> float:
    """The largest circle of confusion that counts as sharp, as a diameter on the film in mm.

    Args:
        horizontal_aperture_mm: width of the film gate.
        vertical_aperture_mm: its height.

    Raises:
        SettingsError: an aperture is not above 0.
    """
    _check("horizontal aperture in mm", horizontal_aperture_mm, horizontal_aperture_mm > 0)
    _check("vertical aperture in mm", vertical_aperture_mm, vertical_aperture_mm > 0)
    return math.hypot(horizontal_aperture_mm, vertical_aperture_mm) / GATE_DIAGONALS_PER_LIMIT


def coc_slope_mm_m(
    focal_length_mm: float, f_stop: float, focus_distance_m: float = math.inf, *, breathing: bool = False
) -> float:
    """Slope of the circle of confusion over inverse depth: its diameter on the film is this × ``|w − w_f|``.

    Args:
        focal_length_mm: focal length.
        f_stop: f-number; 0 is a pinhole, whose circle never grows.
        focus_distance_m: used only where the lens breathes; 0 or infinite is infinity.
        breathing: use the physical image distance ``f·s / (s − f)`` in place of ``f``.

    Returns:
        ``v · A`` in mm (on the film) × m (of the pupil).

    Raises:
        SettingsError: an argument is not finite or out of range, or a breathing lens is focused nearer than its own
            focal length.
    """
    _check("focal length in mm", focal_length_mm, focal_length_mm > 0 and math.isfinite(focal_length_mm))
    _check("f-number", f_stop, f_stop >= 0 and math.isfinite(f_stop))
    _check("focus distance in m", focus_distance_m, focus_distance_m >= 0)
    if f_stop == 0:
        return 0.0
    image_distance_mm = focal_length_mm
    if breathing and 0 < focus_distance_m < math.inf:
        focus_mm = focus_distance_m * 1000
        if focus_mm <= focal_length_mm:
            raise SettingsError(
                f"a breathing lens of {focal_length_mm:g} mm forms no image of what is {focus_distance_m:g} m away:"
                " expected a focus distance beyond the focal length",
                code="bad_focus_distance",
            )
        image_distance_mm = focal_length_mm * focus_mm / (focus_mm - focal_length_mm)
    return image_distance_mm * focal_length_mm / f_stop / 1000


def depth_of_field(
    focal_length_mm: float, f_stop: float, focus_distance_m: float, coc_limit_mm: float, *, breathing: bool = False
) -> DepthOfField:
    """Near limit, far limit and hyperfocal distance of a thin lens.

    Args:
        focal_length_mm: focal length.
        f_stop: f-number; 0 is a pinhole, for which all is sharp.
        focus_distance_m: depth of the plane of focus, from the entrance pupil; 0 or infinite is infinity, as in
            `render.model.camera.Camera`.
        coc_limit_mm: largest diameter on the film that counts as sharp (`default_coc_limit_mm`).
        breathing: whether the picture grows as the lens focuses closer (see the head of this module).

    Returns:
        Distances along the axis, from the entrance pupil, in metres.

    Raises:
        SettingsError: an argument is not a number or out of range, or a breathing lens is focused nearer than its own
            focal length.
    """
    _check("circle of confusion limit in mm", coc_limit_mm, coc_limit_mm > 0 and math.isfinite(coc_limit_mm))
    slope_mm_m = coc_slope_mm_m(focal_length_mm, f_stop, focus_distance_m, breathing=breathing)
    if slope_mm_m == 0:
        return DepthOfField(0.0, math.inf, 0.0)
    focus_w = 1 / focus_distance_m if focus_distance_m > 0 else 0.0
    reach_w = coc_limit_mm / slope_mm_m
    hyperfocal_m = coc_slope_mm_m(focal_length_mm, f_stop) / coc_limit_mm
    return DepthOfField(
        near_m=1 / (focus_w + reach_w),
        far_m=1 / (focus_w - reach_w) if focus_w > reach_w else math.inf,
        hyperfocal_m=hyperfocal_m + focal_length_mm / 1000 if breathing else hyperfocal_m,
    )


def _check(name: str, value: float, good: bool) -> None:
    if not good:
        raise SettingsError(f"the {name} must be a number in range, but it is {value:g}", code="bad_lens_setting")
