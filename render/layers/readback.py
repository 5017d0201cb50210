"""Reading of surface ids: the prim and face at each pixel, and the exact surface point under a click."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from render.layers.peel import Peeler
from render.layers.surface_hits import SurfaceHits
from render.layers.targets import SurfaceTargets
from render.model.arrays import DoubleArray
from render.model.scene import Batch, Scene
from render.optics.view import PinholeView


@dataclass(frozen=True)
class Pick:
    """Picked point of a surface.

    Attributes:
        prim_path: prim that represents the instance: a mesh, an instance proxy or a PointInstancer.
        face: index of the authored face, or of the splat.
        fan_triangle: index of the triangle in the face's fan, corners ``(0, i + 1, i + 2)``.
        barycentric: weights of those corners.
        instance: number in `render.model.scene.Batch.instance_numbers`, or -1.
        prototype_path: the mesh inside the PointInstancer's prototype, or None.
        depth_m: depth along the view axis, from the entrance pupil; as `FrameRenderer.pick` returns it, from the camera's origin.
        position_m: position in the world.
    """

    prim_path: str
    face: int
    fan_triangle: int
    barycentric: tuple[float, float, float]
    instance: int
    prototype_path: str | None
    depth_m: float
    position_m: tuple[float, float, float]


def read_hits(peeler: Peeler, view: PinholeView) -> SurfaceHits:
    """Read the nearest surface at each pixel's centre: hits of ``(height, width)``."""
    w, objects, triangles = _read(peeler.draw_surfaces(view), view)
    first = np.array([draw.first_object for draw in peeler.index.draws])
    number = objects.astype(np.int64) - 1
    draws = np.searchsorted(first, number, side="right") - 1
    draws[objects == 0] = -1
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    slopes = np.stack([(x - view.cx) / view.fx, (view.cy - y) / view.fy], axis=-1)
    return SurfaceHits(w, draws.astype(np.int32), number, triangles.astype(np.int32), slopes)


def pick_surface(peeler: Peeler, scene: Scene, view: PinholeView, x: float, y: float) -> Pick | None:
    """Pick the nearest surface at picture position (x, y): draw one pixel around it, then intersect its triangle exactly. Of
    splats that hide half of it, the one at which they do."""
    one = replace(view, width=1, height=1, cx=view.cx - x + 0.5, cy=view.cy - y + 0.5)
    surface = _pick_triangle(peeler, scene, view, one, x, y)
    if not scene.splats:
        return surface
    from render.layers.splats import splat_in_middle  # few shots need it

    hidden = splat_in_middle(scene.splats, one)
    if hidden is None or (surface is not None and surface.depth_m <= hidden.depth_m):
        return surface
    origin, direction = view.ray(x, y)
    px, py, pz = (origin + hidden.depth_m * direction).tolist()
    batch = hidden.batch
    number = -1 if batch.instance_numbers is None else int(batch.instance_numbers[hidden.pose])
    return Pick(
        prim_path=scene.prim_paths[batch.prim_id],
        face=hidden.number,
        fan_triangle=0,
        barycentric=(1.0, 0.0, 0.0),
        instance=number,
        prototype_path=scene.prim_paths[batch.source_id] if number >= 0 else None,
        depth_m=hidden.depth_m,
        position_m=(px, py, pz),
    )


def _pick_triangle(
    peeler: Peeler, scene: Scene, view: PinholeView, one: PinholeView, x: float, y: float
) -> Pick | None:
    """Pick the nearest triangle in the one pixel ``one`` of a view."""
    w, objects, triangles = _read(peeler.draw_surfaces(one), one)
    if objects[0, 0] == 0:
        return None
    batch, pose = peeler.index.locate(int(objects[0, 0]) - 1)
    triangle = int(triangles[0, 0])
    corners = _world_corners(batch, pose, triangle)
    origin, direction = view.ray(x, y)
    weights = _barycentric(corners, origin, direction)
    position = weights @ corners
    depth = float(view.project(position[None])[1][0])
    return _describe(scene, batch, pose, triangle, weights, depth if depth > 0 else 1.0 / float(w[0, 0]), position)


def _describe(
    scene: Scene, batch: Batch, pose: int, triangle: int, weights: DoubleArray, depth_m: float, position: DoubleArray
) -> Pick:
    geometry = batch.geometry
    own_path = scene.prim_paths[geometry.prim_ids[triangle]]
    number = -1 if batch.instance_numbers is None else int(batch.instance_numbers[pose])
    fans, of_fans = geometry.fan_points(np.array([triangle]), weights[None])
    first, second, third = of_fans[0].tolist()
    instance_path = None if batch.instance_prim_ids is None else scene.prim_paths[batch.instance_prim_ids[pose]]
    return Pick(
        prim_path=instance_path or own_path,
        face=int(geometry.face_ids[triangle]),
        fan_triangle=int(fans[0]),
        barycentric=(first, second, third),
        instance=number,
        prototype_path=own_path if number >= 0 else None,
        depth_m=depth_m,
        position_m=(float(position[0]), float(position[1]), float(position[2])),
    )


def _world_corners(batch: Batch, pose: int, triangle: int) -> DoubleArray:
    corners = batch.geometry.positions[batch.geometry.triangles[triangle]].astype(np.float64)
    return np.asarray(corners @ batch.poses[pose][:3, :3].T + batch.poses[pose][:3, 3])


def _barycentric(corners: DoubleArray, origin: DoubleArray, direction: DoubleArray) -> DoubleArray:
    """Weights ``(3,)`` of the corners where the ray meets their plane, clamped to the triangle (Moeller & Trumbore 1997)."""
    e1, e2 = corners[1] - corners[0], corners[2] - corners[0]
    p = np.cross(direction, e2)
    determinant = e1 @ p
    if abs(determinant) < 1e-300:
        return np.full(3, 1 / 3)
    to_origin = origin - corners[0]
    u = to_origin @ p / determinant
    v = direction @ np.cross(to_origin, e1) / determinant
    weights = np.clip([1 - u - v, u, v], 0.0, 1.0)
    return np.asarray(weights / weights.sum())


def _read(surfaces: SurfaceTargets, view: PinholeView) -> tuple[DoubleArray, NDArray[np.uint32], NDArray[np.uint32]]:
    """Inverse depths, 1/m, and ids; 0 where nothing is."""
    shape = (surfaces.height, surfaces.width)
    ids = np.frombuffer(surfaces.ids.read(), np.uint32).reshape(*shape, 2)
    w = np.abs(np.frombuffer(surfaces.w.read(), np.float32).reshape(shape)).astype(np.float64)
    w = np.where(ids[..., 0] > 0, w + view.base_w, 0.0)
    return w, ids[..., 0], ids[..., 1]
