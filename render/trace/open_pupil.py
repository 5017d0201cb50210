"""Clearance over the stop's half disc at many field heights, traced where the edge of what is open may be.

What is open is a few shapes with smooth edges, so of a fine grid every second point and the rim tell where the edge runs. A point
between others that are all open, or all closed, counts as they do; every point beside one of the other kind is traced.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray

_OPEN, _CLOSED = -1.0, np.nan
_Mask = NDArray[np.bool_]


def clearances(
    trace: Callable[[NDArray[np.int64], NDArray[np.int64]], DoubleArray], count: int, on_disc: _Mask
) -> DoubleArray:
    """Clearances on a grid over the half disc, at each field height.

    Args:
        trace: gives the clearance ``(n,)`` of height indices ``(n,)`` and points ``(n,)``, numbers in the flattened grid: at
            most 0 where the lens is open, NaN where no ray gets through.
        count: of heights.
        on_disc: ``(m, k)`` points of the grid on the disc; those of column 0 are on its axis of symmetry.

    Returns:
        ``(count, m, k)``: exact beside the edge; elsewhere -1 where it is open and NaN where it is not.
    """
    traced = np.broadcast_to(_first(on_disc), (count, *on_disc.shape)).copy()
    found = np.full(traced.shape, np.nan)

    def fill(wanted: _Mask) -> None:
        heights, points = np.nonzero(wanted.reshape(count, -1))
        found[wanted] = trace(heights, points)

    fill(traced)
    is_open = found <= 0
    beside_open, beside_closed = _beside(traced & is_open), _beside(traced & ~is_open)
    wanted = on_disc & ~traced & ~(beside_open ^ beside_closed)
    assumed = np.where(beside_open, _OPEN, _CLOSED)
    found = np.where(on_disc & ~traced, assumed, found)
    while wanted.any():
        fill(wanted)
        traced |= wanted
        is_open = found <= 0
        at_edge = np.where(is_open, _beside(on_disc & ~is_open), _beside(on_disc & is_open))
        wanted = on_disc & ~traced & at_edge
    return found


def _first(on_disc: _Mask) -> _Mask:
    """Points to begin with: every second one each way, and the rim."""
    rim = on_disc & _beside(~np.pad(on_disc, [(1, 1), (0, 1)]))[1:-1, :-1]
    even = np.zeros_like(on_disc)
    even[::2, ::2] = True
    return np.asarray(on_disc & (even | rim))


def _beside(mask: _Mask) -> _Mask:
    """Points of ``(..., m, k)`` that have one of the mask among the eight around them; column 0 mirrors the grid."""
    tall = np.pad(mask, [*[(0, 0)] * (mask.ndim - 2), (1, 1), (0, 0)])
    tall = tall[..., :-2, :] | tall[..., 1:-1, :] | tall[..., 2:, :]
    wide = np.concatenate([tall[..., 1:2], tall, np.zeros_like(tall[..., :1])], axis=-1)
    return np.asarray(wide[..., :-2] | wide[..., 1:-1] | wide[..., 2:])
