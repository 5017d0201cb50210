"""Focus drawn over the frame: half lenses (split diopters), and curvature of field (Lee, Eisemann & Seidel 2010, section 5.3).

This makes the data of `render.model.focal_surface`; `render.focus.surface` evaluates it, and the tracer does so for each pixel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.errors import SettingsError
from render.focus.surface import focused_at
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.focal_surface import Controls, FocalSurface, HalfLens


@dataclass(frozen=True)
class Frame:
    """The film gate on the screen, in slopes.

    Attributes:
        middle: middle of the gate, x right and y up; not (0, 0) for a shifted one.
        width: width of the gate.
        height: height of the gate.
    """

    middle: tuple[float, float]
    width: float
    height: float

    @classmethod
    def from_camera(cls, camera: Camera, stretch: float = 1.0) -> Frame:
        """Gate of a camera.

        Args:
            camera: camera whose gate and focal length are used.
            stretch: image distance over focal length, for a breathing lens.
        """
        distance_mm = camera.focal_length_mm * stretch
        return cls(
            (camera.horizontal_offset_mm / distance_mm, camera.vertical_offset_mm / distance_mm),
            camera.horizontal_aperture_mm / distance_mm,
            camera.vertical_aperture_mm / distance_mm,
        )

    def slopes(self, places: DoubleArray) -> DoubleArray:
        """``(..., 2)`` slopes of places ``(..., 2)`` that run from (0, 0) top left to (1, 1) bottom right."""
        across, down = places[..., 0] - 0.5, places[..., 1] - 0.5
        return np.stack([self.middle[0] + across * self.width, self.middle[1] - down * self.height], axis=-1)


def bends(
    places: DoubleArray,
    offsets_mm: DoubleArray,
    *,
    surface: FocalSurface,
    focal_length_mm: float,
    exponent: float = 3.0,
) -> Controls | None:
    """Curvature of field drawn by hand: the film is moved toward the lens by some length at some places (section 5.3).

    A thin lens with its film at the distance ``v`` behind it is focused on ``w = 1/f − 1/v``; film that is ``δ`` nearer is
    focused on ``1/f − 1/(v − δ)``, which is farther away.

    Args:
        places: ``(k, 2)`` slopes (`Frame.slopes`).
        offsets_mm: ``(k,)`` toward the lens; negative is away from it.
        surface: focal surface without the offsets.
        focal_length_mm: focal length of the lens.
        exponent: locality of the offsets.

    Returns:
        Values are changes of w in 1/m; None for no place.

    Raises:
        SettingsError: an offset is not finite, or moves the film to the lens or behind it; or there are too many.
    """
    if len(places) == 0:
        return None
    w, _ = focused_at(surface, places)
    inverse_f = 1000 / focal_length_mm
    distance_m = 1 / (inverse_f - np.minimum(w, inverse_f * (1 - 1e-9)))
    moved_m = distance_m - offsets_mm / 1000
    if not (np.isfinite(offsets_mm).all() and (moved_m > 0).all()):
        worst = offsets_mm[np.argmin(np.where(np.isfinite(moved_m), moved_m, -np.inf))]
        raise SettingsError(
            f"an offset of the image plane must be finite and leave it behind the lens of {focal_length_mm:g} mm,"
            f" but one is {worst:g} mm",
            code="bad_field_offset",
        )
    changes = 1 / distance_m - 1 / moved_m
    every = np.ones(len(places))
    return Controls(places, changes[:, None], every, 0 * every, exponent)


def half_lenses(lenses: Sequence[tuple[float, float, float]], angle_rad: float, frame: Frame) -> tuple[HalfLens, ...]:
    """Half lenses (split diopters) in front of the lens, from Hydra's attributes (``splitDiopter:*``).

    With no turn the edge is upright and the half lens covers what is right of it. Offsets and widths are screen coordinates: 1 is
    half the frame's width, in every direction, so that the edge can turn. Where two half lenses cover the same place the second
    wins.

    Args:
        lenses: for each its edge's offset from the middle of the frame along its direction, the width of the zone in which it
            fades in, and the distance in m that is sharp through it; 0 or infinite is infinity.
        angle_rad: turn of both about the view axis, counter-clockwise in the picture.
        frame: the gate.

    Raises:
        SettingsError: a number is out of range.
    """
    direction = (math.cos(angle_rad), math.sin(angle_rad))
    middle = frame.middle[0] * direction[0] + frame.middle[1] * direction[1]
    half_width = frame.width / 2
    made = []
    for offset, width, distance_m in lenses:
        if not (math.isfinite(angle_rad + offset) and 0 <= width < math.inf and distance_m >= 0):
            raise SettingsError(
                "a half lens needs a finite angle and offset, a width of 0 or more and a focus distance of 0 or more, got"
                f" {math.degrees(angle_rad):g}°, {offset:g}, {width:g} and {distance_m:g} m",
                code="bad_split_diopter",
            )
        w = 0.0 if distance_m == 0 else 1 / distance_m
        made.append(HalfLens(direction, middle + offset * half_width, width * half_width, w))
    return tuple(made)
