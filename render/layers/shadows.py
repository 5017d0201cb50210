"""Placement of shadow maps: one map for a distant, disk, rect or spot light, six for a light that shines all around."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.layers.lights import ShadowSlot, area_m2, light_power, unit_axes
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import POINT_RADIUS_M, Light

MAX_SHADOW_MAPS = 36
"""Maps of all lights: 4 MiB each, 4 MiB more each where things move, and 5.3 MiB more each where any light has a size."""
SHADOW_MAP_SIDE_PX = 1024
_WIDEST_RAD = np.radians(150.0)
_ALL_AROUND = ("sphere", "cylinder", "mesh")
_FACE_MARGIN = 1.2  # of six maps: a penumbra near the edge of one is all in it
_SHAPES = {"distant": 1.0, "sphere": 1.0, "mesh": 1.0, "disk": 2.0, "rect": 3.0, "cylinder": 4.0}
_LEAST_HALF = 1e-5
_CUBE_AXES = ((0, 1), (0, -1), (1, 1), (1, -1), (2, 1), (2, -1))


@dataclass(frozen=True)
class Sphere:
    """A sphere in the world, metres."""

    x: float
    y: float
    z: float
    radius_m: float

    @property
    def centre(self) -> DoubleArray:
        """Centre ``(3,)``, metres."""
        return np.array([self.x, self.y, self.z])

    def is_close_to(self, other: Sphere) -> bool:
        """Whether this sphere lies well within the other, and the other is not much larger."""
        apart_m = float(np.linalg.norm(self.centre - other.centre))
        return apart_m + 0.5 * self.radius_m <= other.radius_m <= 2 * self.radius_m


@dataclass(frozen=True)
class ShadowPlan:
    """Lights that cast shadows, and the world-to-clip matrix of each map (reversed depth, zero to one).

    Attributes:
        slots: shadow slots by the light's index in the planned list.
        clip_from_world: ``(n, 4, 4)`` float64.
    """

    slots: dict[int, ShadowSlot]
    clip_from_world: DoubleArray


def plan_shadows(lights: tuple[Light, ...], whole: Sphere, region: Sphere | None = None) -> ShadowPlan:
    """Assign the available maps to the strongest lights.

    Args:
        lights: lights that are drawn.
        whole: sphere around the scene.
        region: where a distant light's shadows are resolved, if the scene is larger.
    """
    part = whole if region is None or region.radius_m >= whole.radius_m else region
    slots: dict[int, ShadowSlot] = {}
    matrices: list[DoubleArray] = []
    casters = [i for i, light in enumerate(lights) if light.casts_shadow]
    for i in sorted(casters, key=lambda i: -light_power(lights[i])):
        maps, texel_m, per_depth = _light_maps(lights[i], whole, part)
        if len(matrices) + len(maps) <= MAX_SHADOW_MAPS:
            place = lights[i].pose[:3, 3]
            slots[i] = ShadowSlot(len(matrices), len(maps), texel_m, place, per_depth, light_outline(lights[i]))
            matrices += maps
    return ShadowPlan(slots, np.array(matrices).reshape(-1, 4, 4))


def lights_without_shadow(lights: tuple[Light, ...]) -> list[str]:
    """Paths of the lights that request a shadow and get none, since stronger lights take all maps."""
    slots = plan_shadows(lights, Sphere(0, 0, 0, 1.0)).slots
    return [light.path for i, light in enumerate(lights) if light.casts_shadow and i not in slots]


def sphere_around(corners: DoubleArray) -> Sphere:
    """Sphere around points ``(n, 3)``; one metre at the origin where there are none."""
    if len(corners) == 0:
        return Sphere(0, 0, 0, 1.0)
    low, high = corners.min(0), corners.max(0)
    x, y, z = (float(v) for v in (low + high) / 2)
    return Sphere(x, y, z, float(np.linalg.norm(high - low) / 2) or 1.0)


def light_outline(light: Light) -> tuple[float, float, float]:
    """Outline of a light's kernel, as of `ShadowSlot`. A point whose shadows end has one too, since that takes their distance."""
    match light.kind:
        case "distant":
            half_x = half_y = float(np.tan(min(light.angle_rad / 2, _WIDEST_RAD / 2)))
        case "rect":
            half_x, half_y = light.width_m / 2, light.height_m / 2
        case "cylinder":
            half_x, half_y = light.length_m / 2, light.radius_m
        case "mesh":
            half_x = half_y = float(np.sqrt(area_m2(light) / np.pi))
        case _:
            half_x = half_y = light.radius_m
    least = 0.0 if light.kind == "distant" else POINT_RADIUS_M
    is_point = max(half_x, half_y) <= least and np.isinf(light.shadow_reach_m)
    return max(half_x, _LEAST_HALF), max(half_y, _LEAST_HALF), 0.0 if is_point else _SHAPES[light.kind]


