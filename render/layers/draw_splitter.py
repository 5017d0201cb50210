"""Draws split into pieces between which work can be cancelled (`render.gl.cancellation`): picture tiles or triangle ranges."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from render.gl.cancellation import PIECE_MS, CancellationPoint, PieceSize
from render.gl.compat import GL
from render.layers.index import Draw
from render.optics.view import PinholeView

_TRIANGLES, _LEAST_TRIANGLES, _MOST_TRIANGLES = 40_000, 2_000, 320_000
"""Triangles between two cancellation points: at first, at least and at most. A smaller draw is split by picture rows instead."""
_PIXELS, _LEAST_PIXELS, _FORGETTING = 16_384, 4096, 0.995
"""Pixels shaded between two cancellation points, at first and at least; share of the measured cost kept after each point."""
Rectangle = tuple[int, int, int, int]
"""Left, top, width and height in pixels."""


@dataclass(frozen=True)
class DrawRange:
    """Range of a draw: triangles of one instance, or whole instances.

    Attributes:
        first_triangle: first triangle of each instance.
        triangles: number of triangles.
        first_instance: first instance of the draw.
        instances: number of instances.
    """

    first_triangle: int
    triangles: int
    first_instance: int
    instances: int


class DrawSplitter:
    """Splits draws of one context into pieces where work can be cancelled; otherwise each draw is one piece.

    Pieces of large draws are ranges in the order of the draw, so that the picture is the same to the bit.

    Args:
        cancellation: cancellation point of the context.
    """

    def __init__(self, cancellation: CancellationPoint) -> None:
        self._cancellation = cancellation
        self._ms_of_pixel = PIECE_MS / _PIXELS
        self._shaded, self._found = (PieceSize(_TRIANGLES, least=_LEAST_TRIANGLES) for _ in range(2))
        self._triangles = self._pixels = 0

    def split(self, draw: Draw, view: PinholeView) -> Iterator[DrawRange]:
        """Pieces of a draw that is shaded. The scissor test is set for each piece, which must be drawn before the next.

        Raises:
            Cancelled: the work is stale.
        """
        whole = _whole(draw)
        triangles = max(1, whole.triangles * whole.instances)
        if not self._cancellation.is_cancellable or triangles > _TRIANGLES:
            yield from self._ranges(whole, self._shaded)
            return
        left, top, width, height = _bounds(draw, view)
        pieces = int(np.ceil(width * height * self._ms_of_pixel / PIECE_MS))
        rows = -(-height // max(1, min(pieces, _TRIANGLES // triangles)))
        GL.glEnable(GL.GL_SCISSOR_TEST)
        try:
            for first in range(top, top + height, max(1, rows)):
                GL.glScissor(left, first, width, min(rows, top + height - first))
                yield whole
                self._record(triangles, width * rows)
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)

    def split_depth(self, draw: Draw) -> Iterator[DrawRange]:
        """Pieces of a draw of which only depth is drawn."""
        yield from self._ranges(_whole(draw), self._found)

    def _ranges(self, whole: DrawRange, size: PieceSize) -> Iterator[DrawRange]:
        """Ranges of a draw in its order, with a cancellation point after each."""
        if not self._cancellation.is_cancellable:
            yield whole
            return
        instance = triangle = 0
        while instance < whole.instances:
            most = min(size.units, _MOST_TRIANGLES)
            if triangle == 0 and most >= whole.triangles:
                some = min(most // max(1, whole.triangles), whole.instances - instance)
                share = DrawRange(0, whole.triangles, instance, some)
                instance += some
            else:
                share = DrawRange(triangle, min(most, whole.triangles - triangle), instance, 1)
                triangle += share.triangles
                if triangle == whole.triangles:
                    instance, triangle = instance + 1, 0
            yield share
            took_ms, drawn = self._cancellation.poll(), share.triangles * share.instances
            if 2 * drawn >= size.units:  # small draws do not predict the time of large ones
                size.learn(drawn, took_ms)

    def _record(self, triangles: int, pixels: int) -> None:
        """Record a shaded piece. The cost of the most expensive pixels is kept for long, since many pieces cover few pixels."""
        self._triangles, self._pixels = self._triangles + triangles, self._pixels + pixels
        if self._triangles >= _TRIANGLES or self._pixels * self._ms_of_pixel >= PIECE_MS / 2:
            took_ms = self._cancellation.poll()
            self._ms_of_pixel = max(_FORGETTING * self._ms_of_pixel, took_ms / max(self._pixels, _LEAST_PIXELS))
            self._triangles = self._pixels = 0


def _whole(draw: Draw) -> DrawRange:
    return DrawRange(0, len(draw.batch.geometry.triangles), 0, len(draw.instances))


def _bounds(draw: Draw, view: PinholeView) -> Rectangle:
    """Bounding rectangle of a draw in pixels: left, top, width, height. The device's row 0 is the picture's first row."""
    pixels, depths = view.project(draw.corners)
    if (depths <= view.near_m).any():
        return 0, 0, view.width, view.height
    low = np.clip(np.floor(pixels.min(axis=0)) - 1, 0, (view.width, view.height)).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=0)) + 1, 0, (view.width, view.height)).astype(int)
    left, top = (int(v) for v in low)
    width, height = (int(v) for v in np.maximum(high - low, 0))
    return left, top, width, height
