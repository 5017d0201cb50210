"""The stage's frame, units and time against ours: metres, +Y up, column vectors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom

from render.model.arrays import DoubleArray
from usd_schemas.units import metres_per_unit

# Turns +Z to +Y: the same rotation that a Z-up asset gets when it is brought into a Y-up scene.
_Y_UP_FROM_Z_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], np.float64)


@dataclass(frozen=True)
class FrameRange:
    """The frames of a shot.

    Attributes:
        start: first frame, in time codes.
        end: last frame, included.
        frames_per_second: time codes per second.
    """

    start: float
    end: float
    frames_per_second: float


def world_from_stage(stage: Usd.Stage) -> DoubleArray:
    """``(4, 4)`` matrix from the stage's space to the world: its units to metres and its up axis to +Y."""
    scale = np.diag([*[metres_per_unit(stage)] * 3, 1.0])
    turn = np.eye(4) if is_y_up(stage) else _Y_UP_FROM_Z_UP
    return turn @ scale


def is_y_up(stage: Usd.Stage) -> bool:
    """Whether +Y is up. Any other ``upAxis``, also one that USD does not have, is taken as Z, as usdrecord does."""
    return bool(UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y)


def frame_range(stage: Usd.Stage) -> FrameRange:
    """The stage's authored frame range; a stage without one has the single frame 0."""
    return FrameRange(stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond())


def column_matrix(matrix: Gf.Matrix4d) -> DoubleArray:
    """A USD matrix (row vectors) as a ``(4, 4)`` float64 array for column vectors."""
    return np.array(matrix, np.float64).T


def rigid_frame(matrix: DoubleArray) -> DoubleArray:
    """The rotation and translation of a ``(4, 4)`` matrix, without its scale and shear.

    Keeps the direction of Z, then that of Y as near as it can be. For a mirroring matrix X is turned about, since a camera or a
    light has to stay right-handed.
    """
    z = _unit(matrix[:3, 2])
    x = _unit(np.cross(matrix[:3, 1], z))
    frame = np.eye(4)
    frame[:3, 0], frame[:3, 1], frame[:3, 2], frame[:3, 3] = x, np.cross(z, x), z, matrix[:3, 3]
    return frame


def _unit(vector: DoubleArray) -> DoubleArray:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else vector
