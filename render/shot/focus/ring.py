"""The focus ring of a camera's lens, from its close-focus mark and its throw."""

from __future__ import annotations

import math
from dataclasses import replace

from render.errors import PullfocusError
from render.focus.tracking import FocusRing
from render.model.camera import Camera
from render.optics.prescription.mounting import distance_from_film_m, has_surfaces

_STEPS = 4
"""Fixed-point steps. The pupil hardly moves in the lens as it focuses, so that each step reduces the error a thousandfold."""


def close_focus_depth_m(camera: Camera) -> float:
    """Depth of the nearest focus from the entrance pupil; 0 where the lens has no mark.

    The mark is a distance from the film. From there to the entrance pupil a thin lens has ``v`` with
    ``1/u + 1/v = 1/f``, so ``u² - D·u + D·f = 0``; a mark nearer than ``4 f``, which no thin lens reaches, is taken as life
    size. A lens with surfaces has its own pupil, for which the depth is refined from there.

    Args:
        camera: its own focus is ignored.
    """
    marked_m, focal_m = camera.lens.close_focus_m, camera.focal_length_mm / 1000
    if marked_m <= 0:
        return 0.0
    depth_m = (marked_m + math.sqrt(max(marked_m**2 - 4 * marked_m * focal_m, 0.0))) / 2
    depth_m = max(depth_m, 2 * focal_m)
    if not has_surfaces(camera):
        return depth_m
    try:
        for _ in range(_STEPS):
            depth_m += marked_m - distance_from_film_m(replace(camera, focus_distance_m=depth_m))
    except PullfocusError:  # a lens that does not reach its mark is reported as a finding
        pass
    return max(depth_m, focal_m)


def focus_ring(camera: Camera, throw_deg: float) -> FocusRing | None:
    """Read the focus ring of a camera; None where the lens has no throw or no close focus.

    Args:
        camera: its own focus is ignored.
        throw_deg: lens:focusThrow.
    """
    close_m = close_focus_depth_m(camera)
    if not (close_m > 0 and 0 < throw_deg < math.inf):
        return None
    return FocusRing(math.radians(throw_deg), close_m)
