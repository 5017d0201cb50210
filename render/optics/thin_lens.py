"""The thin lens in the one equation: ``s(w) = p + f_px·l·(w - w_f)``, with w inverse depth and l on the pupil.

Potmesil & Chakravarty 1981 give the circle of confusion of a thin lens; written in inverse depth it is linear.
"""

from __future__ import annotations

import numpy as np

from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.focal_surface import FocalPlane, FocalSurface


def pupil_radius_m(camera: Camera) -> float:
    """Radius of the entrance pupil in metres, ``f / 2N``; 0 for a pinhole (f-number 0)."""
    return camera.focal_length_mm / (2000.0 * camera.f_stop) if camera.f_stop > 0 else 0.0


def focus_w(camera: Camera) -> float:
    """Inverse depth of the plane of focus in 1/m; 0 when focused at infinity."""
    d = camera.focus_distance_m
    return 0.0 if d <= 0 or np.isinf(d) else 1.0 / d


def focal_surface(camera: Camera) -> FocalSurface:
    """The camera's focal surface, or the upright plane at its focus distance."""
    return camera.focal_surface or FocalSurface(FocalPlane(focus_w(camera)))


def coc_radius_px(f_px: float, pupil_m: float, w: FloatArray | float, w_f: float) -> FloatArray:
    """Signed radius of the circle of confusion in pixels: negative in front of the plane of focus, positive behind it.

    Args:
        f_px: focal length in pixels.
        pupil_m: radius of the entrance pupil, metres.
        w: inverse depths, 1/m; 0 is infinity.
        w_f: inverse depth of the plane of focus, 1/m.
    """
    return np.asarray(f_px * pupil_m * (w_f - np.asarray(w)))
