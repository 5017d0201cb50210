"""Light and radii for the post-filters, and a blur computed point by point."""

from __future__ import annotations

import moderngl
import numpy as np

from render.model.arrays import FloatArray
from render.model.lens import IrisShape
from render.postblur.blur_shape import COLUMNS, BlurShape
from render.postblur.point_spread import Field

IRISES = {
    "round": IrisShape(),
    "six blades": IrisShape(blades=6),
    "three blades": IrisShape(blades=3),
    "five, turned": IrisShape(blades=5, rotation_rad=0.4),
}


def columns_of(shape: BlurShape, radius: float) -> list[tuple[int, float, float]]:
    """Columns of a shape in pixels: offset to the right, extents up and down."""
    left, right = (radius * end for end in shape.span)
    offsets = [dx for dx in range(int(left) - 1, int(right) + 2) if dx == 0 or left < dx < right]
    ends = np.linspace(left, right, COLUMNS)
    up, down = (radius * np.interp(offsets, ends, side) for side in shape.edges.T)
    return list(zip(offsets, up, down, strict=True))


def _half(extent: float, steps: int) -> float:
    """Share of a pixel within this extent of the middle; half a pixel belongs to each side of the middle row."""
    if steps == 0:
        return float(np.clip(extent, 0, 0.5))
    return float(np.clip(extent + 0.5 - steps, 0, 1)) if extent >= 0.5 else 0.0


def blur_by_point(light: FloatArray, radii: FloatArray, shape: BlurShape) -> FloatArray:
    """Blur light ``(h, w, 4)`` by radii ``(h, w)`` point by point: the reference for FLAG and gather."""
    height, width, _ = light.shape
    total = np.zeros(light.shape)
    for y, x in np.argwhere(radii > 0):
        radius = max(float(radii[y, x]), 0.25)
        columns, reach = columns_of(shape, radius), int(np.ceil(radius)) + 1
        area = sum(up + down for _, up, down in columns)
        for offset, up, down in columns:
            if not 0 <= x + offset < width:
                continue
            for row in range(max(y - reach, 0), min(y + reach + 1, height)):
                sides = [(up, down), (down, up)][: 2 if row == y else 1] if row <= y else [(down, up)]
                share = sum(_half(far, abs(row - y)) - _half(-near, abs(row - y)) for far, near in sides)
                total[row, x + offset] += share * light[y, x] / area
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
