"""Rays of a lens described by its data sheet: measured errors as the aberration of light through a point of the pupil.

Kyaw (2013, section 7.2) gives a lens's errors as tables over the distance from the axis and draws them on the finished picture.
Here each becomes an error of rays, so that it scales with the iris and is correct out of focus too. With ρ = (x, y) a
point of the pupil over its radius at the sheet's f-number, x along the radius of the picture and y across it, light lands off by

    curvature    z/(2N)·(x, y)                      z before the film (Welford 1986, chapter 7)
    coma         L/3·(3x² + y², 2xy)                L the length of the flare
    spherical    S·(ρ² − 2/3)·(x, y)
    blur         (1 − ρ²)·(1 − 2ρ²)·(B_t·x, B_s·y)

The last is the remainder of the measured blur: spherical aberration of higher orders that leaves a disc out of focus as large as
it is, round, and its inner half as bright as its outer one. It and spherical aberration are balanced: they spread light in focus
but do not move the focus. S and B give light the measured spread over the open part of the pupil.
As the iris closes both shrink with the third power of the pupil (Kyaw 2013, eq. 6.3) and stay balanced, as if each stop were
focused for itself; coma shrinks with the second power and curvature's blur with the first.

A sheet's light is split into natural falloff, at most cos⁴, and the part that rims block. The rims are two circles as large as
the pupil, moved apart along the radius: the opening is a cat's eye, and becomes round again as the iris closes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales

MIDDLE_NM, SPAN_NM = 562.5, 175.0
"""Colour errors are stated between 475 and 650 nm and taken as linear between."""
_DARKEST = 1e-4  # share of the light that rims leave, at least: a pupil that is closed has no shape
_NUDGE_MM = 1e-4  # for derivatives
_ACROSS, _ALONG = 48, 12  # nodes of integrals over the open pupil
_NO_SCALES = AberrationScales()


@dataclass(frozen=True, eq=False)
class SheetErrors:
    """Errors of a data sheet's lens at a focal length and f-number, at heights ``(h,)`` in the picture; lengths are mm
    on the film.

    Attributes:
        heights_mm: ``(h,)``.
        seen: ``(h,)`` slope in object space of the chief ray.
        stretch: ``(h, 2)`` by how much more, along the radius and across it, the slope changes there from one place of the film
            to the next than an ideal lens's.
        edge: the pupil's radius over that at the sheet's f-number.
        defocus_mm: ``(h,)`` landing at the edge of the sheet's pupil by curvature of field.
        coma_mm: ``(h,)`` a third of the flare's length.
        spherical_mm: ``(h,)`` S.
        blur_mm: ``(h, 2)`` B_t and B_s.
        axial_mm: ``(h,)`` as ``defocus_mm``, for a step of blueness.
        lateral_mm: ``(h,)`` outward shift of the image for a step of blueness.
        rim_offset: ``(h,)`` of each of the two rims' centres along the radius, over the radius of the sheet's pupil.
        rim_radius: ``(h,)`` radius of the rims.
        natural: ``(h,)`` light through an open point of the pupil, over that on the axis.
    """

    heights_mm: DoubleArray
    seen: DoubleArray
    stretch: DoubleArray
    edge: float
    defocus_mm: DoubleArray
    coma_mm: DoubleArray
    spherical_mm: DoubleArray
    blur_mm: DoubleArray
    axial_mm: DoubleArray
    lateral_mm: DoubleArray
    rim_offset: DoubleArray
    rim_radius: float
    natural: DoubleArray

    def landing_mm(self, pupil: DoubleArray, wavelength_nm: float | None = None) -> DoubleArray:
        """Landing points ``(h, n, 2)`` of rays relative to the chief ray of the middle wavelength: outward, and across
        the radius.

        Args:
            pupil: ``(n, 2)`` or ``(h, n, 2)`` points over the pupil's radius, along and across the radius of the picture.
            wavelength_nm: by default none has colour errors.
        """
        whole = np.broadcast_to(pupil, (len(self.heights_mm), *pupil.shape[-2:]))
        x, y = whole[..., 0], whole[..., 1]
        blueness = 0.0 if wavelength_nm is None else (MIDDLE_NM - wavelength_nm) / SPAN_NM
        squared = (x**2 + y**2)[..., None]
        linear = self.edge * (self.defocus_mm + blueness * self.axial_mm)[:, None, None]
        linear = linear + self.edge**3 * self.spherical_mm[:, None, None] * (squared - 2 / 3)
        linear = linear + self.edge**3 * self.blur_mm[:, None] * (1 - squared) * (1 - 2 * squared)
        lands = linear * whole + _coma(self.coma_mm, self.edge * whole)
        lands[..., 0] += blueness * self.lateral_mm[:, None]
        return np.asarray(lands)

    def clearance(self, pupil: DoubleArray, side: int) -> DoubleArray:
        """Clearance ``(h, n)``, above 0 where a rim blocks.

        Args:
            pupil: as `landing_mm` takes it.
            side: 1 for the rim that blocks the outer side of the pupil, -1 for the other.
        """
        point = np.broadcast_to(pupil, (len(self.heights_mm), *pupil.shape[-2:])) * self.edge
        along = point[..., 0] + side * self.rim_offset[:, None]
        return np.asarray(along**2 + point[..., 1] ** 2 - self.rim_radius**2)

    @property
    def open_share(self) -> DoubleArray:
        """Share ``(h,)`` of the pupil that no rim blocks."""
        _, weights = open_pupil(self.edge, self.rim_offset, self.rim_radius)
        return np.asarray(weights.sum(axis=1) / (np.pi * self.edge**2))

    @property
    def light(self) -> DoubleArray:
        """Illumination ``(h,)`` of the film relative to the axis."""
        return self.natural * self.open_share

    def spread_mm(self, wavelength_nm: float | None = None, *, coma: bool = True) -> DoubleArray:
        """Standard deviation ``(h, 2)`` of a focused point's landing light, along and across the radius.

        Args:
            wavelength_nm: by default none has colour errors.
            coma: whether coma counts.
        """
        points, weights = open_pupil(self.edge, self.rim_offset, self.rim_radius)
        lands = self.landing_mm(points / self.edge, wavelength_nm)
        variance = _variance(lands, weights)
        if not coma:
            variance -= _variance(_coma(self.coma_mm, points), weights)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def sheet_errors(
    sheet: DataSheet,
    heights_mm: DoubleArray,
    *,
    focal_length_mm: float,
    f_stop: float,
    scales: AberrationScales = _NO_SCALES,
) -> SheetErrors:
    """Errors of a lens at heights in the picture, from its data sheet.

    Args:
        sheet: the tables.
        heights_mm: ``(h,)`` on the film.
        focal_length_mm: focal length of the lens.
        f_stop: above 0.
        scales: factors on the errors: that on spherical aberration is of the blur as far as it is round, that on astigmatism of
            how it differs along the radius and across.
    """
    measured_at = sheet.f_stop or f_stop
    edge = measured_at / f_stop
    seen = seen_slopes(sheet, heights_mm, focal_length_mm, scales.distortion)
    natural, rim = _light(sheet, heights_mm, seen_slopes(sheet, heights_mm, focal_length_mm))
    defocus = at_heights(sheet, "field_curvature_mm", heights_mm) / (2 * measured_at)
    coma = at_heights(sheet, "coma_mm", heights_mm) / 3
    spherical, blur = _rest_of_blur(sheet, heights_mm, rim, defocus, coma)
    round_blur, difference = blur.mean(axis=1), (blur[:, 0] - blur[:, 1]) / 2
    return SheetErrors(
        heights_mm=heights_mm,
        seen=seen,
        stretch=_stretch(sheet, heights_mm, focal_length_mm, scales.distortion),
        edge=edge,
        defocus_mm=defocus * scales.field_curvature,
        coma_mm=coma * scales.coma,
        spherical_mm=spherical * scales.spherical,
        blur_mm=(scales.spherical * round_blur)[:, None] + scales.astigmatism * np.outer(difference, [1.0, -1.0]),
        axial_mm=at_heights(sheet, "axial_color_mm", heights_mm) * scales.chromatic / (2 * measured_at),
        lateral_mm=-at_heights(sheet, "lateral_color_mm", heights_mm) * scales.chromatic,
        rim_offset=rim
        * max(edge, 1.0),  # measurements wide open do not give the distance of the rims, which grows with the iris
        rim_radius=max(edge, 1.0),
        natural=natural,
    )


def seen_slopes(
    sheet: DataSheet, heights_mm: DoubleArray, focal_length_mm: float, distortion: float = 1.0
) -> DoubleArray:
    """Slopes ``(h,)`` in object space of the chief rays to heights in the picture.

    Args:
        sheet: the tables.
        heights_mm: ``(h,)`` on the film.
        focal_length_mm: of the lens.
        distortion: factor on it.
    """
    bend = 1 / (1 + at_heights(sheet, "distortion", heights_mm)) - 1
    return np.asarray(heights_mm / focal_length_mm * (1 + distortion * bend))


def _stretch(sheet: DataSheet, heights_mm: DoubleArray, focal_length_mm: float, distortion: float) -> DoubleArray:
    low, high = np.maximum(heights_mm - _NUDGE_MM, 0.0), heights_mm + _NUDGE_MM
    rise = seen_slopes(sheet, high, focal_length_mm, distortion) - seen_slopes(sheet, low, focal_length_mm, distortion)
    across = seen_slopes(sheet, high, focal_length_mm, distortion) / high
    return focal_length_mm * np.stack([rise / (high - low), across], axis=-1)


def at_heights(sheet: DataSheet, name: str, heights_mm: DoubleArray) -> DoubleArray:
    """Interpolate one of the sheet's tables at heights ``(h,)``: through its entries, and monotone between two of them.

    Piecewise cubic with the slopes of Fritsch & Butland (1984), level on the axis but for what changes its sign there. Beyond the
    last height it stays. A table that is empty is 0, but light is 1.

    Args:
        sheet: the tables.
        name: of a field of `render.model.lens.DataSheet`.
        heights_mm: ``(h,)`` on the film.
    """
    values = np.array(getattr(sheet, name), np.float64)
    if len(values) < 2:
        none = 1.0 if name == "light" else 0.0
        return np.full_like(heights_mm, values[0] if len(values) and name != "light" else none)
    if name == "light":
        values = values / values[0]
    nodes = np.array(sheet.heights_mm)
    steps = np.diff(nodes)
    slopes = _slopes(steps, np.diff(values) / steps, level=name not in ("coma_mm", "lateral_color_mm"))
    at = np.clip(heights_mm, 0.0, nodes[-1])
    i = np.clip(np.searchsorted(nodes, at, side="right") - 1, 0, len(steps) - 1)
    t, rise = (at - nodes[i]) / steps[i], values[i + 1] - values[i]
    here, there = slopes[i] * steps[i], slopes[i + 1] * steps[i]
    return np.asarray(values[i] + t * (here + t * (3 * rise - 2 * here - there + t * (here + there - 2 * rise))))


def open_pupil(edge: float, rim_offset: DoubleArray, rim_radius: float) -> tuple[DoubleArray, DoubleArray]:
    """Nodes and weights of integrals over the open part of a pupil, for each height ``(h,)``.

    Args:
        edge: the pupil's radius.
        rim_offset: ``(h,)`` of the two rims' centres to either side along the radius of the picture.
        rim_radius: of the rims.

    Returns:
        ``(h, n, 2)`` points in the unit of these lengths, and ``(h, n)`` areas that they stand for.
    """
    angle, angle_weight = np.polynomial.legendre.leggauss(_ACROSS)
    part, part_weight = np.polynomial.legendre.leggauss(_ALONG)
    offset = np.asarray(rim_offset)[:, None]
    highest = np.minimum(edge, np.sqrt(np.maximum(rim_radius**2 - offset**2, 0.0)))
    y = highest * np.sin(np.pi / 2 * angle)
    y_weight = highest * np.cos(np.pi / 2 * angle) * np.pi / 2 * angle_weight
    reach = np.minimum(np.sqrt(np.maximum(edge**2 - y**2, 0.0)), np.sqrt(np.maximum(rim_radius**2 - y**2, 0)) - offset)
    reach = np.maximum(reach, 0.0)
    x = reach[..., None] * part
    points = np.stack([x, np.broadcast_to(y[..., None], x.shape)], axis=-1)
    weights = (y_weight * reach)[..., None] * part_weight
    return points.reshape(len(x), -1, 2), weights.reshape(len(x), -1)


def _light(sheet: DataSheet, heights_mm: DoubleArray, seen: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Light ``(h,)`` through an open point of the pupil, and the distance of the rims that leaves the rest of it."""
    light = at_heights(sheet, "light", heights_mm)
    if not sheet.light:
        return light, np.zeros_like(light)
    natural = np.maximum((1 + seen**2) ** -2.0, light)
    offsets = np.linspace(0.0, 1.0, 4001)
    shares = 2 / np.pi * (np.arccos(offsets) - offsets * np.sqrt(1 - offsets**2))  # two circles' common part
    return natural, np.interp(-np.maximum(light / natural, _DARKEST), -shares, offsets)


