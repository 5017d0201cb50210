"""Lenses that are described by measurements, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from render.errors import SettingsError

MAX_SHEET_MM = 1000.0
"""Limit on a data sheet's heights, blurs and focus shifts: six times the half diagonal of 8 x 10 inch film."""
MAX_F_STOP = 1000.0
_FINEST_MM = 1e-6
_MM = f"from {-MAX_SHEET_MM:g} to {MAX_SHEET_MM:g} mm"

_TABLES = {
    "distortion": (-0.95, 10.0, "from -0.95 to 10"),
    "light": (0.0, 2.0, "from 0 to 2"),
    "sagittal_blur_mm": (0.0, MAX_SHEET_MM, f"from 0 to {MAX_SHEET_MM:g} mm"),
    "tangential_blur_mm": (0.0, MAX_SHEET_MM, f"from 0 to {MAX_SHEET_MM:g} mm"),
    "spherical": (-1.0, 1.0, "from -1 to 1"),
    "coma_mm": (-MAX_SHEET_MM, MAX_SHEET_MM, _MM),
    "field_curvature_mm": (-MAX_SHEET_MM, MAX_SHEET_MM, _MM),
    "lateral_color_mm": (-MAX_SHEET_MM, MAX_SHEET_MM, _MM),
    "axial_color_mm": (-MAX_SHEET_MM, MAX_SHEET_MM, _MM),
}


@dataclass(frozen=True)
class DataSheet:
    """Lens described by measurements: its errors over the height in the picture (Kyaw 2013, section 7.2).

    A table has an entry for each height, or none where the error is not there (light: where it is even). In between they are
    joined smoothly, and beyond the last height they stay.

    Attributes:
        heights_mm: image heights on the film, from 0 outward.
        distortion: share by which the image is farther out than an ideal lens's: negative is barrel-shaped.
        light: illumination of the film over that on the axis, from all causes together.
        sagittal_blur_mm: standard deviation, across the radius, of the light of a point in the plane of focus: of all errors of
            one colour together.
        tangential_blur_mm: the same along the radius.
        spherical: share of the blur's spread that is spherical aberration, -1 to 1: positive gives the disc behind the focus a
            bright edge, negative a bright middle. What is left of the blur favours neither half of the disc.
        coma_mm: length of coma's flare along the radius, positive outward.
        field_curvature_mm: distance of the sharp image before the film.
        lateral_color_mm: image height at 650 nm less that at 475 nm.
        axial_color_mm: focus at 650 nm less focus at 475 nm, along the axis behind the lens.
        f_stop: at which it was measured; 0 takes the tables as they are at any.
    """

    heights_mm: tuple[float, ...]
    distortion: tuple[float, ...] = ()
    light: tuple[float, ...] = ()
    sagittal_blur_mm: tuple[float, ...] = ()
    tangential_blur_mm: tuple[float, ...] = ()
    spherical: tuple[float, ...] = ()
    coma_mm: tuple[float, ...] = ()
    field_curvature_mm: tuple[float, ...] = ()
    lateral_color_mm: tuple[float, ...] = ()
    axial_color_mm: tuple[float, ...] = ()
    f_stop: float = 0.0

    def __post_init__(self) -> None:
        """Raises `SettingsError` where the tables do not belong together, or no lens has such errors."""
        heights = self.heights_mm
        if not heights or heights[0] != 0 or not all(a < b for a, b in pairwise(heights)):
            raise SettingsError(f"a data sheet's image heights must increase from 0, got {_listed(heights)}")
        if not heights[-1] <= MAX_SHEET_MM:
            raise SettingsError(
                f"a data sheet's image heights must be at most {MAX_SHEET_MM:g} mm, got {heights[-1]:g} mm"
            )
        closest = min((b - a for a, b in pairwise(heights)), default=_FINEST_MM)
        if closest < _FINEST_MM:
            raise SettingsError(
                f"a data sheet's image heights must be at least {_FINEST_MM:g} mm apart, got two {closest:g} mm apart"
            )
        if not 0 <= self.f_stop <= MAX_F_STOP:
            raise SettingsError(f"a data sheet's f-number must be from 0 to {MAX_F_STOP:g}, got {self.f_stop:g}")
        for name, (least, most, expected) in _TABLES.items():
            values = getattr(self, name)
            if len(values) not in (0, len(heights)):
                raise SettingsError(f"a data sheet's {name} must have {len(heights)} entries, got {len(values)}")
            if not all(least <= value <= most for value in values):
                raise SettingsError(f"a data sheet's {name} must be {expected}, got {_listed(values)}")
        if self.light and not self.light[0] > 0:
            raise SettingsError(f"a data sheet's light must be above 0 on the axis, got {self.light[0]:g}")
        ideal = [height / (1 + bend) for height, bend in zip(heights, self.distortion, strict=False)]
        if not all(b > a for a, b in pairwise(ideal)):
            raise SettingsError(
                "a data sheet's distortion must not fold the picture: what is seen must lie farther out too"
            )


def _listed(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:g}" for value in values[:8]) + (", …" if len(values) > 8 else "") or "none"
