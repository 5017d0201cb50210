"""Field dependence of a lens: spots, field curvature, distortion and illumination."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import IrisShape
from render.optics.glass import D_LINE_NM
from render.optics.iris import fill_iris
from render.optics.report.film_rays import FilmRays
from render.optics.sampling import sample_points
from render.optics.spectrum import THREE_LINES

WAVELENGTHS_NM = THREE_LINES.wavelengths_nm
_SPOT_RAYS = 500
_NARROW = 0.02  # of the pupil: radius of the narrow beam whose two foci are computed
_DARK = 2e-3  # of the light on the axis


@dataclass(frozen=True, eq=False)
class Spot:
    """Spot diagram of a point in the plane of focus.

    Attributes:
        height_mm: of the image.
        points_um: for each of `WAVELENGTHS_NM` ``(n, 2)`` on the film, right and up in the upright picture, from the centre of
            the light of all three; up is away from the middle of the picture.
        rms_um: root-mean-square distance from that centre; NaN where no light comes through.
    """

    height_mm: float
    points_um: tuple[DoubleArray, ...]
    rms_um: float


@dataclass(frozen=True, eq=False)
class FieldCurves:
    """Curves over the image height; NaN where the lens is dark.

    Attributes:
        heights_mm: ``(n,)`` from the axis to the corner of the gate.
        tangential_mm: where the narrow beam around the chief ray focuses in the plane through the axis, behind the film.
        sagittal_mm: the same across that plane.
        distortion: share by which the image is farther up or down than an ideal lens's: negative is barrel-shaped.
        distortion_across: the same to the left or right, which differs for an anamorphic lens.
        illumination: of the film, 1 on the axis.
        geometric: the same if no rim blocked any light.
        cos4: fourth power of the cosine of the field angle.
    """

    heights_mm: DoubleArray
    tangential_mm: DoubleArray
    sagittal_mm: DoubleArray
    distortion: DoubleArray
    distortion_across: DoubleArray
    illumination: DoubleArray
    geometric: DoubleArray
    cos4: DoubleArray


def spots(rays: FilmRays, heights_mm: DoubleArray, iris: IrisShape) -> tuple[Spot, ...]:
    """Spot diagrams, exact rays that fill the iris evenly.

    Args:
        rays: the lens.
        heights_mm: ``(k,)`` of the images.
        iris: its opening.
    """
    places = radial(rays, heights_mm)
    pupil = fill_iris(sample_points(_SPOT_RAYS, 0)[0, :, :2], iris)
    beams = [rays.beams(places, pupil, wavelength) for wavelength in WAVELENGTHS_NM]
    found = []
    for i, height in enumerate(heights_mm):
        lit = [beam.landing_mm[i][beam.open[i]] for beam in beams]
        if height > rays.last_height_mm or min(map(len, lit)) == 0:
            found.append(Spot(float(height), tuple(np.zeros((0, 2)) for _ in lit), float("nan")))
            continue
        centre = np.mean([points.mean(axis=0) for points in lit], axis=0)
        points_um = tuple(1000 * (points - centre) for points in lit)
        rms_um = np.sqrt(np.mean([(points**2).sum(axis=1).mean() for points in points_um]))
        found.append(Spot(float(height), points_um, float(rms_um)))
    return tuple(found)


def field_curves(rays: FilmRays, corner_mm: float, squeeze: float = 1.0, count: int = 37) -> FieldCurves:
    """Curves over the image height at the d line.

    Args:
        rays: the lens.
        corner_mm: the largest height.
        squeeze: of an anamorphic lens.
        count: of heights.
    """
    heights = np.linspace(0.0, corner_mm, count)
    illumination, geometric = relative_light(rays, heights), _light_without_rims(rays, heights)
    lit = (heights <= rays.last_height_mm) & (illumination > _DARK)
    narrow = rays.beams(radial(rays, heights), np.array([[0, 0], [_NARROW, 0], [0, _NARROW]]), D_LINE_NM)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = -(narrow.landing_mm[:, 1:] - narrow.landing_mm[:, :1]) / (narrow.slopes[:, 1:] - narrow.slopes[:, :1])
        distortion = heights / rays.paraxial_height_mm(heights) - 1
    distortion[0] = distortion[1]  # on the axis it is its limit

    def where_lit(values: DoubleArray) -> DoubleArray:
        return np.where(lit, values, np.nan)

    return FieldCurves(
        heights,
        where_lit(depth[:, 1, 1]),
        where_lit(depth[:, 0, 0]),
        where_lit(distortion),
        where_lit(1 / (1 + _narrowed_bend(distortion, squeeze)) - 1),
        np.where(heights <= rays.last_height_mm, illumination, 0.0),
        where_lit(geometric),
        (1 + rays.seen(heights) ** 2) ** -2.0,
    )


def seen_at(rays: FilmRays, places_mm: DoubleArray, squeeze: float = 1.0) -> DoubleArray:
    """``(k, 2)`` slopes in object space, right and up, of the chief rays to places ``(k, 2)`` of the picture off the axis.

    An anamorphic lens's picture is stretched back, which narrows its distortion from side to side (`render.optics.distortion`).
    """
    heights = np.hypot(*places_mm.T)
    distortion = heights / rays.paraxial_height_mm(heights) - 1
    ideal = places_mm * (rays.seen(heights) * (1 + distortion) / heights)[:, None]
    bends = np.stack([_narrowed_bend(distortion, squeeze), _narrowed_bend(distortion, 1.0)], axis=1)
    return np.asarray(ideal * (1 + bends))


def _narrowed_bend(distortion: DoubleArray, squeeze: float) -> DoubleArray:
    """Share by which a chief ray comes from farther out than an ideal lens's, from side to side."""
    return np.asarray((1 / (1 + distortion) - 1) / squeeze)


