"""The importance bench's scenes: a still life as an image with depth, and a star that moves in it (after Fearing 1995, section
6.1).

He traced his background offline, and put a star among it frame by frame. Here both are made: a knot in front, a computer and a
cabinet behind it, a floor and a wall, seen through a lens of his 8 mm. He tells neither how wide the film is nor how large the
star: the bench measures his first two experiments over both. Elsewhere the film is 7 mm wide: F/1000, the finest blur that he
would have seen, is then about a pixel of 1024 in diameter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray

_Bools = NDArray[np.bool_]
_Numbers = DoubleArray | list[float]

FOCAL_MM, FILM_MM = 8.0, 7.0
KNOT_MM, STAR_MM, COMPUTER_MM, CABINET_MM, WALL_MM = 24.0, 40.0, 60.0, 90.0, 140.0
STAR_RADIUS_MM = 3.5
_STAR_INNER = 0.382  # of its radius: corners between its points


@dataclass(frozen=True)
class Moved:
    """Position of the star and of the focus.

    Attributes:
        star: across, down and away from the lens, in mm.
        focus_mm: distance in focus.
    """

    star: tuple[float, float, float]
    focus_mm: float


@dataclass(frozen=True)
class Experiment:
    """One of Fearing's animations.

    Attributes:
        name: unique name.
        title: moving objects.
        f_number: of the lens.
        at: where everything is at a time from 0 to 1.
        goal: Fearing's speed-up.
    """

    name: str
    title: str
    f_number: float
    at: Callable[[float], Moved]
    goal: float | None = None


@dataclass(frozen=True, eq=False)
class Picture:
    """A frame before it is blurred.

    Attributes:
        light: ``(n, n, 4)``; alpha is 1.
        radii: ``(n, n)`` of circles of confusion in pixels, in front of the focus above 0, behind it below.
    """

    light: FloatArray
    radii: FloatArray


def _sideways(t: float) -> Moved:
    return Moved((-10 + 20 * t, -2, STAR_MM), STAR_MM)


def _away(t: float) -> Moved:
    return Moved((1 - 15 * t, -1 - 18 * t, KNOT_MM + (WALL_MM - 5 - KNOT_MM) * t), KNOT_MM)


def _pull(t: float) -> Moved:
    return Moved((4, -2, STAR_MM), KNOT_MM + (COMPUTER_MM - KNOT_MM) * t)


def _all_three(t: float) -> Moved:
    z = KNOT_MM + (COMPUTER_MM - KNOT_MM) * t
    return Moved((-0.3 * z + 0.55 * z * t, -1, z), z)


EXPERIMENTS = (
    Experiment("sideways", "a star moves sideways, in focus", 3.5, _sideways, 22.1),
    Experiment("away", "a star moves away, out of focus", 17.0, _away, 13.4),
    Experiment("pull", "the focus is pulled over a still scene", 12.0, _pull, 2.4),
    Experiment("all", "a star moves sideways and away, in focus", 12.0, _all_three, 2.4),
)
SIZED_EXPERIMENTS = EXPERIMENTS[:2]
"""Experiments whose speed-up depends most on the size of the star and of the film."""
CUTOFF_EXPERIMENT = Experiment("cutoff", "the focus is pulled back", 12.0, lambda t: _pull(1 - t))
"""The third one turned round, of which only a share of the changes is made."""


class StillLife:
    """The scene at one size, and its frames.

    Args:
        size: pixels along each side.
        film_mm: width of the film; the still life fills it, whatever its width.
        star_radius_mm: distance of the star's points from its middle.
    """

    def __init__(self, size: int, film_mm: float = FILM_MM, star_radius_mm: float = STAR_RADIUS_MM) -> None:
        self.size, self._film_mm, self._star_radius_mm = size, film_mm, star_radius_mm
        line = (np.arange(size) + 0.5) / size * 2 - 1
        self._u, self._v = np.meshgrid(line, line)  # half film widths, v down
        self._light, self._depth = self._background()

    def frames(self, experiment: Experiment, count: int) -> Iterator[Picture]:
        """The pictures of an animation."""
        for number in range(count):
            yield self.frame(experiment, number / max(count - 1, 1))

    def frame(self, experiment: Experiment, t: float) -> Picture:
        """A picture of an animation at a time from 0 to 1."""
        moved = experiment.at(t)
        light, depth = self._light.copy(), self._depth
        inside, shade = self._star(*moved.star)
        seen = inside & (moved.star[2] < depth)
        light[seen, :3] = (shade[..., None] * [1.0, 0.75, 0.12])[seen]
        depth = np.where(seen, moved.star[2], depth)
        radii = self._radii(depth, moved.focus_mm, experiment.f_number)
        return Picture(light, radii.astype(np.float32))

    def _radii(self, depth: DoubleArray, focus_mm: float, f_number: float) -> DoubleArray:
        """Half of Fearing's C (equations 1 to 3), in pixels; in front of the focus above 0."""
        image, film = (FOCAL_MM * z / (z - FOCAL_MM) for z in (depth, np.float64(focus_mm)))
        diameter = (image - film) * FOCAL_MM / (f_number * image)
        return np.asarray(0.5 * diameter * self.size / self._film_mm)

    def _star(self, x: float, y: float, z: float) -> tuple[_Bools, DoubleArray]:
        """Position and brightness of a five-pointed star."""
        scale = 2 * FOCAL_MM / self._film_mm / z
        radius = self._star_radius_mm * scale
        du, dv = (self._u - x * scale) / radius, (self._v - y * scale) / radius
        sector = np.mod(np.arctan2(du, -dv) + np.pi / 5, 2 * np.pi / 5) - np.pi / 5
        distance = np.hypot(du, dv)
        along, across = distance * np.cos(sector), np.abs(distance * np.sin(sector))
        inner = _STAR_INNER * np.array([np.cos(np.pi / 5), np.sin(np.pi / 5)])
        return along + across * (1 - inner[0]) / inner[1] <= 1.0, 0.75 + 0.25 * along

    def _background(self) -> tuple[FloatArray, DoubleArray]:
        """The still life: light ``(n, n, 4)`` and depth ``(n, n)`` in mm."""
        u, v = self._u, self._v
        light, depth = np.ones((*u.shape, 4), np.float32), np.full(u.shape, WALL_MM)
        bricks = ((v * 9) % 1 < 0.12) | ((u * 5 + 0.5 * (np.floor(v * 9) % 2)) % 1 < 0.06)
        light[..., :3] = np.where(bricks, 0.16, 0.42)[..., None] * [1.0, 0.72, 0.58]
        below = v > 0.35
        floor = 14.0 / np.maximum(v, 0.1)
        tiles = (np.floor(u * floor * 0.2) + np.floor(floor * 0.12)) % 2
        self._put(light, depth, below, np.clip(floor, 14, WALL_MM), (0.15 + 0.5 * tiles)[..., None] * [0.8, 0.9, 1.0])
        shelf = (np.abs(u - 0.42) < 0.3) & (v < 0.38) & (v > -0.75)
        drawers = 0.12 + 0.75 * ((v * 4.2) % 1 > 0.14)
        self._put(light, depth, shelf, CABINET_MM, drawers[..., None] * [0.75, 0.82, 0.78])
        box = (np.abs(u + 0.3) < 0.27) & (np.abs(v - 0.08) < 0.25)
        screen = (np.abs(u + 0.3) < 0.21) & (np.abs(v - 0.05) < 0.16)
        lines = np.where((v * 40) % 1 < 0.4, 0.9, 0.08)
        colour = np.where(screen[..., None], lines[..., None] * [0.25, 1.0, 0.45], [0.55, 0.53, 0.48])
        self._put(light, depth, box, COMPUTER_MM, colour)
        self._knot(light, depth)
        post = np.abs(u - 0.86) < 0.07
        self._put(
            light, depth, post, 17.0, np.where((v * 6 - u * 3) % 1 < 0.5, 0.85, 0.06)[..., None] * [1.0, 0.2, 0.15]
        )
        return light, depth

    def _knot(self, light: FloatArray, depth: DoubleArray) -> None:
        """A trefoil of rope, a little nearer than `KNOT_MM` where it crosses over itself."""
        for angle in np.linspace(0, 2 * np.pi, 700, endpoint=False):
            x = 0.14 * (np.sin(angle) + 2 * np.sin(2 * angle)) * 0.55 - 0.62
            y = 0.14 * (np.cos(angle) - 2 * np.cos(2 * angle)) * 0.55 + 0.52
            z = KNOT_MM + 1.6 * np.sin(3 * angle)
            columns, rows = (np.abs(line - at) < 0.05 for line, at in ((self._u[0], x), (self._v[:, 0], y)))
            if not columns.any() or not rows.any():
                continue
            window = np.ix_(rows, columns)
            squared = ((self._u[window] - x) ** 2 + (self._v[window] - y) ** 2) / 0.05**2
            bulge = z - 1.5 * np.sqrt(np.maximum(1 - squared, 0))
            nearer = (squared < 1) & (bulge < depth[window])
            twist = 0.55 + 0.45 * np.sin(60 * angle + 200 * (self._u[window] - x))
            depth[window] = np.where(nearer, bulge, depth[window])
            shaded = twist[..., None] * np.sqrt(np.maximum(1 - 0.8 * squared, 0))[..., None] * [0.95, 0.8, 0.5]
            light[*window, :3] = np.where(nearer[..., None], shaded, light[*window, :3])

    @staticmethod
    def _put(light: FloatArray, depth: DoubleArray, where: _Bools, z: float | DoubleArray, colour: _Numbers) -> None:
        """Draw an object in front of farther ones."""
        nearer = where & (z < depth)
        light[..., :3] = np.where(nearer[..., None], colour, light[..., :3])
        depth[:] = np.where(nearer, z, depth)
