"""Light on layers: quads of alike pixels are lit at once, and the picture is that of pixels lit one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle, sphere
from render.layers.surface_sampling import PLAIN, layer_sampling
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Light, Material, Scene
from render.optics.view import PinholeView

CAMERA = Camera(np.eye(4), 36, 36, 36, f_stop=2.8, focus_distance_m=4.0, near_m=0.1)
VIEW = PinholeView.from_camera(CAMERA, 323, 237)
ABOVE = np.array([[1.0, 0, 0, 1], [0, 0, 1, 3], [0, -1, 0, -3], [0, 0, 0, 1]])
LIGHTS = (
    Light("rect", (9.0, 8.0, 7.0), ABOVE, width_m=1, height_m=1, casts_shadow=True),
    Light("distant", (0.5, 0.6, 1.0), np.eye(4)),
)


def scene(roughness: float = 0.4, **material: float) -> Scene:
    """A floor before a wall, and balls on it, of one material."""
    plain = Material(name="plain", base_color=(0.6, 0.5, 0.4), roughness=roughness, **material)  # type: ignore[arg-type]
    floor = Batch(rectangle((0, -0.8, -4), (9, 0, 0), (0, 0, -9)), plain, np.eye(4)[None], double_sided=True)
    wall = Batch(rectangle((0, 0, -6), (9, 0, 0), (0, 9, 0)), plain, np.eye(4)[None])
    balls = [Batch(sphere((x, -0.4, -4.0), 0.4, 24), plain, np.eye(4)[None]) for x in (-1.0, 0.0, 1.0)]
    return Scene((floor, wall, *balls), LIGHTS, Dome((0.1, 0.12, 0.15), np.eye(4)), tuple("/abcde"))


def radiance(renderer: FrameRenderer, shown: Scene, *, by_quads: bool) -> FloatArray:
    """Radiance of the first layer ``(height, width, 3)``, 0 where it is empty."""
    settings = FrameSettings(VIEW.width, VIEW.height)
    with renderer.on_device():
        renderer.load(shown, CAMERA, settings)
        peeler = renderer.device.peeler
        layers = peeler.peel(VIEW, layers=1, umbra=1e9, sampling=replace(PLAIN, by_quads=by_quads))
        held = np.frombuffer(layers.targets.radiance.read(), np.float16).reshape(-1, VIEW.height, VIEW.width, 4)
        w = np.frombuffer(layers.targets.packed_w[0].read(), np.float32).reshape(VIEW.height, VIEW.width, 4)
    return np.where(w[..., :1] != 0, held[0, ..., :3].astype(np.float32), 0.0).astype(np.float32)


@pytest.mark.parametrize(
    "shown",
    [scene(), scene(0.5, clearcoat=1.0, clearcoat_roughness=0.1), scene(0.3, metallic=1.0)],
    ids=["plain", "coated", "metal"],
)
def test_quads_give_the_picture_of_single_pixels(renderer: FrameRenderer, shown: Scene) -> None:
    """Within 46 dB once 4x4 are averaged, with an odd last row and column; some quads share their light, and some do not."""
    single, quads = (radiance(renderer, shown, by_quads=by_quads) for by_quads in (False, True))
    assert psnr_db(_averaged(single), _averaged(quads)) > 46
    same = (single == quads).all(axis=-1)
    assert 0.02 < same[single.max(axis=-1) > 0].mean() < 0.9
    assert (quads[-1].max(axis=-1) > 0).all()
    np.testing.assert_allclose(quads.mean(axis=(0, 1)), single.mean(axis=(0, 1)), rtol=2e-3)


def test_highlights_of_few_pixels_are_lit_pixel_by_pixel(renderer: FrameRenderer) -> None:
    shown = scene(0.15)
    np.testing.assert_array_equal(*(radiance(renderer, shown, by_quads=by_quads) for by_quads in (False, True)))


def test_only_layers_finer_than_the_picture_share_their_light() -> None:
    shares = {scale: layer_sampling(_scaled(scale), VIEW, (0.25, 0, 0), 0.01, 64).by_quads for scale in (1, 2, 3, 4)}
    assert shares == {1: False, 2: False, 3: True, 4: True}


def _averaged(values: FloatArray) -> FloatArray:
    height, width = (side // 4 for side in values.shape[:2])
    return values[: 4 * height, : 4 * width].reshape(height, 4, width, 4, -1).mean(axis=(1, 3))


def _scaled(scale: float) -> PinholeView:
    return VIEW.resize(int(VIEW.width * scale), int(VIEW.height * scale))
