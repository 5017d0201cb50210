"""`keeps_layers` foretells whether the next picture draws layers, for thin lenses, glass, tiles and edits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.layers.renderer import LayerRenderer
from render.model.camera import Camera
from render.model.lens import Lens
from render.model.scene import Scene
from render.pictures.progressive.frames import LiveFrames
from render.trace.tiling.plan import LayerBudget
from tests.render.kits.bulbs import BULB, WALL, in_the_dark, plane
from tests.render.kits.lenses import PLANAR

SETTINGS = FrameSettings(96, 64, rays=8, supersample=2)
THIN = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=2.0, focus_distance_m=3.0, near_m=0.1)
GLASS = replace(THIN, lens=Lens("prescription", prescription=PLANAR.prescription))


@pytest.fixture
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as own:
        yield own


def wall(lamp_x: float = 0.0) -> Scene:
    lamp = plane(rectangle((lamp_x, 0.0, -5.0), (0.1, 0, 0), (0, 0.1, 0)), BULB)
    return in_the_dark(plane(rectangle((0.0, 0.0, -6.0), (6.0, 0, 0), (0, 6.0, 0)), WALL), lamp)


@pytest.mark.parametrize("camera", [THIN, GLASS], ids=["thin", "glass"])
@pytest.mark.parametrize(
    ("changed", "settings", "kept"),
    [
        ({}, {}, True),
        ({}, {"seed": 1}, True),
        ({}, {"shading": "unlit"}, False),
        ({}, {"width": 120}, False),
        ({"focus_distance_m": 0.4}, {}, False),
    ],
)
def test_layers_are_drawn_where_they_are_not_kept(
    renderer: FrameRenderer,
    monkeypatch: pytest.MonkeyPatch,
    camera: Camera,
    changed: dict[str, float],
    settings: dict[str, object],
    kept: bool,
) -> None:
    drawn = []
    plain = LayerRenderer.draw_layer
    monkeypatch.setattr(LayerRenderer, "draw_layer", lambda *given, **how: drawn.append(1) or plain(*given, **how))
    scene, frames = wall(), LiveFrames(renderer)
    assert not frames.keeps_layers(scene, camera, SETTINGS), "nothing is loaded"
    renderer.render(scene, camera, SETTINGS)
    drawn.clear()
    camera, again = replace(camera, **changed), replace(SETTINGS, **settings)  # type: ignore[arg-type]
    assert frames.keeps_layers(scene, camera, again) is kept
    renderer.render(scene, camera, again)
    assert (not drawn) is kept


def test_a_slight_pull_of_a_thin_lens_keeps_layers(renderer: FrameRenderer) -> None:
    scene, frames = wall(), LiveFrames(renderer)
    renderer.render(scene, THIN, SETTINGS)
    assert frames.keeps_layers(scene, replace(THIN, focus_distance_m=3.05), SETTINGS)


def test_layers_of_another_scene_are_not_kept(renderer: FrameRenderer) -> None:
    frames = LiveFrames(renderer)
    renderer.render(wall(), THIN, SETTINGS)
    assert not frames.keeps_layers(wall(lamp_x=0.3), THIN, SETTINGS)


def test_layers_in_tiles_are_not_kept(renderer: FrameRenderer) -> None:
    renderer.device.tracer.budget = LayerBudget(bytes=500_000, strip_bytes=1 << 40)
    scene, frames = wall(), LiveFrames(renderer)
    renderer.render(scene, THIN, SETTINGS)
    assert not frames.keeps_layers(scene, THIN, SETTINGS)
