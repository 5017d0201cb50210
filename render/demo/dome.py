"""Picture of the dome: the street's surroundings as light, from the middle of the shot.

It is painted from the same lists as the set (bulbs, lamp posts, house fronts), so that wet stones and enamel mirror what
the picture shows, although a rasterised surface sees nothing but its lights and the dome.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO

from render.demo.bulbs import strings
from render.demo.places import LAMP_POSTS, LANTERNS, TRAM_PLACE
from render.demo.shapes.mesh import Array
from render.demo.shapes.noise import Plane
from render.errors import OutputError

VIEWPOINT_M = np.array([0.2, 0.5, -4.5])
HEIGHT_PX = 256


def _directions() -> Array:
    """``(h, 2h, 3)`` unit directions of a latitude-longitude picture: +Z in the centre, +X left of it, row 0 up."""
    theta = (np.arange(HEIGHT_PX) + 0.5) / HEIGHT_PX * np.pi
    phi = (0.5 - (np.arange(2 * HEIGHT_PX) + 0.5) / (2 * HEIGHT_PX)) * 2 * np.pi
    sin = np.sin(theta)[:, None]
    up = np.broadcast_to(np.cos(theta)[:, None], (HEIGHT_PX, 2 * HEIGHT_PX))
    return np.stack([sin * np.sin(phi), up, sin * np.cos(phi)], axis=-1)


def _walls(directions: Array) -> Array:
    """House fronts as a warm band along both sides that fades into blue night above."""
    up = directions[..., 1:2]
    sideways = np.abs(directions[..., :1])
    night = np.array([0.020, 0.036, 0.090]) * (0.5 + 0.5 * np.clip(up, 0, 1))
    wall = np.exp(-(((up - 0.12) / 0.22) ** 2)) * (0.25 + 0.75 * sideways)
    # Lit windows: a coarse checker of bearings, only on the walls.
    bearing = np.arctan2(directions[..., 0], directions[..., 2])[..., None]
    lit = (np.sin(bearing * 23) > 0.25) * (np.sin(up * 34) > -0.1) * np.exp(-(((up - 0.2) / 0.22) ** 2)) * sideways
    ground = np.array([0.010, 0.010, 0.013]) * (up < 0)
    warm = (wall * 0.018 + lit * 0.10) * np.array([1.0, 0.58, 0.26]) * (up > -0.05)
    light: Array = night * (up >= 0) + ground + warm
    return light


def night_dome() -> Plane:
    """``(256, 512, 3)`` float32 scene-linear Rec.709 radiance."""
    directions = _directions()
    picture = _walls(directions)
    lamps = [(np.array([x, 3.1, z]), 0.15, 12.0) for x, z in LAMP_POSTS]
    lamps += [(np.array(place) - [0, 0.3, 0], 0.15, 4.0) for place in LANTERNS]
    lamps += [(place, 0.036, 16.0) for string in strings() for place in string.bulbs()]
    lamps += [(np.array(TRAM_PLACE) + np.array([0, 1.4, 0]), 0.9, 0.8)]
    for place, radius_m, radiance in lamps:
        offset = place - VIEWPOINT_M
        distance = float(np.linalg.norm(offset))
        # A Gaussian blob of the lamp's own solid angle and radiance, no narrower than a pixel and a half.
        width = 1.5 * np.pi / HEIGHT_PX
        solid_angle = np.pi * (radius_m / distance) ** 2
        peak = radiance * solid_angle / (2 * np.pi * width**2)
        cosine = directions @ (offset / distance)
        picture += (peak * np.exp((cosine - 1) / width**2))[..., None] * np.array([1.0, 0.68, 0.38])
    return picture.astype(np.float32)


def write_dome(path: Path) -> None:
    """Writes the dome's picture as half-float OpenEXR.

    Raises:
        OutputError: if it cannot be written.
    """
    picture = night_dome()
    height, width, channels = picture.shape
    spec = OpenImageIO.ImageSpec(width, height, channels, "half")
    spec.attribute("compression", "zip")
    spec.attribute("DateTime", "2000:01:01 00:00:00")  # else the time of writing would get into the file
    output = OpenImageIO.ImageOutput.create(str(path))
    if output is None or not output.open(str(path), spec) or not output.write_image(picture):
        raise OutputError(f"{path} could not be written: {OpenImageIO.geterror()}", path=str(path))
    output.close()
