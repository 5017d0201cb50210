"""UsdLux lights and the dome as the uniform blocks that ``layers/lighting.glsl`` reads.

pyrender binds at most four lights of a kind, one uniform call for each number and primitive; one block for the whole
frame has room for all that a shot uses and costs nothing per primitive.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import Dome, Light

MAX_LIGHTS = 96
_ROWS = 11
_KINDS = {"distant": 0.0, "sphere": 1.0, "disk": 2.0, "rect": 2.0, "cylinder": 3.0}


@dataclass(frozen=True)
class ShadowSlot:
    """Shadow maps of a light.

    Attributes:
        first: number of the first map.
        count: number of maps.
        texel_m: width of a texel at 1 m (distant: anywhere), metres.
        origin: ``(3,)`` place that they are seen from, world.
        per_depth: change of depth in a map to that of 1/distance, 1/m (distant: of distance, m).
        outline: of the light's kernel (``layers/soft_shadow.glsl``): half its size along X and along Y, or its radius, metres
            (distant: tangent of its half angle); and 1 for a ball, 2 a disk, 3 a rect, 4 a tube, 0 for a light that is a point.
    """

    first: int
    count: int
    texel_m: float
    origin: DoubleArray
    per_depth: float = 0.0
    outline: tuple[float, float, float] = (0.0, 0.0, 0.0)


def select_lights(lights: tuple[Light, ...]) -> tuple[Light, ...]:
    """Select the lights that are drawn: all, or the `MAX_LIGHTS` strongest where there are more."""
    shining = [light for light in lights if max(light.radiance) > 0 and light.cone_angle_rad > 0]
    return tuple(shining if len(shining) <= MAX_LIGHTS else sorted(shining, key=light_power, reverse=True)[:MAX_LIGHTS])


def light_power(light: Light) -> float:
    """Rank of a light by its power: radiance times area; distant lights, which have no area, come first."""
    if light.kind == "distant":
        return 1e9 * max(light.radiance)
    return max(light.radiance) * area_m2(light)


def area_m2(light: Light) -> float:
    """Emitting area seen by a facing surface, m²."""
    if light.kind == "rect":
        return light.width_m * light.height_m
    if light.kind == "cylinder":
        return 2 * light.radius_m * light.length_m
    if light.triangles is not None:
        first, second, third = (light.triangles[:, corner] for corner in range(3))
        return (
            float(np.linalg.norm(np.cross(second - first, third - first), axis=1).sum()) / 8
        )  # a quarter, as a ball's
    return float(np.pi * light.radius_m**2)


def lighting_options(lights: Sequence[Light], slots: Collection[ShadowSlot]) -> dict[str, int | float | str]:
    """Defines of the parts of ``layers/lighting.glsl`` that lights need, so that others cost nothing.

    Args:
        lights: lights that are drawn.
        slots: their shadow slots; none where all shadows are hard.
    """
    is_soft = any(slot.outline[2] for slot in slots)
    needs = {
        "TUBES": any(light.kind == "cylinder" for light in lights),
        "PROFILES": any(light.profile is not None for light in lights),
        "FOCUSED": any(light.focus > 0 for light in lights),
        "SOFT_SHADOWS": is_soft,
        "COLORED_SHADOWS": is_soft and any(light.image is not None and light.casts_shadow for light in lights),
    }
    return {name: 1 for name, is_needed in needs.items() if is_needed}


def row_order(parts: Sequence[Sequence[Light]], shadows: Mapping[int, ShadowSlot]) -> list[int]:
    """Index in ``parts`` of the light of each row of the block: those with shadows first, as the shader's two loops have it."""
    order = sorted(range(len(parts)), key=lambda i: i not in shadows)
    return [i for i in order for _ in parts[i]]


