"""Glints narrower than a texel, out of focus: as bright as those of layers twice as fine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.layers.glints import GlintSampler
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Light, Material, Scene

CAMERA = Camera(np.eye(4), 100, 36, 24, f_stop=1.4, focus_distance_m=4.0, near_m=0.1)
SETTINGS = FrameSettings(60, 40, rays=256, tiled=False)
CHROME = Material(name="chrome", base_color=(0.9, 0.9, 0.9), metallic=1.0, roughness=0.1)
MATT = Material(name="matt", base_color=(0.2, 0.2, 0.2), roughness=1.0, specular=(0.0, 0.0, 0.0))
BLACK = Dome((0, 0, 0), np.eye(4), visible=False)
WALL = Batch(rectangle((0, 0, -4), (9, 0, 0), (0, 9, 0)), MATT, np.eye(4)[None])


def beads(material: Material) -> Scene:
    """Rows of beads of nine texels at 1.5 m, before a wall in focus, under a lamp above the camera."""
    places = [(x, y) for x in np.linspace(-0.24, 0.24, 9) for y in np.linspace(-0.15, 0.15, 6)]
    poses = np.stack([np.eye(4)] * len(places))
    poses[:, :2, 3], poses[:, 2, 3] = places, -1.5
    lamp = np.eye(4)
    lamp[1, 3] = 1.0
    light = Light("sphere", (4e4,) * 3, lamp, radius_m=0.05)
    return Scene((Batch(sphere((0, 0, 0), 0.02), material, poses), WALL), (light,), BLACK, ("/beads", "/wall"))


def radiance(renderer: FrameRenderer, scene: Scene, **changes: object) -> DoubleArray:
    settings = replace(SETTINGS, **changes)  # type: ignore[arg-type]
    return renderer.render(scene, CAMERA, settings).color[..., :3].astype(np.float64)


def test_glints_are_those_of_finer_layers(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = beads(CHROME)
    fine = radiance(renderer, scene, supersample=4.0)
    sampled = radiance(renderer, scene)
    monkeypatch.setattr(GlintSampler, "mark", lambda *_: None)
    renderer.forget_layers()
    once = radiance(renderer, scene)
    errors = [np.sqrt(np.mean((colour - fine) ** 2)) for colour in (sampled, once)]
    assert errors[0] < 0.6 * errors[1]
    assert sampled.mean() == pytest.approx(fine.mean(), rel=0.01)


def test_what_is_even_takes_no_more_samples(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[object] = []
    monkeypatch.setattr(GlintSampler, "mask", lambda *call: drawn.append(call))
    near = Batch(rectangle((0, 0, -1.5), (9, 0, 0), (0, 9, 0)), MATT, np.eye(4)[None])
    radiance(renderer, Scene((near,), beads(MATT).lights, BLACK, ("/wall",)))
    assert not drawn
    radiance(renderer, beads(CHROME))
    assert drawn


def test_glints_are_sampled_where_nothing_is_in_focus(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[object] = []
    average = GlintSampler.average

    def count(*call: object) -> None:
        drawn.append(call)
        average(*call)  # type: ignore[arg-type]

    monkeypatch.setattr(GlintSampler, "average", count)
    camera = replace(CAMERA, focus_distance_m=0.6)
    renderer.render(beads(CHROME), camera, SETTINGS)
    assert len(drawn) == 1
