"""Visibility of points in the world from the lens of a camera, for ``focus:occluded``."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.thin_lens import pupil_radius_m
from render.shot.focus.obstacles import Lines, transmittance

_OWN_SURFACE = 1e-4
"""Surfaces within this share of the way from a point to the lens are the point's own and hide nothing."""

_GOLDEN_ANGLE_RAD = np.pi * (3 - np.sqrt(5))


def visible_shares(scene: Scene, camera: Camera, positions_m: DoubleArray, *, rays: int = 16) -> DoubleArray:
    """Compute the share of a camera's entrance pupil that sees each of some points.

    A lens sees around what is narrower than its pupil, so that an object passing before a point hides it gradually. Surfaces
    between let light through as they are drawn: cut-outs have holes, glass dims, and back faces that are left out, and
    whatever is nearer than the camera's clipping range or cut off by its clip planes hide nothing. The frame of the picture is
    ignored.

    Args:
        scene: at the time.
        camera: stands at the centre of the entrance pupil.
        positions_m: ``(k, 3)`` points in the world; NaN for none.
        rays: to each point, spread over the pupil; a pinhole needs one.

    Returns:
        ``(k,)`` float64 from 0, hidden, to 1, seen. Points that do not exist, that lie behind the camera or nearer than
        the clipping range, or that a clip plane cuts off, are not seen.
    """
    points = np.asarray(positions_m, np.float64).reshape(-1, 3)
    depths_m = (camera.world_from_camera[:3, 3] - points) @ camera.world_from_camera[:3, 2]
    ahead = np.flatnonzero(np.isfinite(points).all(axis=1) & (depths_m > camera.near_m))
    ahead = ahead[_clipped_at(camera, points[ahead]) > 0]
    ways = _pupil_points(camera, rays) - points[ahead, None]
    # positions on a surface have single precision
    rounding_m = 8 * np.finfo(np.float32).eps * np.abs(points[ahead]).max(axis=1, initial=0.0)
    own = _OWN_SURFACE + rounding_m / np.linalg.norm(ways, axis=-1).min(axis=1, initial=np.inf)
    last = np.minimum(1 - camera.near_m / depths_m[ahead], _clipped_at(camera, points[ahead]))
    lines = Lines(points[ahead], ways, first=own, last=last)
    shares = np.zeros(len(points))
    shares[ahead] = transmittance(scene.seen_by(camera.path), lines).mean(axis=1)
    return shares


def _clipped_at(camera: Camera, points: DoubleArray) -> DoubleArray:
    """``(k,)`` share of the way from points to the middle of the pupil that clip planes leave; 0 for points they cut off."""
    last = np.ones(len(points))
    in_camera = (points - camera.world_from_camera[:3, 3]) @ camera.world_from_camera[:3, :3]
    for *normal, offset in camera.clip_planes:
        here = in_camera @ normal + offset
        last = np.where(here < 0, 0.0, last)
        if offset < 0:
            last = np.minimum(last, np.maximum(here, 0.0) / (np.maximum(here, 0.0) - offset))
    return last


def _pupil_points(camera: Camera, rays: int) -> DoubleArray:
    """``(rays, 3)`` points in the world spread evenly over the entrance pupil (Vogel 1979, the sunflower's spiral)."""
    radius_m = pupil_radius_m(camera)
    count = np.arange(rays if radius_m > 0 else 1)
    out = radius_m * np.sqrt((count + 0.5) / len(count))
    turn = count * _GOLDEN_ANGLE_RAD
    across = np.stack([out * np.cos(turn), out * np.sin(turn)], axis=1)
    world_from_camera = np.asarray(camera.world_from_camera, np.float64)
    return np.asarray(world_from_camera[:3, 3] + across @ world_from_camera[:3, :2].T)