def pack_lights(
    parts: Sequence[Sequence[Light]],
    dome: Dome | None,
    dome_rows: int,
    world_from_camera: DoubleArray,
    shadows: dict[int, ShadowSlot],
    profiles: Sequence[FloatArray] = (),
    filters: Mapping[int, int] | None = None,
) -> bytes:
    """The std140 bytes of ``LightBlock``, in the space of the camera.

    Args:
        parts: lights, each as the lights that it is drawn as (`render.layers.light_parts`); at most `MAX_LIGHTS` together.
        dome: dome light, or None.
        dome_rows: rows of the dome's image.
        world_from_camera: ``(4, 4)``.
        shadows: shadow slots by index in ``parts``.
        profiles: the lights' profiles, in the order of their texture's layers.
        filters: number of the first filter by index in ``parts``, of lights whose filters are drawn.
    """
    camera_from_world = np.asarray(np.linalg.inv(world_from_camera), np.float64)
    head = np.zeros((2, 4), np.float32)
    order = row_order(parts, shadows)
    head[0] = [len(order), dome is not None, dome_rows, sum(i in shadows for i in order)]
    dome_from_camera = np.eye(4)
    radiance = np.zeros(4)
    if dome is not None:
        dome_from_camera[:3, :3] = np.linalg.inv(unit_axes(dome.pose)) @ world_from_camera[:3, :3]
        head[1, :3] = np.multiply(dome.radiance, dome.diffuse)
        radiance[:3] = np.multiply(dome.radiance, dome.specular)
    rows = np.zeros((MAX_LIGHTS, _ROWS, 4), np.float32)
    drawn = ((part, i, number) for i in dict.fromkeys(order) for number, part in enumerate(parts[i]))
    for row, (part, i, number) in enumerate(drawn):
        rows[row] = _light_rows(part, camera_from_world, shadows.get(i))
        rows[row, 9, 3] = 0 if number else len(parts[i])
        if filters and i in filters:
            rows[row, 7, 3], rows[row, 8, 3] = filters[i], len(part.filters)
        rows[row, 6, 3] = next((n for n, profile in enumerate(profiles, 1) if profile is part.profile), 0)
    blocks = [head, dome_from_camera.T, world_from_camera.T, radiance, rows]
    return np.concatenate([np.asarray(part, np.float32).ravel() for part in blocks]).tobytes()


def _light_rows(light: Light, camera_from_world: DoubleArray, shadow: ShadowSlot | None) -> FloatArray:
    rotation = camera_from_world[:3, :3] @ unit_axes(light.pose)
    position = (camera_from_world @ light.pose[:, 3])[:3]
    area = area_m2(light)
    radius = np.sqrt(area / np.pi)
    if light.kind in ("distant", "cylinder"):
        radius = np.sin(light.angle_rad / 2) if light.kind == "distant" else light.radius_m
    rows = np.zeros((_ROWS, 4), np.float32)
    rows[0] = [*position, _KINDS[light.kind]]
    rows[1] = [*(-rotation[:, 2]), radius]
    rows[2] = [*light.radiance, area]
    outer = light.cone_angle_rad if light.cone_angle_rad < np.pi else 4.0
    rows[3] = [outer, min(outer * (1 - light.cone_softness), outer - 1e-4), light.diffuse, light.specular]
    rows[4] = [-1, 0, 0, 0] if shadow is None else [shadow.first, shadow.count, 1e-3, shadow.texel_m]
    rows[5] = [*(rotation[:, 0] * (light.length_m / 2 if light.kind == "cylinder" else 1.0)), light.focus]
    rows[6, :3] = light.focus_tint
    rows[7, :3] = light.shadow_color
    if shadow is not None:
        rows[8, :3] = (camera_from_world @ [*shadow.origin, 1.0])[:3]
        rows[9, :3] = shadow.outline
        reach_m = light.shadow_reach_m if np.isfinite(light.shadow_reach_m) else -1.0
        rows[10] = [shadow.per_depth, reach_m, min(light.shadow_fade_m, max(reach_m, 0.0)), light.shadow_gamma]
    return rows


def unit_axes(pose: DoubleArray) -> DoubleArray:
    """Axes of a pose at unit length: a light's scale is already part of its size."""
    axes = pose[:3, :3]
    lengths = np.linalg.norm(axes, axis=0)
    return np.asarray(axes / lengths) if lengths.min() > 0 else np.eye(3)
