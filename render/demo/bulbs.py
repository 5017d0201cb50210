"""String lights and neon: the many small bright things that become bokeh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.demo.shapes.kit import ball, lathe, smooth_curve, tube
from render.demo.shapes.mesh import Array, Mesh, merge

BULB_SPACING_M = 0.30
KINDS = ("BulbWarm", "BulbAmber", "BulbRose", "BulbTeal")
"""Materials of bulbs, in `render.demo.looks.TABLE`."""
PATTERN = (0, 0, 1, 0, 0, 2, 0, 1, 0, 0, 3, 0, 1)
"""Indices into `KINDS` along a string, repeated: mostly warm bulbs, here and there a coloured one."""


@dataclass(frozen=True)
class LightString:
    """A wire that hangs between two hooks.

    Attributes:
        start: hook in the world, metres.
        end: the other hook, metres.
        sag_m: distance of its middle below the straight line.
    """

    start: tuple[float, float, float]
    end: tuple[float, float, float]
    sag_m: float

    def curve(self, count: int) -> Array:
        """Sample ``(count, 3)`` points along the wire: a parabola, which equals the catenary to third order."""
        t = np.linspace(0, 1, count)[:, None]
        line = np.asarray(self.start) * (1 - t) + np.asarray(self.end) * t
        return line - np.array([0, self.sag_m, 0]) * 4 * t * (1 - t)

    def bulbs(self) -> Array:
        """Place bulbs ``(n, 3)`` along the wire, about `BULB_SPACING_M` apart, none at the hooks."""
        length = float(np.linalg.norm(np.diff(self.curve(64), axis=0), axis=1).sum())
        return self.curve(int(length / BULB_SPACING_M) + 1)[1:-1]


def strings() -> list[LightString]:
    """List all the strings of the shot, near to far: a zigzag over the street."""
    hooks = [
        (-4.0, -7.2),
        (4.0, -8.8),
        (-4.0, -10.6),
        (4.0, -12.4),
        (-4.0, -14.4),
        (4.0, -16.6),
        (-4.0, -19.0),
        (4.0, -21.8),
    ]
    heights = [3.35, 3.55, 3.5, 3.75, 3.8, 4.1, 4.2, 4.5]
    ends = [(x, y, z) for (x, z), y in zip(hooks, heights, strict=True)]
    sags = [0.80, 0.72, 0.85, 0.78, 0.9, 0.8, 0.9]
    return [LightString(a, b, sag) for a, b, sag in zip(ends[:-1], ends[1:], sags, strict=True)]


def wires() -> Mesh:
    """Build the wires of all strings."""
    return merge(tube(string.curve(40), 0.006, 5) for string in strings())


def bulb(glow: str) -> dict[str, Mesh]:
    """Build a bulb with its socket, hanging from the origin; ``glow`` is the material of its glass."""
    glass = lathe(
        smooth_curve([[0.0, -0.118], [0.026, -0.104], [0.036, -0.078], [0.020, -0.048], [0.014, -0.040]], 8), 10
    )
    socket = lathe([[0.017, -0.044], [0.019, -0.040], [0.017, -0.008], [0.0, 0.0]], 8)
    return {glow: glass, "Rubber": socket}


def neon_cup() -> dict[str, Mesh]:
    """Build a neon coffee cup on a bracket, 0.8 m across, facing +Z about the origin."""
    bowl = smooth_curve(
        [[-0.30, 0.12, 0], [-0.27, -0.12, 0], [-0.14, -0.27, 0], [0.14, -0.27, 0], [0.27, -0.12, 0], [0.30, 0.12, 0]],
        40,
    )
    rim = smooth_curve([[-0.30, 0.12, 0], [0, 0.15, 0], [0.30, 0.12, 0]], 16)
    handle = smooth_curve([[0.28, 0.05, 0], [0.42, 0.06, 0], [0.43, -0.10, 0], [0.27, -0.13, 0]], 20)
    saucer = smooth_curve([[-0.38, -0.33, 0], [0, -0.38, 0], [0.38, -0.33, 0]], 16)
    steam = [
        smooth_curve([[x, 0.22, 0], [x + 0.05, 0.30, 0], [x - 0.03, 0.39, 0], [x + 0.03, 0.48, 0]], 18)
        for x in (-0.13, 0.0, 0.13)
    ]
    board = lathe([[0.0, -0.03], [0.56, -0.03], [0.58, -0.015], [0.58, 0.015], [0.56, 0.03], [0.0, 0.03]], 40).rotate(
        x=90
    )
    bracket = tube([[-0.58, 0, -0.06], [-0.95, 0, -0.06]], 0.025, 8)
    return {
        "NeonRose": merge(tube(path, 0.017, 8) for path in (bowl, rim, handle, saucer)),
        "NeonTeal": merge(tube(path, 0.014, 8) for path in steam),
        "Iron": merge([board.at(0, 0, -0.07), bracket, ball(0.04, 12, 8).at(-0.95, 0, -0.06)]),
    }