def _light_maps(light: Light, whole: Sphere, part: Sphere) -> tuple[list[DoubleArray], float, float]:
    """Matrices of a light's maps, the width of a texel at 1 m, and the change of 1/distance (or distance) with depth."""
    position = light.pose[:3, 3]
    forward = -unit_axes(light.pose)[:, 2]
    if light.kind == "distant":
        return [_orthographic(forward, whole, part)], 2 * part.radius_m / SHADOW_MAP_SIDE_PX, 2 * whole.radius_m
    near_m = max(0.02, light.radius_m * 1.01 if light.kind in _ALL_AROUND else 0.02)
    far_m = max(float(np.linalg.norm(position - whole.centre)) + whole.radius_m, near_m * 1.001)
    per_depth = 1 / near_m - 1 / far_m
    if light.kind in _ALL_AROUND and light.cone_angle_rad >= _WIDEST_RAD / 2:
        field = 2 * float(np.arctan(_FACE_MARGIN if light_outline(light)[2] else 1.0))
        maps = [_perspective(position, sign * np.eye(3)[axis], field, near_m, far_m) for axis, sign in _CUBE_AXES]
    else:
        field = min(2 * light.cone_angle_rad, _WIDEST_RAD)
        maps = [_perspective(position, forward, field, near_m, far_m)]
    return maps, 2 * float(np.tan(field / 2)) / SHADOW_MAP_SIDE_PX, per_depth


def _view_matrix(position: DoubleArray, forward: DoubleArray) -> DoubleArray:
    """View matrix ``(4, 4)``, looking along -Z."""
    up = np.array([0.0, 1, 0]) if abs(forward[1]) < 0.9 else np.array([1.0, 0, 0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(right, forward), -forward])
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    matrix[:3, 3] = -axes @ position
    return matrix


def _orthographic(forward: DoubleArray, whole: Sphere, part: Sphere) -> DoubleArray:
    """Orthographic matrix of a distant light's map.

    Across the light, the map covers ``part``, in steps of whole texels so that edges do not swim as the camera moves;
    along the light it covers the whole scene, since casters may be far outside.
    """
    view = _view_matrix(np.zeros(3), forward)
    texel = 2 * part.radius_m / SHADOW_MAP_SIDE_PX
    x, y = np.round((view[:3, :3] @ part.centre)[:2] / texel) * texel
    depth = float((view[:3, :3] @ whole.centre)[2])
    clip = np.diag([1 / part.radius_m, 1 / part.radius_m, 1 / (2 * whole.radius_m), 1.0])
    clip[:3, 3] = [-x / part.radius_m, -y / part.radius_m, 0.5 - depth / (2 * whole.radius_m)]
    return np.asarray(clip @ view)


def _perspective(
    position: DoubleArray, forward: DoubleArray, field_rad: float, near_m: float, far_m: float
) -> DoubleArray:
    scale = 1 / np.tan(field_rad / 2)
    clip = np.zeros((4, 4))
    clip[0, 0] = clip[1, 1] = scale
    clip[2, 2] = near_m / (far_m - near_m)
    clip[2, 3] = near_m * far_m / (far_m - near_m)
    clip[3, 2] = -1
    return clip @ _view_matrix(position, forward)


def shadow_region(camera: Camera) -> Sphere:
    """Region in which a distant light's shadows are resolved in a large scene: around a point near the focus, at least
    twelve metres. The point's distance is a power of two, so that shadows stand still, and are kept, while the focus is pulled.
    """
    stated_m, seen_m = camera.stated_focus_m, camera.covered_mm / 2000 if camera.orthographic else 0.0
    focus_m = stated_m if 0 < stated_m < 1000 else 10.0
    distance_m = 2.0 ** round(np.log2(focus_m))
    ahead_m = camera.set_back_m + distance_m
    x, y, z = (float(v) for v in camera.world_from_camera[:3, 3] - ahead_m * camera.world_from_camera[:3, 2])
    return Sphere(x, y, z, max(12.0, 2.5 * distance_m, seen_m))
