"""Shell parts that both robots are made of: pillowy heads, patches that lie on them, hands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.demo.shapes.kit import ball, hoop, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge


@dataclass(frozen=True)
class Pillow:
    """A superellipsoid about the origin: |x/a|^n + |y/b|^n + |z/c|^n = 1 (Barr, 1981).

    Attributes:
        half_m: half axes a, b, c.
        power: n; 2 is an ellipsoid, more is boxier.
    """

    half_m: tuple[float, float, float]
    power: float

    def project(self, yaw: Array, pitch: Array, scale: float = 1.0) -> Array:
        """Points on the surface by direction: radians about +Y from +Z, and up."""
        direction = np.stack([np.sin(yaw) * np.cos(pitch), np.sin(pitch), np.cos(yaw) * np.cos(pitch)], axis=-1)
        size = (np.abs(direction / np.array(self.half_m)) ** self.power).sum(axis=-1) ** (-1 / self.power)
        return np.asarray(scale * direction * size[..., None])

    def shell(self, columns: int = 64, rows: int = 40) -> Mesh:
        """The whole of it."""
        return surface(lambda u, v: self.project(2 * np.pi * u, np.pi * (np.clip(v, 0, 1) - 0.5)), columns + 1, rows)

    def patch(self, yaw: float, pitch: float, wide: float, tall: float, scale: float, power: float = 2.0) -> Mesh:
        """A rounded patch laid on the shell and bowed off it in the middle.

        Args:
            yaw: of its middle, radians.
            pitch: of its middle, radians.
            wide: half its width, radians.
            tall: half its height, radians.
            scale: offset of its rim from the shell; its middle is a little farther.
            power: of its outline; 2 is an ellipse, more is boxier.
        """

        def shape(u: Array, v: Array) -> Array:
            x, y = _outline(2 * np.pi * u, power)
            reach = 1 - np.clip(v, 0, 1)
            return self.project(yaw + wide * x * reach, pitch + tall * y * reach, scale) * (
                1 + 0.02 * (1 - reach**2)[..., None]
            )

        return surface(shape, 49, 10)

    def rim(self, pitch: float, wide: float, tall: float, scale: float, power: float, radius: float) -> Mesh:
        """A bead around such a patch in the middle of the front."""
        x, y = _outline(np.linspace(0, 2 * np.pi, 64, endpoint=False), power)
        return hoop(self.project(wide * x, pitch + tall * y, scale), radius, 8)


def _outline(angle: Array, power: float) -> tuple[Array, Array]:
    """A superellipse of half axes 1."""
    cos, sin = np.cos(angle), np.sin(angle)
    size = (np.abs(cos) ** power + np.abs(sin) ** power) ** (-1 / power)
    return cos * size, sin * size


def hand(curl: float = 0.6) -> Mesh:
    """A soft three-fingered hand at the origin that points along -Y, palm towards +Z; ``curl`` bends its fingers."""
    parts = [ball(0.048, 20, 14).scale(1.0, 1.1, 0.8)]
    for x, spread in ((-0.026, -12), (0.0, 0), (0.026, 12)):
        bend = np.array(
            [[0, 0, 0], [0, -0.035, 0.004 + 0.01 * curl], [0, -0.058, 0.030 * curl], [0, -0.062, 0.060 * curl]]
        )
        parts.append(tube(bend, [0.017, 0.017, 0.016, 0.014], 10).rotate(z=spread).at(x, -0.035, 0.004))
    thumb = np.array([[0, 0, 0], [0.02, -0.02, 0.02], [0.022, -0.035, 0.045]])
    parts.append(tube(thumb, [0.017, 0.016, 0.014], 10).at(0.035, -0.005, 0.01))
    return merge(parts)
