"""Place in the bounds of a part at which a focus point is where it already is, so that it follows the part without a jump."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pxr import Sdf

from render.errors import NotFoundError, SettingsError
from render.stage import AnchorReader
from usd_schemas import FocusPoint
from usd_schemas.settings.focus_point import MOST_BOUNDS_SIZES

_SAME_PLACE_M = 1e-3
"""Farthest that a point may be off as it begins to follow a part: only bounds without depth take it off at all."""


def place_in_part(anchors: AnchorReader, point: FocusPoint, part: str, time: float) -> tuple[float, float, float]:
    """Find where a focus point is in the bounds of a part.

    Args:
        anchors: of the stage.
        point: at the time. Where the part that it follows is lost, its place on its target counts.
        part: absolute path of the part to follow.
        time: USD time code.

    Returns:
        The place in the bounds, as ``boundsPoint``.

    Raises:
        NotFoundError: the point has no place at the time, or the part is not there or has no bounds then.
        SettingsError: the part's path is no absolute prim path, or the point is out of reach of its bounds.
        StageError: a transform is not finite, or flattens space.
    """
    if not (Sdf.Path.IsValidPathString(part) and Sdf.Path(part).IsPrimPath() and Sdf.Path(part).IsAbsolutePath()):
        raise SettingsError(
            f"focus point {point.name} can follow the bounds of a prim, by its absolute path, got {part!r}",
            code="bad_part",
            path=part,
        )
    try:
        position_m = anchors.position(point, time)
    except NotFoundError:
        if not point.part:
            raise
        position_m = anchors.position(replace(point, part=""), time)
    followed = replace(point, part=part)
    x, y, z = anchors.place_in_bounds(followed, position_m, time).tolist()
    followed = replace(followed, bounds_point=(x, y, z))
    off_m = np.linalg.norm(anchors.position(followed, time) - position_m)
    if not (max(map(abs, (x, y, z))) <= MOST_BOUNDS_SIZES and off_m < _SAME_PLACE_M):
        raise SettingsError(
            f"focus point {point.name} is out of reach of the bounds of {part}: follow a part that it is on",
            code="bad_part",
            path=part,
        )
    return x, y, z
