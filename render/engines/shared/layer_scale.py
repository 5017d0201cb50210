"""Resolution of layers: as requested, or as suits the engine and its rays."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from render.engines.shared.request import Part
from render.model.frame_settings import FrameSettings

COARSE_SCALE, MIDDLE_SCALE, FINE_SCALE = 2.0, 3.0, 4.0
"""Layer pixels per picture pixel along each axis, where none are requested."""
MIDDLE_RAYS, FINE_RAYS = 8, 48
"""Rays per pixel from which on the error of coarser layers shows beside the noise of the rays: measured on the demo shot and on
unlit scenes with 16 to 100 rays (``tests/bench/RESULTS.md``)."""
MOST_LINES = 6600
"""Layer pixels along the shorter side up to which layers are finer than `COARSE_SCALE`: the more there are, the fewer
fit into the window of a picture in tiles (`render.trace.tiling.plan`), and a window must be as wide as the rays
reach."""
OFFSETS = 4
"""Offsets of the layers of moments: successive moments share one, so that what stands still is not peeled at each."""


class Sampling(Protocol):
    """Settings that the resolution of layers follows from, as of `FrameSettings`."""

    @property
    def width(self) -> int:
        """Pixels."""
        ...

    @property
    def height(self) -> float:
        """Pixels."""
        ...

    @property
    def rays(self) -> int:
        """Rays per pixel."""
        ...

    @property
    def noise(self) -> float:
        """Wanted error in place of rays, or 0."""
        ...

    @property
    def supersample(self) -> float:
        """Requested layer pixels per picture pixel along each axis, or 0."""
        ...


def traced_scale(settings: Sampling, moments: int = 1) -> float:
    """Layer pixels per picture pixel of a picture that is traced.

    Args:
        settings: its settings.
        moments: number of pictures that the finished one is the mean of, whose layers are offset against each other.
    """
    if settings.supersample > 0:
        return settings.supersample
    if moments > 1:
        return COARSE_SCALE
    rays = FINE_RAYS if settings.noise > 0 else settings.rays
    wanted = FINE_SCALE if rays >= FINE_RAYS else MIDDLE_SCALE if rays >= MIDDLE_RAYS else COARSE_SCALE
    return float(max(COARSE_SCALE, min(wanted, MOST_LINES // min(settings.width, settings.height))))


def blurred_scale(settings: Sampling) -> float:
    """Pixels per picture pixel of a single image that is blurred."""
    return settings.supersample or COARSE_SCALE


def texel_offset(settings: FrameSettings, part: Part) -> tuple[float, float]:
    """Offset of the layers of one of several moments, layer pixels from -0.5 to 0.5, so that the edges of what stands still are
    sampled in other places at each: the R2 sequence (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
    None where the resolution is requested, as for exact comparisons."""
    if settings.supersample > 0:
        return 0.0, 0.0
    number, parts = part
    place = number * OFFSETS // parts
    x, y = np.modf(0.5 + place * np.array([0.7548776662466927, 0.5698402909980532]))[0] - 0.5
    return float(x), float(y)
