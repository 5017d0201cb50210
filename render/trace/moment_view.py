"""View of a camera at one moment of the exposure, onto layers that were peeled in the middle of it.

A straight ray from the camera's position at the moment is straight in the middle's frame too, so that its line ``s(w) = a + b·w``
only gets other coefficients: the camera's own motion needs no velocities, and is exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.view import PinholeView

_AHEAD = np.diag([1.0, -1.0, -1.0])  # from camera space to x right, y down, z ahead


@dataclass(frozen=True, eq=False)
class MomentView:
    """View at one moment.

    Attributes:
        peeled_for: view in the middle of the interval, for which the layers were peeled.
        view: view at the moment.
        shutter_time: -0.5 as the shutter opens, 0.5 as it closes.
    """

    peeled_for: PinholeView
    view: PinholeView
    shutter_time: float

    @property
    def turn(self) -> DoubleArray:
        """Rotation ``(3, 3)`` to the axes of the middle (x right, y down, z ahead) from those of the moment."""
        return np.asarray(_AHEAD @ self._middle_from_moment[:3, :3] @ _AHEAD)

    @property
    def move_m(self) -> DoubleArray:
        """Position ``(3,)`` of the pupil's centre at the moment, in the axes of the middle, metres."""
        return np.asarray(_AHEAD @ self._middle_from_moment[:3, 3])

    @property
    def _middle_from_moment(self) -> DoubleArray:
        return self.peeled_for.camera_from_world @ np.linalg.inv(self.view.camera_from_world)

    def uniforms(self, layers: PinholeView) -> dict[str, object]:
        """Uniforms of ``lens/lens_rays.glsl`` and ``layers/carried.glsl`` for layers that have this view."""
        scale = layers.fx / self.peeled_for.fx
        offset = layers.cx - scale * self.peeled_for.cx, layers.cy - scale * self.peeled_for.cy
        return {
            "scale": scale,
            "offset": offset,
            "axis": (scale * self.view.cx + offset[0], scale * self.view.cy + offset[1]),
            "focal_px": (scale * self.view.fx, scale * self.view.fy),
            "layer_axis": (layers.cx, layers.cy),
            "layer_focal": (layers.fx, layers.fy),
            "nearest_m": layers.near_m,
            "camera_turn": tuple(self.turn.T.ravel()),
            "camera_move": tuple(self.move_m),
            "shutter_time": self.shutter_time,
        }
