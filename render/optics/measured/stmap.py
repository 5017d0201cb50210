"""STMaps: pictures whose pixels say where another picture is to be sampled.

By the convention of Nuke's STMap node, red is the place from left to right and green from bottom to top, in widths and
heights of the picture; the middle of the lower left pixel is at (0.5/width, 0.5/height). Two maps belong to a lens:

- ``undistort``: over the undistorted picture, the place of each pixel in the picture that the lens takes;
- ``distort``: over the picture that the lens takes, the place of each pixel in the undistorted one.

The undistorted picture has the same gate and focal length, so that the middle keeps its size. Overscan adds pixels around a
map; places stay in widths and heights of the picture without them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.optics.distortion import chief_rays
from render.optics.view import PinholeView

Direction = Literal["undistort", "distort"]

_MOST_PAIRS = 60_000
_FEWEST_PX = 8


@dataclass(frozen=True, eq=False)
class StMap:
    """An STMap.

    Attributes:
        places: ``(h, w, 2)`` from left to right and from bottom to top, row 0 at the top.
        size: width and height of the picture without overscan, in pixels.
        overscan_px: columns and rows that are added on each side.
    """

    places: DoubleArray
    size: tuple[int, int]
    overscan_px: tuple[int, int] = (0, 0)


def make_stmap(
    camera: Camera, size: tuple[int, int], direction: Direction, overscan_px: tuple[int, int] = (0, 0)
) -> StMap:
    """Make an STMap of a camera's lens.

    Args:
        camera: the lens as it is set.
        size: width and height of the picture in pixels.
        direction: which of the two maps.
        overscan_px: columns and rows to add on each side.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance, or the picture has no pixels.
    """
    view = PinholeView.from_camera(camera, *size)
    centre, focal = np.array([view.cx, view.cy]), np.array([view.fx, view.fy])
    extent = [np.arange(-pad, n + pad) + 0.5 for n, pad in zip(size, overscan_px, strict=True)]
    pixels = np.stack(np.meshgrid(*extent), axis=-1)
    chief = chief_rays(camera)
    if chief is not None:
        move = chief.distort_slopes if direction == "undistort" else chief.undistort_slopes
        rows = [centre + focal * move((row - centre) / focal) for row in pixels]  # a row at a time keeps memory small
        pixels = np.stack(rows)
    return StMap(_flipped(pixels / size), size, overscan_px)


def stmap_pairs_mm(
    stmap: StMap, direction: Direction, gate_mm: tuple[float, float], name: str
) -> tuple[DoubleArray, DoubleArray]:
    """Points in the picture and where an ideal lens shows the same, ``(n, 2)`` mm each, right and up from the middle.

    Args:
        stmap: the map.
        direction: which of the two maps it is.
        gate_mm: width and height of the gate that the picture shows.
        name: of the file, for messages.

    Raises:
        InputError: it is too small, has too few numbers, or folds the picture.
    """
    height, width = stmap.places.shape[:2]
    if min(height, width) < _FEWEST_PX:
        raise _bad(name, f"it is {width} x {height} pixels, expected {_FEWEST_PX} or more each way")
    step = max(1, int(np.ceil(np.sqrt(height * width / _MOST_PAIRS))))
    pad_x, pad_y = stmap.overscan_px
    columns, lines = np.arange(0, width, step), np.arange(0, height, step)
    here = np.stack(
        np.meshgrid((columns - pad_x + 0.5) / stmap.size[0], 1 - (lines - pad_y + 0.5) / stmap.size[1]), axis=-1
    )
    there = stmap.places[::step, ::step]
    usable = np.isfinite(there).all(axis=-1) & (np.abs(there - 0.5) < 10).all(axis=-1) & (there != 0).any(axis=-1)
    if usable.mean() < 0.25:
        raise _bad(name, f"{100 * (1 - usable.mean()):.0f} % of it are no places in a picture: it is no STMap")
    _check_folds(there, usable, name)
    gate = np.array(gate_mm)
    mapped, own = (there[usable] - 0.5) * gate, (here[usable] - 0.5) * gate
    return (mapped, own) if direction == "undistort" else (own, mapped)


def _check_folds(places: DoubleArray, usable: NDArray[np.bool_], name: str) -> None:
    """Refuse a map with turned-over or collapsed cells, the area of which is the sign."""
    right, down = np.diff(places, axis=1)[:-1], np.diff(places, axis=0)[:, :-1]
    area = right[..., 1] * down[..., 0] - right[..., 0] * down[..., 1]
    whole = usable[:-1, :-1] & usable[1:, :-1] & usable[:-1, 1:]
    with np.errstate(invalid="ignore"):
        folded = whole & ~(area > 0)
    if folded.sum() > 0.001 * max(whole.sum(), 1):
        share = 100 * folded.sum() / max(whole.sum(), 1)
        raise _bad(
            name, f"it folds or turns over {share:.1f} % of the picture: green has to grow upward and red to the right"
        )


def _flipped(places: DoubleArray) -> DoubleArray:
    return np.stack([places[..., 0], 1 - places[..., 1]], axis=-1)


def _bad(name: str, what: str) -> InputError:
    return InputError(f"{name}: {what}", code="bad_stmap", path=name)
