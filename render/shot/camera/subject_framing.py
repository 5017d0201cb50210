"""Frames a subject: the place of a camera, looking in its direction, from which the subject fills a share of the picture.

A subject is the ellipsoid that touches the sides of its bounds in their middles, so that a ball is framed exactly, and no subject
jumps in size where its bounds turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray

USUAL_SHARE = 2 / 3
"""Share of the picture's width or height that a subject fills."""
FRAMED_HEIGHT_M = 0.6
"""Height of the picture at a place without a size, metres: head and shoulders."""
NEAREST_M = 0.01
"""Least depth of a subject, metres."""
_LEAST_SIZE_M = 1e-6


@dataclass(frozen=True, eq=False)
class Subject:
    """Ellipsoid that is framed.

    Attributes:
        middle_m: ``(3,)`` in the world.
        halves_m: ``(3, 3)`` columns from there to the middles of three sides of its bounds; zeros for a place without a size.
    """

    middle_m: DoubleArray
    halves_m: DoubleArray

    @property
    def has_size(self) -> bool:
        """Whether it has any."""
        return bool(np.abs(self.halves_m).max() > _LEAST_SIZE_M)


@dataclass(frozen=True)
class PictureField:
    """Edges of a picture, as slopes in object space: metres to the right or up for each metre of depth."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def middle(self) -> DoubleArray:
        """``(2,)`` slopes of its middle."""
        return np.array([self.left + self.right, self.bottom + self.top]) / 2

    @property
    def size(self) -> DoubleArray:
        """``(2,)`` width and height."""
        return np.array([self.right - self.left, self.top - self.bottom])


def framing_pupil(subject: Subject, axes: DoubleArray, field: PictureField, share: float = USUAL_SHARE) -> DoubleArray:
    """``(3,)`` pupil in the world from which a subject is in the middle of a picture and fills a share of it.

    The width or the height is filled, and the other one at most as much. The outline of an ellipsoid is where planes through the
    pupil touch it: with S = H·Hᵀ of its halves, the normal n of such a plane has ``(n · (middle − pupil))² = nᵀ S n``.

    Args:
        subject: what is framed; of one without a size, the picture is `FRAMED_HEIGHT_M` high.
        axes: ``(3, 3)`` rows: unit vectors to the right, up and ahead.
        field: edges of the picture.
        share: above 0 and below 1.
    """
    if not subject.has_size:
        return depth_pupil(subject.middle_m, axes, field, FRAMED_HEIGHT_M / float(field.size[1]))
    own = axes @ subject.halves_m
    shape = own @ own.T
    ahead, across, mixed = shape[2, 2], np.diag(shape)[:2], shape[:2, 2]
    middle, filled = field.middle, (share * field.size / 2) ** 2
    # Both touching planes of a direction lie at equal slopes about the middle; u is depth² less the ellipsoid's own half depth².
    b = across - 2 * middle * mixed + (middle**2 - filled) * ahead
    u = ((b + np.sqrt(b**2 + 4 * filled * np.maximum(across * ahead - mixed**2, 0))) / (2 * filled)).max()
    depth = max(float(np.sqrt(u + ahead)), NEAREST_M)
    right, up = (middle * (depth**2 - ahead) + mixed) / depth
    return np.asarray(subject.middle_m - np.array([right, up, depth]) @ axes)


def depth_pupil(place_m: DoubleArray, axes: DoubleArray, field: PictureField, depth_m: float) -> DoubleArray:
    """``(3,)`` pupil in the world from which a place is in the middle of a picture, at a depth.

    Args:
        place_m: ``(3,)`` in the world.
        axes: as of `framing_pupil`.
        field: edges of the picture.
        depth_m: along the axis.
    """
    depth = max(depth_m, NEAREST_M)
    return np.asarray(place_m - np.array([*(field.middle * depth), depth]) @ axes)
