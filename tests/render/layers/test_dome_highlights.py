"""Highlights of a dome's image against the integral over the lobe of GGX."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer
from render.model.arrays import DoubleArray
from render.model.scene import Dome, Image, Material
from tests.render.kits.lit_walls import WALL, centre_radiance, lit

pytestmark = pytest.mark.gl
HEIGHT = 128


def patches(seed: int) -> Image:
    """A sky of soft patches, and a lamp that is 20 times as bright."""
    coarse = np.random.default_rng(seed).uniform(0.1, 1.0, (16, 32, 4))
    pixels = coarse.repeat(HEIGHT // 16, 0).repeat(HEIGHT // 16, 1)
    pixels[56:64, 116:126, :3] = [20.0, 16.0, 8.0]
    return Image(pixels.astype(np.float16))


def seen_by_lobe(image: Image, mirror: DoubleArray, roughness: float) -> DoubleArray:
    """Mean radiance ``(3,)`` over the lobe of a mirror that is seen head-on, by the sum over all pixels' corners and middles."""
    fine = image.pixels[..., :3].astype(np.float64).repeat(4, 0).repeat(4, 1)
    rows, columns = fine.shape[:2]
    polar = (np.arange(rows)[:, None] + 0.5) / rows * np.pi
    longitude = (0.5 - (np.arange(columns) + 0.5) / columns) * 2 * np.pi
    level = np.sin(polar)
    towards = np.stack([level * np.sin(longitude), np.cos(polar) + 0 * longitude, level * np.cos(longitude)], -1)
    cosine = towards @ mirror
    half2 = np.clip((1 + cosine) / 2, 0, 1)  # cos² of the half vector's angle
    alpha2 = roughness**4
    weight = np.where(cosine > 0, cosine / (half2 * (alpha2 - 1) + 1) ** 2, 0.0) * level
    return np.asarray((fine * weight[..., None]).sum((0, 1)) / weight.sum())


@pytest.mark.parametrize("roughness", [0.15, 0.21, 0.3, 0.5, 0.85, 1.0])
def test_a_rough_mirror_sees_the_mean_over_its_lobe(roughness: float, renderer: FrameRenderer) -> None:
    """A plate that faces the eye, under a dome that is turned so that various parts of it are mirrored."""
    image, plate = patches(3), replace(WALL, material=Material(base_color=(1,) * 3, metallic=1.0, roughness=roughness))
    plain = centre_radiance(renderer, lit(batches=(plate,), dome=Dome((1.0,) * 3, np.eye(4), visible=False)))
    for turn in (0.4, 2.5):
        pose = np.eye(4)
        pose[:3, 0], pose[:3, 2] = [np.cos(turn), 0, -np.sin(turn)], [np.sin(turn), 0, np.cos(turn)]
        dome = Dome((1.0,) * 3, pose, image, visible=False)
        seen = centre_radiance(renderer, lit(batches=(plate,), dome=dome)) / plain
        expected = seen_by_lobe(image, np.array([-np.sin(turn), 0, np.cos(turn)]), roughness)
        np.testing.assert_allclose(seen, expected, rtol=0.05)