def relative_light(rays: FilmRays, heights_mm: DoubleArray) -> DoubleArray:
    """Illumination ``(k,)`` of the film through a round iris, over that on the axis.

    Args:
        rays: the lens.
        heights_mm: ``(k,)``.
    """
    light = rays.light(np.concatenate([[0.0], heights_mm]))
    return np.asarray(light[1:] / light[0])


def _light_without_rims(rays: FilmRays, heights_mm: DoubleArray) -> DoubleArray:
    """Illumination if no rim blocked any light."""
    light = rays.light(np.concatenate([[0.0], heights_mm]), rims=False)
    return np.asarray(light[1:] / light[0])


def image_circle_mm(rays: FilmRays, farthest_mm: float) -> float:
    """Diameter of the circle on the film beyond which there is no light; infinite where it reaches past the farthest height.

    Args:
        rays: the lens.
        farthest_mm: height to look out to.
    """
    heights = np.linspace(0.0, min(farthest_mm, rays.last_height_mm), 25)
    on_axis = rays.light(np.zeros(1))[0]

    def is_lit(height_mm: float) -> bool:
        return bool(rays.light(np.array([height_mm]))[0] / on_axis > _DARK)

    dark = next((i for i, height in enumerate(heights) if not is_lit(height)), None)
    if dark is None:
        return 2 * rays.last_height_mm if rays.last_height_mm < farthest_mm else float("inf")
    finer = np.linspace(heights[max(dark - 1, 0)], heights[dark], 13)
    first, last = 0, len(finer) - 1
    while last - first > 1:
        middle = (first + last) // 2
        first, last = (middle, last) if is_lit(finer[middle]) else (first, middle)
    return 2 * float(finer[first])


def radial(rays: FilmRays, heights_mm: DoubleArray) -> DoubleArray:
    """``(k, 2)`` places of the picture at heights, where the lens measures them."""
    return np.asarray(heights_mm)[:, None] * rays.toward
