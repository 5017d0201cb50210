"""Mattes of Gaussian splats: coverage by each cloud against pictures in which each has a colour of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.mattes import id_of
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, Material, Scene
from render.model.splats import MOST_MATTE_CLOUDS, SplatBatch
from tests.render.kits.splats import BLACK, CAMERA, SIZE, plain_cloud

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(*SIZE, rays=16, supersample=2, shading="unlit", aovs=("cryptoObject",))
OPEN = replace(CAMERA, f_stop=0.5, focus_distance_m=3.0)
COLOURS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def scene(clouds: int, seed: int = 2) -> Scene:
    """Clouds of a colour each that reach through each other, and a blue wall behind half of them and in front of the rest."""
    random = np.random.default_rng(seed)
    wall = Batch(rectangle((-2.0, 0, -3), (2.0, 0, 0), (0, 4, 0)), Material(base_color=COLOURS[2]), np.eye(4)[None])
    batches = []
    for number in range(clouds):
        places = random.uniform((-0.6, -0.4, -4.0), (0.6, 0.4, -2.0), (40, 3))
        cloud = plain_cloud(places, np.full((40, 3), 0.06), [COLOURS[min(number, 3)]] * 40, [0.6] * 40)
        batches.append(SplatBatch(cloud, np.eye(4)[None], number + 1))
    names = ("/wall", *(f"/cloud{number}" for number in range(clouds)))
    return Scene((wall,), (), replace(BLACK, visible=False), names, splats=tuple(batches))


def matte(frame: Frame, name: str) -> FloatArray:
    ranked = frame.aovs["cryptoObject"]
    return np.where(ranked[..., 0::2] == id_of(name), ranked[..., 1::2], 0).sum(axis=-1)


@pytest.mark.parametrize(("clouds", "engine"), [(1, "lens"), (2, "lens"), (2, "pinhole"), (5, "lens")])
def test_each_cloud_covers_what_shows_its_colour(renderer: FrameRenderer, clouds: int, engine: str) -> None:
    frame = renderer.render(scene(clouds), OPEN, replace(SETTINGS, engine=engine))
    for channel, name in enumerate(("/cloud0", "/cloud1", "/wall")[: clouds if clouds == 1 else 2]):
        np.testing.assert_allclose(matte(frame, name), frame.color[..., channel], atol=2e-3)
    assert matte(frame, "/cloud0").max() > 0.5
    covered = matte(frame, "/wall") + sum(matte(frame, f"/cloud{number}") for number in range(clouds))
    np.testing.assert_allclose(covered, frame.color[..., 3], atol=3e-3)
    assert matte(frame, f"/cloud{clouds - 1}").any()


def test_mattes_leave_the_picture_as_it_is(renderer: FrameRenderer) -> None:
    plain = renderer.render(scene(2), OPEN, replace(SETTINGS, aovs=("color",))).color
    np.testing.assert_array_equal(renderer.render(scene(2), OPEN, SETTINGS).color, plain)


def test_swept_pictures_have_mattes_of_splats(renderer: FrameRenderer) -> None:
    still = scene(2)
    moments = [Moment(still, OPEN, 0.5)] * 2
    settings = replace(SETTINGS, motion=2, motion_by="velocities")
    frame = renderer.render_swept(ShutterScenes(still, still, still), OPEN, moments, settings)
    for channel, name in enumerate(("/cloud0", "/cloud1")):
        np.testing.assert_allclose(matte(frame, name), frame.color[..., channel], atol=2e-3)


def test_too_many_clouds_for_mattes_are_an_error(renderer: FrameRenderer) -> None:
    with pytest.raises(SettingsError, match="tell up to 15 clouds"):
        renderer.render(scene(MOST_MATTE_CLOUDS + 1), OPEN, SETTINGS)
