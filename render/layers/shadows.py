"""Where shadow maps look from: one map for a distant, disk, rect or spot light, six for a bare sphere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.layers.lights import ShadowSlot, power
from render.scene import DoubleArray, Light

MAX_SHADOW_MAPS = 12
SHADOW_MAP_SIDE_PX = 1024
_WIDEST_RAD = np.radians(150.0)
_CUBE_AXES = ((0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1))


@dataclass(frozen=True)
class ShadowPlan:
    """Which lights cast shadows, and the world-to-clip matrix of each map (reversed depth, zero to one).

    Attributes:
        slots: by the light's place in the list that was planned for.
        clip_from_world: ``(n, 4, 4)`` float64.
    """

    slots: dict[int, ShadowSlot]
    clip_from_world: DoubleArray


def plan_shadows(lights: tuple[Light, ...], centre: DoubleArray, radius_m: float) -> ShadowPlan:
    """Give the strongest casters the maps there are.

    Args:
        lights: as drawn.
        centre: ``(3,)`` of the sphere that holds the scene.
        radius_m: of that sphere.
    """
    slots: dict[int, ShadowSlot] = {}
    matrices: list[DoubleArray] = []
    casters = [i for i, light in enumerate(lights) if light.casts_shadow]
    for i in sorted(casters, key=lambda i: -power(lights[i])):
        maps, texel_m = _light_maps(lights[i], centre, radius_m)
        if len(matrices) + len(maps) <= MAX_SHADOW_MAPS:
            slots[i] = ShadowSlot(len(matrices), len(maps), texel_m)
            matrices += maps
    return ShadowPlan(slots, np.array(matrices).reshape(-1, 4, 4))


def sphere_around(corners: DoubleArray) -> tuple[DoubleArray, float]:
    """Centre ``(3,)`` and radius in metres of a sphere around points ``(n, 3)``; one metre at the origin where there are none."""
    if len(corners) == 0:
        return np.zeros(3), 1.0
    low, high = corners.min(0), corners.max(0)
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2) or 1.0


def _light_maps(light: Light, centre: DoubleArray, radius_m: float) -> tuple[list[DoubleArray], float]:
    position = light.pose[:3, 3]
    forward = -light.pose[:3, 2] / np.linalg.norm(light.pose[:3, 2])
    if light.kind == "distant":
        return [_parallel(forward, centre, radius_m)], 2 * radius_m / SHADOW_MAP_SIDE_PX
    far_m = float(np.linalg.norm(position - centre)) + radius_m
    near_m = max(0.02, light.radius_m * 1.01 if light.kind == "sphere" else 0.02)
    if light.kind == "sphere" and light.cone_angle_rad >= _WIDEST_RAD / 2:
        maps = [_perspective(position, sign * np.eye(3)[axis], np.pi / 2, near_m, far_m) for axis, sign in _CUBE_AXES]
        return maps, 2 / SHADOW_MAP_SIDE_PX
    field = min(2 * light.cone_angle_rad, _WIDEST_RAD)
    return [_perspective(position, forward, field, near_m, far_m)], 2 * np.tan(field / 2) / SHADOW_MAP_SIDE_PX


def _look(position: DoubleArray, forward: DoubleArray) -> DoubleArray:
    """``(4, 4)`` view from world, along -Z."""
    up = np.array([0.0, 1, 0]) if abs(forward[1]) < 0.9 else np.array([1.0, 0, 0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(right, forward), -forward])
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    matrix[:3, 3] = -axes @ position
    return matrix


def _parallel(forward: DoubleArray, centre: DoubleArray, radius_m: float) -> DoubleArray:
    view = _look(centre - forward * radius_m, forward)
    clip = np.diag([1 / radius_m, 1 / radius_m, 1 / (2 * radius_m), 1.0])
    clip[2, 3] = 1.0  # reversed: 1 at the light's side, 0 beyond the scene
    return clip @ view


def _perspective(
    position: DoubleArray, forward: DoubleArray, field_rad: float, near_m: float, far_m: float
) -> DoubleArray:
    scale = 1 / np.tan(field_rad / 2)
    far_m = max(far_m, near_m * 1.001)
    clip = np.zeros((4, 4))
    clip[0, 0] = clip[1, 1] = scale
    clip[2, 2] = near_m / (far_m - near_m)
    clip[2, 3] = near_m * far_m / (far_m - near_m)
    clip[3, 2] = -1
    return clip @ _look(position, forward)