def _rest_of_blur(
    sheet: DataSheet, heights_mm: DoubleArray, rim: DoubleArray, defocus: DoubleArray, coma: DoubleArray
) -> tuple[DoubleArray, DoubleArray]:
    """Coefficients S ``(h,)`` and B ``(h, 2)`` that give the measured blur beside curvature and coma, which are kept
    where larger.
    """
    points, weights = open_pupil(1.0, rim, 1.0)
    squared = (points**2).sum(-1, keepdims=True)
    known = defocus[:, None, None] * points + _coma(coma, points)
    blur = np.stack([at_heights(sheet, f"{name}_blur_mm", heights_mm) for name in ("tangential", "sagittal")], axis=-1)
    left = np.maximum(blur**2 - _variance(known, weights), 0.0)
    balanced = (squared - 2 / 3) * points
    share = at_heights(sheet, "spherical", heights_mm)
    unit = np.sqrt(np.maximum(_variance(balanced, weights), 1e-12))
    spherical = -share * (np.sqrt(left) / unit).min(axis=1)
    known = known + spherical[:, None, None] * balanced
    zonal = (1 - squared) * (1 - 2 * squared) * points
    # the spread of known + B·zonal is to be the blur: a quadratic for B, along and across
    square, cross = _variance(zonal, weights), _covariance(known, zonal, weights)
    missing = blur**2 - _variance(known, weights)
    gain = (-cross + np.sqrt(np.maximum(cross**2 + square * missing, 0.0))) / np.maximum(square, 1e-12)
    return spherical, np.where(left > 0, gain, 0.0)


