"""Draws split into pieces between which work can be cancelled (`render.gl.cancellation`): picture tiles or triangle ranges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from render.gl.cancellation import PIECE_MS, CancellationPoint, PieceSize
from render.gl.compat import GL
from render.layers.clusters import DrawRange
from render.layers.index import Draw
from render.optics.view import PinholeView

_TRIANGLES, _LEAST_TRIANGLES, _MOST_TRIANGLES = 40_000, 2_000, 320_000
"""Triangles between two cancellation points: at first, at least and at most. A smaller draw is split by picture rows instead."""
_PIXELS, _LEAST_PIXELS, _FORGETTING = 16_384, 4096, 0.995
"""Pixels shaded between two cancellation points, at first and at least; share of the measured cost kept after each point."""
Rectangle = tuple[int, int, int, int]
"""Left, top, width and height in pixels."""


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

    def split(self, draw: Draw, ranges: Sequence[DrawRange], view: PinholeView) -> Iterator[DrawRange]:
        """Pieces of a draw that is shaded. The scissor test is set for each piece, which must be drawn before the next.

        Args:
            draw: draw that is shaded.
            ranges: ranges of it that are drawn, in order.
            view: view that it is drawn for.

        Raises:
            Cancelled: the work is stale.
        """
        triangles = max(1, sum(share.triangles * share.instances for share in ranges))
        if not self._cancellation.is_cancellable or triangles > _TRIANGLES:
            yield from self._pieces(ranges, self._shaded)
            return
        left, top, width, height = _bounds(draw, view)
        pieces = int(np.ceil(width * height * self._ms_of_pixel / PIECE_MS))
        rows = -(-height // max(1, min(pieces, _TRIANGLES // triangles)))
        GL.glEnable(GL.GL_SCISSOR_TEST)
        try:
            for first in range(top, top + height, max(1, rows)):
                GL.glScissor(left, first, width, min(rows, top + height - first))
                yield from ranges
                self._record(triangles, width * rows)
        finally:
            GL.glDisable(GL.GL_SCISSOR_TEST)

    def split_depth(self, ranges: Sequence[DrawRange]) -> Iterator[DrawRange]:
        """Pieces of a draw of which only depth is drawn."""
        yield from self._pieces(ranges, self._found)

    def _pieces(self, ranges: Sequence[DrawRange], size: PieceSize) -> Iterator[DrawRange]:
        """Pieces of ranges in their order, with a cancellation point after each."""
        if not self._cancellation.is_cancellable:
            yield from ranges
            return
        drawn = 0
        for whole in ranges:
            for share in _cut(whole, size):
                yield share
                drawn += share.triangles * share.instances
                if 2 * drawn >= size.units:  # small draws do not predict the time of large ones
                    size.learn(drawn, self._cancellation.poll())
                    drawn = 0
        self._cancellation.poll()

    def _record(self, triangles: int, pixels: int) -> None:
        """Record a shaded piece. The cost of the most expensive pixels is kept for long, since many pieces cover few pixels."""
        self._triangles, self._pixels = self._triangles + triangles, self._pixels + pixels
        if self._triangles >= _TRIANGLES or self._pixels * self._ms_of_pixel >= PIECE_MS / 2:
            took_ms = self._cancellation.poll()
            self._ms_of_pixel = max(_FORGETTING * self._ms_of_pixel, took_ms / max(self._pixels, _LEAST_PIXELS))
            self._triangles = self._pixels = 0


def _cut(whole: DrawRange, size: PieceSize) -> Iterator[DrawRange]:
    """Pieces of one range, of the size that is learnt meanwhile."""
    instance = triangle = 0
    while instance < whole.instances:
        most = min(size.units, _MOST_TRIANGLES)
        first = whole.first_instance + instance
        if triangle == 0 and most >= whole.triangles:
            some = min(most // max(1, whole.triangles), whole.instances - instance)
            yield DrawRange(whole.first_triangle, whole.triangles, first, some)
            instance += some
        else:
            share = min(most, whole.triangles - triangle)
            yield DrawRange(whole.first_triangle + triangle, share, first, 1)
            triangle += share
            if triangle == whole.triangles:
                instance, triangle = instance + 1, 0


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
