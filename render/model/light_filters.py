"""Filters between lights and what they shine on, in physical terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from render.model.arrays import DoubleArray, FloatArray

MAX_FILTERS = 16
"""Filters of all lights of a scene together, counted once for each light."""
RAMP_STEPS = 24
"""Places at which a ramp's colours are known, from its begin to its end."""
PreBarn = Literal["all", "cone", "none"]
RampMode = Literal["distance", "linear", "spherical", "radial"]


@dataclass(frozen=True)
class Window:
    """Rectangle with round corners in a filter's plane z = 0, in the filter's own units.

    Attributes:
        sides: distances of its sides from the middle, along -X, +X, -Y and +Y.
        radii: of its corners, along X and Y; they lie within the sides.
        edges: widths of the zones outside of its sides over which light fades.
    """

    sides: tuple[float, float, float, float]
    radii: tuple[float, float] = (0.0, 0.0)
    edges: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Barn:
    """Barn doors: an opening in a dark plane.

    Attributes:
        window: the opening.
        before: light on the near side of the plane: all of it, that of the cone through the opening, or none.
        source: where light comes from, ``(x, y, z, w)`` in the filter's units: a point (w = 1), or a direction towards it
            (w = 0). None for the light's own place and size, from which there are penumbrae in place of the window's edges.
    """

    window: Window
    before: PreBarn = "all"
    source: tuple[float, float, float, float] | None = None


@dataclass(frozen=True, eq=False)
class Ramp:
    """Multiplier by distance.

    Attributes:
        mode: distance from the light; along -Z of the filter; from its origin; or from its Z axis.
        begin: distance at which the ramp begins, in the filter's units (from the light: in metres).
        end: distance at which it ends.
        colors: ``(RAMP_STEPS, 3)`` multipliers, evenly from begin to end; the first and the last hold beyond.
    """

    mode: RampMode
    begin: float
    end: float
    colors: FloatArray


@dataclass(frozen=True, eq=False)
class LightFilter:
    """A filter of a light.

    Attributes:
        shape: share of the light that passes, by place.
        pose: ``(4, 4)`` world (metres) from the filter's own units; the light goes along its -Z.
        density: share of the effect, 0 for none.
        strength: multiplier of what passes.
        inverted: whether what passes is what was held back.
        diffuse: share of the effect on diffuse light.
        specular: share of the effect on highlights.
    """

    shape: Barn | Ramp
    pose: DoubleArray
    density: float = 1.0
    strength: float = 1.0
    inverted: bool = False
    diffuse: float = 1.0
    specular: float = 1.0