def _coma(coma_mm: DoubleArray, points: DoubleArray) -> DoubleArray:
    x, y = points[..., 0], points[..., 1]
    return np.asarray(coma_mm[:, None, None] * np.stack([3 * x**2 + y**2, 2 * x * y], axis=-1))


def _variance(values: DoubleArray, weights: DoubleArray) -> DoubleArray:
    return _covariance(values, values, weights)


def _covariance(a: DoubleArray, b: DoubleArray, weights: DoubleArray) -> DoubleArray:
    """Covariances ``(h, 2)`` of values ``(h, n, 2)``, component by component."""
    share = (weights / weights.sum(axis=1, keepdims=True))[..., None]
    mean_a, mean_b = (np.sum(share * value, axis=1, keepdims=True) for value in (a, b))
    return np.asarray(np.sum(share * (a - mean_a) * (b - mean_b), axis=1))


def _slopes(steps: DoubleArray, secants: DoubleArray, *, level: bool) -> DoubleArray:
    """Slopes ``(n + 1,)`` at uneven nodes with ``(n,)`` steps between them."""
    before, after = secants[:-1], secants[1:]
    agree = before * after > 0
    near, far = 2 * steps[1:] + steps[:-1], steps[1:] + 2 * steps[:-1]
    shared = np.where(agree, near * after + far * before, 1.0)
    inner = np.where(agree, 3 * (steps[1:] + steps[:-1]) * before * after / shared, 0.0)
    last = 1.5 * secants[-1] - 0.5 * inner[-1] if len(inner) else secants[-1]
    if last * secants[-1] < 0:
        last = 0.0
    last = np.sign(last) * min(abs(last), 3 * abs(secants[-1]))
    return np.concatenate([[0.0 if level else secants[0]], inner, [last]])
