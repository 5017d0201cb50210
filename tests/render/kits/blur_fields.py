"""Light and radii for the post-filters, and a blur computed point by point."""

from __future__ import annotations

import moderngl
import numpy as np

from render.model.arrays import FloatArray
from render.model.lens import IrisShape
from render.postblur.blur_shape import AREA_STEPS, BlurShape
from render.postblur.point_spread import Field

IRISES = {
    "round": IrisShape(),
    "six blades": IrisShape(blades=6),
    "three blades": IrisShape(blades=3),
    "five, turned": IrisShape(blades=5, rotation_rad=0.4),
}


def blur_by_point(light: FloatArray, radii: FloatArray, shape: BlurShape, areas: FloatArray) -> FloatArray:
    """Blur light ``(h, w, 4)`` by radii ``(h, w)`` point by point: the reference for FLAG and gather."""
    height, width, _ = light.shape
    total = np.zeros(light.shape)
    for y, x in np.argwhere(radii > 0):
        radius = max(float(radii[y, x]), 0.25)
        area = np.interp(radius * AREA_STEPS, np.arange(len(areas)), areas)
        reach = int(np.ceil(radius)) + 1
        for column in range(max(x - reach, 0), min(x + reach + 1, width)):
            if column != x and abs(column - x) >= radius:
                continue
            up, down = radius * shape.reach(np.array((column - x) / radius))
            for row in range(max(y - reach, 0), min(y + reach + 1, height)):
                side = up if row < y else down
                share = np.clip(side + 0.5 - abs(row - y), 0, 1) if side >= 0.5 else 0.0
                if row == y:
                    share = (min(2 * up, 1) + min(2 * down, 1)) / 2
                total[row, column] += share * light[y, x] / area
    return total


def as_field(ctx: moderngl.Context, light: FloatArray, radii: FloatArray) -> Field:
    """Upload light ``(h, w, 4)`` with signed radii ``(h, w)``."""
    size = light.shape[1], light.shape[0]
    both = np.stack([radii, radii], axis=-1).astype(np.float32)
    light_made = ctx.texture(size, 4, np.ascontiguousarray(light, np.float32).tobytes(), dtype="f4")
    return Field(light_made, ctx.texture(size, 2, both.tobytes(), dtype="f4"), 0)


def as_array(texture: moderngl.Texture) -> FloatArray:
    """Read a texture of four channels back, ``(h, w, 4)``."""
    return np.frombuffer(texture.read(), np.float32).reshape(texture.height, texture.width, 4).copy()
