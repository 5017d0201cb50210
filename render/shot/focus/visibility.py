"""Whether something stands between a camera and places in the world: what ``focus:occluded`` asks."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.thin_lens import pupil_radius_m
from render.shot.focus.obstacles import Lines, passed

_OWN_SURFACE = 1e-4
"""How near to a place, as a share of the way from the lens to it, a surface counts as the place's own and hides nothing."""

_GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))


def visible(scene: Scene, camera: Camera, positions_m: DoubleArray, *, rays: int = 16) -> DoubleArray:
    """How much of a camera's entrance pupil sees each of some places.

    A lens looks around what is narrower than its pupil, so that what passes before a place takes it from sight little by little.
    What the surfaces between let through is counted as they are drawn: cut-outs have holes, glass dims, the backs of one-sided
    surfaces and what is nearer than the camera's clipping range are not there. Whether a place is inside the picture is not
    asked.

    Args:
        scene: what is there, at the time.
        camera: stands at the centre of the entrance pupil.
        positions_m: ``(k, 3)`` places in the world; NaN for none.
        rays: to each place, spread over the pupil; a pinhole needs one.

    Returns:
        ``(k,)`` float64 from 0, hidden, to 1, seen. Places that do not exist, or that lie behind the camera or before the
        clipping range, are not seen.
    """
    places = np.asarray(positions_m, np.float64).reshape(-1, 3)
    depths_m = (camera.world_from_camera[:3, 3] - places) @ camera.world_from_camera[:3, 2]
    there = np.flatnonzero(np.isfinite(places).all(axis=1) & (depths_m > camera.near_m))
    ways = _over_pupil(camera, rays) - places[there, None]
    # a surface's own points are known to single precision
    rounding_m = 8 * np.finfo(np.float32).eps * np.abs(places[there]).max(axis=1, initial=0.0)
    own = _OWN_SURFACE + rounding_m / np.linalg.norm(ways, axis=-1).min(axis=1, initial=np.inf)
    lines = Lines(places[there], ways, first=own, last=1 - camera.near_m / depths_m[there])
    seen = np.zeros(len(places))
    seen[there] = passed(scene, lines).mean(axis=1)
    return seen


def _over_pupil(camera: Camera, rays: int) -> DoubleArray:
    """``(rays, 3)`` places in the world spread evenly over the entrance pupil (Vogel 1979, the sunflower's spiral)."""
    radius_m = pupil_radius_m(camera)
    count = np.arange(rays if radius_m > 0 else 1)
    out = radius_m * np.sqrt((count + 0.5) / len(count))
    turn = count * _GOLDEN_ANGLE_RAD
    across = np.stack([out * np.cos(turn), out * np.sin(turn)], axis=1)
    world_from_camera = np.asarray(camera.world_from_camera, np.float64)
    return np.asarray(world_from_camera[:3, 3] + across @ world_from_camera[:3, :2].T)
