"""Filters of lights as the uniform block that ``layers/light_filter.glsl`` reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.layers.shadows import light_outline
from render.model.arrays import DoubleArray, FloatArray
from render.model.light_filters import MAX_FILTERS, RAMP_STEPS, Barn, LightFilter
from render.model.scene import Light

_ROWS = 10
_BEFORE = {"all": 0.0, "cone": 1.0, "none": 2.0}
_MODES = {"distance": 1.0, "linear": 2.0, "spherical": 3.0, "radial": 4.0}
_LEAST = 1e-6  # relative to a window, of what the shader divides by


def place_filters(lights: Sequence[Light]) -> dict[int, int]:
    """Number of the first filter of each light that has any, by the light's index; those beyond `MAX_FILTERS` have none."""
    first: dict[int, int] = {}
    count = 0
    for i, light in enumerate(lights):
        if light.filters and count + len(light.filters) <= MAX_FILTERS:
            first[i] = count
            count += len(light.filters)
    return first


def filter_options(lights: Sequence[Light]) -> dict[str, int | float | str]:
    """Defines of shaders that light surfaces; none where no light is filtered."""
    return {"FILTERED": 1, "MAX_FILTERS": MAX_FILTERS, "RAMP_STEPS": RAMP_STEPS} if place_filters(lights) else {}


def pack_filters(parts: Sequence[Sequence[Light]], world_from_camera: DoubleArray) -> bytes:
    """The std140 bytes of ``FilterBlock``; empty where no light is filtered.

    Args:
        parts: lights, each as the lights that it is drawn as (`render.layers.light_parts`).
        world_from_camera: ``(4, 4)``.
    """
    lights = [part[0] for part in parts]
    first = place_filters(lights)
    if not first:
        return b""
    rows = np.zeros((MAX_FILTERS, _ROWS + RAMP_STEPS, 4), np.float32)
    for i, start in first.items():
        for number, one in enumerate(lights[i].filters, start):
            rows[number] = _rows(one, world_from_camera)
            rows[number, 9, :3] = light_outline(lights[i])
    return rows.tobytes()


def _rows(one: LightFilter, world_from_camera: DoubleArray) -> FloatArray:
    rows = np.zeros((_ROWS + RAMP_STEPS, 4), np.float32)
    rows[:4] = (np.linalg.inv(one.pose) @ world_from_camera).T
    rows[4] = [(-1.0 if one.inverted else 1.0) * one.density, one.strength, one.diffuse, one.specular]
    if isinstance(one.shape, Barn):
        window, source = one.shape.window, one.shape.source
        least = _LEAST * (sum(map(abs, window.sides)) + 1e-3)
        rows[5, :2] = [0.0, _BEFORE[one.shape.before] + (10.0 if source is None else 0.0)]
        rows[5, 2:] = np.maximum(window.radii, least)
        rows[6], rows[7] = window.sides, np.maximum(window.edges, 10 * least)
        rows[8] = source if source is not None else 0.0
    else:
        rows[5] = [_MODES[one.shape.mode], 0.0, one.shape.begin, one.shape.end]
        rows[_ROWS:, :3] = one.shape.colors
    return rows
