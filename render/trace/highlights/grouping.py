"""Groups of highlights: light of neighbouring texels comes to a pixel along nearly the same ray, so that one serves them all.

Layers that are four times as fine as the picture have sixteen texels in a pixel. Each would be carried to every pixel of the same
blurred image; grouped by 2x2 it is a quarter of the work.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import FloatArray

TEXELS_PER_PX = 2
"""Groups in a pixel of the picture along each axis, at least."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class Groups:
    """Groups of highlights.

    Attributes:
        owners: ``(n,)`` group of each texel.
        places: ``(m, 2)`` float32 place of each group in the layers, pixels: the mean over its light.
        plans: ``(m,)`` their plans, of whose fields ``base`` and ``exact`` mean nothing.
    """

    owners: NDArray[np.int64]
    places: FloatArray
    plans: NDArray[np.void]


def group_side(scale: float) -> int:
    """Texels of a group along each axis, for so many texels per pixel of the picture."""
    return max(1, int(scale) // TEXELS_PER_PX)


def group_highlights(texels: NDArray[np.uint32], plans: NDArray[np.void], side: int, blur_px: float) -> Groups:
    """Group texels of the same layer in squares whose depths blur alike.

    Args:
        texels: ``(n, 3)`` x, y and layer.
        plans: ``(n,)`` plan of each.
        side: texels of a square along each axis.
        blur_px: circle of confusion at a difference of 1/m of inverse depth, layer pixels.
    """
    x, y, layer = texels.astype(np.int64).T
    depth = np.floor(plans["excess"][:, 3].astype(np.float64) * blur_px).astype(np.int64)
    left_out, scattered = plans["box"][:, 2] <= plans["box"][:, 0], plans["cells"] > 0
    keys = np.stack([layer, y // side, x // side, depth, scattered, left_out], axis=1)
    if side == 1:
        order, starts = np.arange(len(texels)), np.arange(len(texels))
    else:
        order = np.lexsort(keys.T[::-1])
        changes = np.any(keys[order][1:] != keys[order][:-1], axis=1)
        starts = np.concatenate([[0], np.flatnonzero(changes) + 1]) if len(order) else np.zeros(0, np.int64)
    sizes = np.diff(np.append(starts, len(order)))
    owners = np.empty(len(order), np.int64)
    owners[order] = np.repeat(np.arange(len(starts)), sizes)
    held, grouped = plans[order], plans[order][starts]
    if side == 1 or len(order) == 0:
        return Groups(owners, texels[:, :2].astype(np.float32) + np.float32(0.5), grouped)
    weights = held["excess"][:, :3] @ _LUMINANCE + 1e-30
    total = np.add.reduceat(weights, starts)
    own = np.stack([x[order] + 0.5, y[order] + 0.5, held["excess"][:, 3]], axis=1) * weights[:, None]
    mean = np.add.reduceat(own, starts) / total[:, None]
    grouped["excess"][:, :3] = np.add.reduceat(held["excess"][:, :3].astype(np.float64), starts)
    grouped["excess"][:, 3] = mean[:, 2]
    grouped["box"][:, :2] = np.minimum.reduceat(held["box"][:, :2], starts)
    grouped["box"][:, 2:] = np.maximum.reduceat(held["box"][:, 2:], starts)
    grouped["bins"] = np.bitwise_or.reduceat(held["bins"], starts)
    grouped["front"] = np.maximum.reduceat(held["front"].view(np.float32), starts).view(np.uint32)
    grouped["cells"] = np.maximum.reduceat(held["cells"], starts)
    return Groups(owners, mean[:, :2].astype(np.float32), grouped)
