"""Scenes and cameras for pictures through lenses, and the size of a spot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.frame import FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.data_sheet import DataSheet
from render.model.lens import Lens
from render.model.scene import Batch, Dome, Material, Scene
from tests.render.kits.lenses import KnownLens

WHITE = Scene((), (), Dome((1.0, 1.0, 1.0), np.eye(4)), ())


def camera_of(known: KnownLens, **changes: object) -> Camera:
    """Make a camera with a known lens by prescription, focused at 4 m on a gate of 32 by 24 mm."""
    lens = Lens("prescription", known.prescription.name, known.prescription)
    camera = Camera(np.eye(4), known.focal_length_mm, 32.0, 24.0, f_stop=known.f_stop, focus_distance_m=4.0, near_m=0.1)
    return replace(camera, lens=lens, **changes)  # type: ignore[arg-type]


def glowing_point(x: float, y: float, depth_m: float, half_m: float = 0.004) -> Scene:
    """Make a bright square at the slopes (x, y) from the axis, y up."""
    glow = Material(name="glow", base_color=(0, 0, 0), emissive=(3000.0, 3000.0, 3000.0))
    place = (x * depth_m, y * depth_m, -depth_m)
    square = rectangle(place, (half_m, 0, 0), (0, half_m, 0))
    return Scene((Batch(square, glow, np.eye(4)[None], double_sided=True),), (), Dome((0, 0, 0), np.eye(4)), ("/p",))


def spot_size(picture: FloatArray, channel: int = 1) -> tuple[float, float, float, float]:
    """Measure the light of a channel: its centre (x, y) and standard deviation (x, y), in pixels."""
    light = picture[..., channel].astype(np.float64)
    y, x = np.mgrid[: light.shape[0], : light.shape[1]] + 0.5
    cx, cy = (x * light).sum() / light.sum(), (y * light).sum() / light.sum()
    return (
        float(cx),
        float(cy),
        float(np.sqrt(((x - cx) ** 2 * light).sum() / light.sum())),
        float(np.sqrt(((y - cy) ** 2 * light).sum() / light.sum())),
    )


SOFT_SHEET = DataSheet(
    heights_mm=(0.0, 8.0, 16.0, 20.0),
    distortion=(0.0, -0.01, -0.04, -0.06),
    light=(1.0, 0.9, 0.55, 0.4),
    sagittal_blur_mm=(0.15, 0.15, 0.17, 0.18),
    tangential_blur_mm=(0.15, 0.18, 0.24, 0.27),
    spherical=(0.5, 0.3, 0.0, 0.0),
    coma_mm=(0.0, 0.1, 0.2, 0.25),
    lateral_color_mm=(0.0, 0.1, 0.3, 0.4),
    f_stop=2.8,
)

SHEET_SETTINGS = FrameSettings(320, 240, rays=256)


def sheet_camera(sheet: DataSheet, **changes: object) -> Camera:
    """Make a camera with a 50 mm lens by data sheet, focused at 4 m on a gate of 32 by 24 mm."""
    lens = Lens("dataSheet", data_sheet=sheet)
    camera = Camera(np.eye(4), 50.0, 32.0, 24.0, f_stop=2.8, focus_distance_m=4.0, near_m=0.1, lens=lens)
    return replace(camera, **changes)  # type: ignore[arg-type]
