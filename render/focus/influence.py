"""Influence of each focus point on the focus, and the reason why a point has none."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from render.errors import SettingsError
from render.focus.overlap import OVERLAP_FRAME_WIDTHS, overlap_shares
from render.focus.points import NEAREST_DEPTH_M, FocusTargets
from render.model.arrays import BoolArray, DoubleArray

PointState = Literal[
    "used", "by_hand", "disabled", "zero_weight", "lost", "behind_camera", "outside_frame", "hidden", "pinhole"
]
"""State of a focus point: ``used``, or the reason why it has no influence.

``by_hand``: the camera is focused by hand, so no point is used. ``lost``: the point has no position, since its target is
missing or its values are not valid. ``behind_camera``: the point, or the focus that it requests, is not in front of the
camera. ``hidden``: another surface occludes it. ``pinhole``: it must be soft, and a pinhole blurs nothing.
"""

STATES: tuple[PointState, ...] = get_args(PointState)

Occluded = Literal["keep", "ignore", "fade"]
"""Policy for occluded points: use them all the same, do not use them, or reduce their weight by their visible share."""

SEEN = 0.5
"""Visible share below which a point is hidden."""

_INFINITE_DEPTH_M = 1e100
"""Finite depth used for infinity in logarithms."""


def state_codes(
    targets: FocusTargets, has_pupil: BoolArray, *, keep_outside: bool = False, occluded: Occluded = "keep"
) -> NDArray[np.int8]:
    """Find the state of each point: used, or the first reason why not.

    Args:
        targets: k points over n frames.
        has_pupil: ``(n,)`` or ``(1,)`` False where the lens is a pinhole.
        keep_outside: use points outside the picture too.
        occluded: policy for occluded points.

    Returns:
        ``(n, k)`` int8 indices into `STATES`.
    """
    least_visible = {"keep": -1.0, "ignore": SEEN, "fade": 0.0}[
        occluded
    ]  # visible shares are 0 or more: none is below -1
    with np.errstate(invalid="ignore"):
        behind = ~((targets.depths_m >= NEAREST_DEPTH_M) & (targets.aims_m >= NEAREST_DEPTH_M))
    rules: dict[PointState, BoolArray] = {
        "disabled": ~targets.enabled,
        "zero_weight": targets.weights == 0,
        "lost": np.isnan(targets.depths_m),
        "behind_camera": behind,
        "outside_frame": ~targets.in_frame & (not keep_outside),
        "hidden": (targets.visible <= least_visible) if occluded == "fade" else (targets.visible < least_visible),
        "pinhole": targets.is_blurred & ~has_pupil[:, None],
    }
    codes = [np.int8(STATES.index(state)) for state in rules]
    return np.asarray(np.select(list(rules.values()), codes, np.int8(STATES.index("used"))), np.int8)


def point_weights(
    targets: FocusTargets, used: BoolArray, near_priority: ArrayLike = 0.0, occluded: Occluded = "keep"
) -> DoubleArray:
    """Compute the weight of each point in the focus, in logarithms so that nothing overflows.

    Args:
        targets: k points over n frames.
        used: ``(n, k)`` points whose state is ``used``.
        near_priority: ``(n,)`` or one for all frames: exponent of inverse depth in the weights, 0 for none.
        occluded: policy for occluded points.

    Returns:
        ``(n, k)`` weights that add up to 1 in every frame, or are all 0 where no point is used.

    Raises:
        SettingsError: the near priority is negative or not finite.
    """
    power = np.atleast_1d(np.asarray(near_priority, np.float64))
    if not (np.isfinite(power).all() and (power >= 0).all()):
        worst = power[~(np.isfinite(power) & (power >= 0))][0]
        raise SettingsError(
            f"the near priority of the focus must be a finite number of 0 or more, but it is {worst:g}",
            code="bad_focus_point",
        )
    weights = strengths(targets, used, occluded)
    depths = np.where(used, np.minimum(targets.depths_m, _INFINITE_DEPTH_M), 1.0)
    with np.errstate(divide="ignore"):
        logs = np.log(weights) - power[:, None] * np.log(depths)
    heaviest = logs.max(axis=1, keepdims=True, initial=-np.inf)
    shares = np.exp(logs - np.where(np.isfinite(heaviest), heaviest, 0.0))
    return np.asarray(shares / np.maximum(shares.sum(axis=1, keepdims=True), 1.0))


def strengths(targets: FocusTargets, used: BoolArray, occluded: Occluded = "keep") -> DoubleArray:
    """Compute effective weights ``(n, k)``: 0 for points not used, reduced for points that fade or overlap others.

    Args:
        targets: k points over n frames.
        used: ``(n, k)`` points whose state is ``used``.
        occluded: policy for occluded points.
    """
    visible = np.minimum(targets.visible, 1.0) if occluded == "fade" else 1.0
    weights = np.where(used, targets.weights * visible, 0.0)
    reaches = np.broadcast_to(OVERLAP_FRAME_WIDTHS * targets.frame_widths[:, None], weights.shape)
    is_soft = targets.is_soft
    return np.asarray(weights * overlap_shares(targets.slopes, reaches, weights, is_soft, (weights > 0) & ~is_soft))
