"""Sharpness of each pixel of a picture, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

from render.model.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class FocusMap:
    """Circle of confusion and depth of each pixel, measured along its chief ray.

    Attributes:
        coc_px: ``(height, width)`` float32, the AOV ``coc``: radius in pixels of this map, negative in front of the focus.
        depth_m: ``(height, width)`` float32, the AOV ``depth``: along the view axis; infinite where nothing is.
        film_mm_per_px: width of a pixel on the film, as the camera's aperture has it, by which radii become millimetres.
    """

    coc_px: FloatArray
    depth_m: FloatArray
    film_mm_per_px: float
