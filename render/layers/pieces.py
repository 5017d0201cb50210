"""A draw in pieces, for work that may be left between them (`render.gl.pulse`): rectangles of the picture."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from render.gl.compat import GL
from render.gl.pulse import PieceSize, Pulse
from render.layers.index import Draw
from render.optics.view import PinholeView

_TRIANGLES = 40_000
"""That are drawn more than once at most, to have a draw in pieces; and that are drawn between two beats."""
Rectangle = tuple[int, int, int, int]
"""Left, top, width and height in pixels."""


class Pieces:
    """Draws of one context in pieces, where the pulse is watched; else each draw is one.

    Args:
        pulse: of the context.
    """

    def __init__(self, pulse: Pulse) -> None:
        self._pulse = pulse
        self._pixels = PieceSize(16_384, least=4096)
        self._triangles = 0

    def of(self, draw: Draw, view: PinholeView) -> Iterator[None]:
        """Once for each piece, which is to be drawn then: the rest of the picture is cut off.

        Raises:
            Interrupted: the work is stale.
        """
        if not self._pulse.is_watched:
            yield
            return
        left, top, width, height = _bounds(draw, view)
        triangles = max(1, len(draw.batch.geometry.triangles) * len(draw.instances))
        wanted = -(-width * height // self._pixels.units)
        rows = -(-height // max(1, min(wanted, _TRIANGLES // triangles)))
        GL.glEnable(GL.GL_SCISSOR_TEST)
        try:
            for first in range(top, top + height, max(1, rows)):
                GL.glScissor(left, first, width, min(rows, top + height - first))
                yield
                self._drawn(triangles, width * rows)
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)

    def _drawn(self, triangles: int, pixels: int) -> None:
        self._triangles += triangles
        if self._triangles >= _TRIANGLES or pixels >= self._pixels.units // 4:
            self._triangles = 0
            self._pixels.learn(pixels, self._pulse.beat())


def _bounds(draw: Draw, view: PinholeView) -> Rectangle:
    """What of the picture a draw may reach; rows as the device counts them, which has the picture's first one first."""
    pixels, depths = view.project(draw.corners)
    if (depths <= view.near_m).any():
        return 0, 0, view.width, view.height
    low = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, (view.width, view.height)).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, (view.width, view.height)).astype(int)
    left, top = (int(v) for v in low)
    width, height = (int(v) for v in np.maximum(high - low, 0))
    return left, top, width, height
