"""The glow of the street's small lights in its wet stones, as an emissive picture that lies on the roadway.

A rasterised surface sees UsdLux lights and the dome, not the lanterns, windows and neon that are mere glowing geometry. So
their highlights are worked out here, stone by stone, for the camera in the middle of the shot, which only pushes in a
little: the GGX lobe (Walter et al. 2007) of each over the setts' own height field.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from render.demo.looks import AMBER, ROSE, TEAL, TUNGSTEN, Colour
from render.demo.places import LANTERNS, NEON_PLACE, TRAM_PLACE
from render.demo.shapes.mesh import Array
from render.demo.shapes.noise import Plane
from render.demo.textures import SETTS_TILE_M, setts_height, write_image

EYE_M = np.array([0.0, 1.14, 0.15])
LEFT_M, RIGHT_M, NEAR_Z_M, FAR_Z_M = -2.7, 2.7, -3.0, -23.0
SIZE_PX = (416, 1024)  # across the street, along it
FULL_SCALE = 2.0  # radiance of a white texel
ALPHA = 0.085  # GGX roughness of wet granite, squared already
WATER_F0 = 0.035


@dataclass(frozen=True)
class Glow:
    """Small light: position (metres), colour, and radiance times its visible area (m²)."""

    place_m: Array
    colour: Colour
    power: float


def _glows() -> list[Glow]:
    """The lights that leave a streak of their own; the many bulbs together leave an even gleam, which the dome gives."""
    glows = [Glow(np.array(place) - [0, 0.3, 0], AMBER, 3.6) for place in LANTERNS]
    # Shop windows, as a row of soft spots on either side; the neon in its two colours; the tram's lamps.
    glows += [Glow(np.array([side * 3.9, 1.5, z]), AMBER, 3.6) for side in (-1, 1) for z in np.arange(-8.0, -22, -3.2)]
    neon = np.array(NEON_PLACE)
    glows += [Glow(neon, ROSE, 34.0), Glow(neon + np.array([0, 0.36, 0]), TEAL, 16.0)]
    tram = np.array(TRAM_PLACE)
    return [*glows, *(Glow(tram + np.array([x, 0.98, 0.2]), TUNGSTEN, 0.8) for x in (-0.62, 0.62))]


def _stones() -> tuple[Array, Array]:
    """Positions and unit normals of the roadway, ``(along, across, 3)`` float32, row 0 farthest away."""
    across, along = SIZE_PX
    x = LEFT_M + (np.arange(across) + 0.5) / across * (RIGHT_M - LEFT_M)
    z = FAR_Z_M + (np.arange(along) + 0.5) / along * (NEAR_Z_M - FAR_Z_M)
    height, _ = setts_height(256)
    texel_m = SETTS_TILE_M / 256
    slope_x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) / (2 * texel_m)
    slope_z = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) / (2 * texel_m)
    # The tile's rows run up the picture, which is away from the camera: towards -Z.
    column = (x / texel_m).astype(int) % 256
    row = (255 - (-z / texel_m).astype(int)) % 256
    slopes = [0.55 * slope[np.ix_(row, column)] for slope in (slope_x, slope_z)]
    normals = np.stack([-slopes[0], np.ones_like(slopes[0]), -slopes[1]], axis=-1)
    positions = np.stack(np.broadcast_arrays(x[None, :], 0.0, z[:, None]), axis=-1)
    return positions.astype(np.float32), (normals / np.linalg.norm(normals, axis=-1, keepdims=True)).astype(np.float32)


def _highlight(glow: Glow, positions: Array, normals: Array, to_eye: Array, normal_eye: Array) -> Array:
    """``(along, across)`` radiance, for white light, that one small light sends off the stones to the eye."""
    offset = glow.place_m.astype(np.float32) - positions
    squared = np.einsum("...i,...i", offset, offset)
    to_light = offset / np.sqrt(squared)[..., None]
    half = to_light + to_eye
    length = np.sqrt(np.einsum("...i,...i", half, half))
    normal_half = np.einsum("...i,...i", normals, half) / length
    eye_half = np.einsum("...i,...i", to_eye, half) / length
    normal_light = np.maximum(np.einsum("...i,...i", normals, to_light), 0)
    distribution = ALPHA**2 / (np.pi * (normal_half**2 * (ALPHA**2 - 1) + 1) ** 2)
    fresnel = WATER_F0 + (1 - WATER_F0) * (1 - eye_half) ** 5
    # Smith's masking in Hammon's (2017) approximation.
    masking = 0.5 / np.maximum(2 * normal_light * normal_eye * (1 - ALPHA) + ALPHA * (normal_light + normal_eye), 1e-3)
    highlight: Array = glow.power / squared * distribution * fresnel * masking * normal_light
    return highlight


def glint_picture() -> Plane:
    """``(1024, 416, 3)`` float32 scene-linear Rec.709 radiance over the roadway, farthest row at the top."""
    positions, normals = _stones()
    offset = EYE_M.astype(np.float32) - positions
    to_eye = offset / np.linalg.norm(offset, axis=-1, keepdims=True)
    normal_eye = np.maximum(np.einsum("...i,...i", normals, to_eye), 1e-3)
    picture = np.zeros((*positions.shape[:2], 3), np.float32)
    for glow in _glows():
        picture += _highlight(glow, positions, normals, to_eye, normal_eye)[..., None] * np.array(
            glow.colour, np.float32
        )
    return picture


def write_glints(path: Path) -> None:
    """Writes the picture, sRGB-encoded, with `FULL_SCALE` as white.

    Raises:
        OutputError: if it cannot be written.
    """
    linear = np.clip(glint_picture() / FULL_SCALE, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1 / 2.4) - 0.055)
    write_image(path, encoded.astype(np.float32))
