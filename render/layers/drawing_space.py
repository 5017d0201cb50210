"""Space that a view's surfaces are drawn in: camera space, its origin moved to the prim's where the camera stands far back.

Single precision holds a position a kilometre away to a tenth of a millimetre. What an orthographic camera sees lies so far from
its pupil that positions, depths and inverse depths are drawn relative to what is near them: positions to the prim's origin,
inverse depths to `PinholeView.base_w`, as an affine function of the depth buffer's values.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray
from render.optics.view import PinholeView


@dataclass(frozen=True, eq=False)
class DrawingSpace:
    """Space that a view's surfaces are drawn in, metres.

    Attributes:
        from_world: ``(4, 4)`` float64, to this space.
        clip: ``(4, 4)`` float64, from this space to OpenGL's clip space.
        eye: ``(3,)`` eye of the view.
        clip_planes: ``(a, b, c, d)`` each, as of `PinholeView`.
        w_of_depth: factor of a depth buffer's value, and what is added, to have the layers' w, 1/m; zeros where the perspective
            division gives it.
        far: w, depth from the pupil and z in this space of the far plane; zeros for a camera that does not stand back.
    """

    from_world: DoubleArray
    clip: DoubleArray
    eye: tuple[float, float, float]
    clip_planes: tuple[tuple[float, float, float, float], ...]
    w_of_depth: tuple[float, float] = (0.0, 0.0)
    far: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @classmethod
    def of_view(cls, view: PinholeView) -> DrawingSpace:
        """Make the space of a view."""
        eye_x, eye_y, back_m = view.eye_x_m, view.eye_y_m, view.set_back_m
        clip = view.projection_matrix()
        if back_m == 0:
            return cls(view.camera_from_world, clip, (eye_x, eye_y, 0.0), view.clip_planes)
        ahead = np.eye(4)
        ahead[2, 3] = back_m
        near_w, far_w = 1 / view.near_m, 1 / view.far_m
        return cls(
            ahead @ view.camera_from_world,
            clip @ np.linalg.inv(ahead),
            (eye_x, eye_y, back_m),
            tuple((a, b, c, d - c * back_m) for a, b, c, d in view.clip_planes),
            (near_w - far_w, far_w - view.base_w),
            (far_w - view.base_w, view.far_m, back_m - view.far_m),
        )
