"""Bokeh: the image of a small bright light far behind the subject, at places of the frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import IrisShape
from render.optics.iris import transmission
from render.optics.report.field import WAVELENGTHS_NM
from render.optics.report.film_rays import FilmRays

_PUPIL_SIDE = 192
_SIDE_PX = 160
_SOFTENING_PX = 0.9  # hides the lattice of rays
_ROOM = 1.12  # around the largest disc
_MOST_DISCS = 3.0  # ideal ones side by side
_ESSENTIAL = 0.995  # share of the light that a stamp has to show

PLACES = (
    ("centre", 0.0, 0.0),
    ("half way right", 0.5, 0.0),
    ("right edge", 1.0, 0.0),
    ("top left corner", -1.0, 1.0),
    ("bottom right corner", 1.0, -1.0),
)
"""Places in the picture: name, and position in half widths and half heights of the gate, right and up."""


@dataclass(frozen=True, eq=False)
class Bokeh:
    """A highlight out of focus.

    Attributes:
        name: of the place.
        place: in half widths and half heights of the gate, right and up from the middle.
        light: ``(side, side, 3)`` of red, green and blue, row 0 at the top, its centre in the middle; 1 is the ideal disc in the
            middle of the frame.
        share: of the light that the lens passes in the middle of the frame.
        width_mm: width of the picture on the film.
    """

    name: str
    place: tuple[float, float]
    light: DoubleArray
    share: float
    width_mm: float


@dataclass(frozen=True, eq=False)
class BokehSheet:
    """Highlights at infinity, over the frame.

    Attributes:
        focus_distance_m: that the lens is focused at.
        disc_mm: diameter on the film of the disc that an ideal lens draws.
        places: the pictures; at one scale, but for those that do not fit.
    """

    focus_distance_m: float
    disc_mm: float
    places: tuple[Bokeh, ...]


def bokeh_sheet(
    rays: FilmRays, iris: IrisShape, gate_mm: tuple[float, float], focus_distance_m: float, disc_mm: float
) -> BokehSheet:
    """The bokeh of a lens that is focused nearer than infinity.

    Args:
        rays: the lens.
        iris: its opening.
        gate_mm: width and height of the film gate.
        focus_distance_m: for the record.
        disc_mm: diameter that an ideal lens's disc has on the film.
    """
    places = np.array([(x * gate_mm[0] / 2, y * gate_mm[1] / 2) for _, x, y in PLACES])
    inside = np.hypot(*places.T) <= rays.last_height_mm
    distant = [rays.distant_beams(places, _PUPIL_SIDE, wavelength) for wavelength in WAVELENGTHS_NM]
    beams = [each.beams for each in distant]
    iris_image = transmission(iris)
    passed = [_at(iris_image, each.pupil) for each in distant]
    light = np.array([np.where(beam.open, beam.light, 0.0) * w for beam, w in zip(beams, passed, strict=True)])
    light *= inside[:, None] / light.shape[-1]
    off = np.array([np.where(np.isfinite(beam.landing_mm), beam.landing_mm, 0.0) for beam in beams])
    off -= _centres(off, light)[:, None, :]
    widths = _widths_mm(off, light, disc_mm)
    even = light[:, 0].sum(axis=1) / (np.pi / 4 * (disc_mm * _SIDE_PX) ** 2)
    share = light.sum(axis=(0, 2)) / light[:, 0].sum()
    stamps = []
    for i, (name, x, y) in enumerate(PLACES):
        colours = [_picture(off[c, i], light[c, i], widths[i]) / (even[c] * widths[i] ** 2) for c in range(len(beams))]
        stamps.append(Bokeh(name, (x, y), np.stack(colours, axis=-1), float(share[i]), widths[i]))
    return BokehSheet(focus_distance_m, disc_mm, tuple(stamps))


def _at(image: DoubleArray, points: DoubleArray) -> DoubleArray:
    """Values of an image over the square around the unit circle, row 0 at the top, at the nearest of its pixels."""
    side = len(image)
    column, row = (np.nan_to_num((1 + sign * points[..., axis]) / 2 * side) for axis, sign in ((0, 1), (1, -1)))
    within = (column >= 0) & (column < side) & (row >= 0) & (row < side)
    found = image[np.where(within, row, 0).astype(int), np.where(within, column, 0).astype(int)]
    return np.asarray(np.where(within, found, 0.0))


def _centres(landing_mm: DoubleArray, light: DoubleArray) -> DoubleArray:
    """``(places, 2)`` centre of the light of all colours."""
    total = light.sum(axis=(0, 2))
    return np.asarray(np.einsum("cpr,cprx->px", light, landing_mm) / np.maximum(total, 1e-300)[:, None])


def _widths_mm(off: DoubleArray, light: DoubleArray, disc_mm: float) -> list[float]:
    """Width for each place that shows nearly all its light: the same for all, unless that is more than a few ideal discs."""
    reaches = [disc_mm / 8] * light.shape[1]
    for i in range(light.shape[1]):
        farthest = np.abs(off[:, i]).max(axis=-1).ravel()
        shares = light[:, i].ravel()
        if shares.sum() > 0:
            order = np.argsort(farthest)
            grown = np.cumsum(shares[order])
            reaches[i] = max(reaches[i], float(farthest[order][np.searchsorted(grown, _ESSENTIAL * grown[-1])]))
    most = _MOST_DISCS / 2 * disc_mm
    usual = max((reach for reach in reaches if reach <= most), default=0.0)
    return [2 * _ROOM * (usual if reach <= most else reach) for reach in reaches]


def _picture(off_mm: DoubleArray, light: DoubleArray, width_mm: float) -> DoubleArray:
    """``(side, side)`` light per pixel, each ray shared among the four pixels around it."""
    at = (off_mm * [1, -1] / width_mm + 0.5) * _SIDE_PX - 0.5
    corner = np.floor(at).astype(int)
    part = at - corner
    picture = np.zeros(_SIDE_PX * _SIDE_PX)
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        x, y = corner[:, 0] + dx, corner[:, 1] + dy
        share = light * np.abs(1 - dx - part[:, 0]) * np.abs(1 - dy - part[:, 1])
        inside = (x >= 0) & (x < _SIDE_PX) & (y >= 0) & (y < _SIDE_PX)
        picture += np.bincount((y * _SIDE_PX + x)[inside], share[inside], _SIDE_PX * _SIDE_PX)
    return _soften(picture.reshape(_SIDE_PX, _SIDE_PX))


def _soften(picture: DoubleArray) -> DoubleArray:
    steps = np.arange(-3, 4)
    kernel = np.exp(-0.5 * (steps / _SOFTENING_PX) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        picture = sum(weight * np.roll(picture, int(step), axis) for weight, step in zip(kernel, steps, strict=True))
    return np.asarray(picture)
