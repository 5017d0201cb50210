"""Gaussian splats that are held out: they hide what is behind them, and have neither light nor coverage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.mattes import id_of
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, Material, Scene
from render.model.splats import SplatBatch
from tests.render.kits.splats import BLACK, CAMERA, SIZE, captured_set, plain_cloud

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(*SIZE, rays=16, supersample=2, shading="unlit")
MIDDLE = SIZE[1] // 2, SIZE[0] // 2


def sheet(depth_m: float, red: float, opacity: float, prim: int, *, is_holdout: bool = False) -> SplatBatch:
    """One splat across the view."""
    cloud = plain_cloud([[0, 0, -depth_m]], [[9, 9, 0.01]], [[red, 0, 0]], [opacity])
    return SplatBatch(cloud, np.eye(4)[None], prim, is_holdout=is_holdout)


def scene(*splats: SplatBatch, batches: tuple[Batch, ...] = ()) -> Scene:
    return Scene(batches, (), replace(BLACK, visible=False), ("/wall", "/a", "/b"), splats=splats)


@pytest.mark.parametrize("engine", ["lens", "pinhole", "accumulation"])
def test_a_holdout_dims_what_is_behind_and_leaves_no_alpha(renderer: FrameRenderer, engine: str) -> None:
    """Between two sheets, and between those and a wall."""
    wall = Batch(rectangle((0, 0, -5), (9, 0, 0), (0, 9, 0)), Material(base_color=(0, 0, 1)), np.eye(4)[None])
    splats = sheet(2, 1, 0.5, 1), sheet(3, 1, 0.6, 2, is_holdout=True), sheet(4, 1, 0.5, 1)
    for batches, blue in (((), 0.0), ((wall,), 0.5 * 0.4 * 0.5)):
        held = scene(*splats, batches=batches)
        seen = renderer.render(held, CAMERA, replace(SETTINGS, engine=engine)).color[MIDDLE]
        red = 0.5 + 0.5 * 0.4 * 0.5
        np.testing.assert_allclose(seen, [red, 0, blue, red + blue], atol=5e-3)


def matte(frame: Frame, name: str) -> FloatArray:
    ranked = frame.aovs["cryptoObject"]
    return np.where(ranked[..., 0::2] == id_of(name), ranked[..., 1::2], 0).sum(axis=-1)


def captured(*, is_holdout: bool) -> Scene:
    """A captured set, and a red sheet behind a part of it and before another one; the set is black where it is not held out."""
    cloud = captured_set(2_000)
    black = replace(cloud, harmonics=np.full((2_000, 1, 3), -9, np.float32))
    return scene(sheet(3, 1, 0.7, 1), SplatBatch(black, np.eye(4)[None], 2, is_holdout=is_holdout))


@pytest.mark.parametrize("is_swept", [False, True])
def test_a_held_set_is_a_black_one_without_its_coverage(renderer: FrameRenderer, is_swept: bool) -> None:
    camera = replace(CAMERA, f_stop=0.5)
    settings = replace(SETTINGS, aovs=("cryptoObject",), motion=1 + is_swept, motion_by="velocities")

    def draw(drawn: Scene) -> Frame:
        if not is_swept:
            return renderer.render(drawn, camera, settings)
        return renderer.render_swept(
            ShutterScenes(drawn, drawn, drawn), camera, [Moment(drawn, camera, 0.5)] * 2, settings
        )

    black, held = draw(captured(is_holdout=False)), draw(captured(is_holdout=True))
    np.testing.assert_allclose(held.color[..., :3], black.color[..., :3], atol=1e-3)
    np.testing.assert_allclose(held.color[..., 3], black.color[..., 3] - matte(black, "/b"), atol=3e-3)
    assert matte(black, "/b").max() > 0.5
    assert not matte(held, "/b").any()
    np.testing.assert_allclose(matte(held, "/a"), matte(black, "/a"), atol=1e-3)


def test_a_held_set_alone_leaves_nothing(renderer: FrameRenderer) -> None:
    only = scene(SplatBatch(captured_set(2_000), np.eye(4)[None], 2, is_holdout=True))
    frame = renderer.render(only, CAMERA, replace(SETTINGS, aovs=("depth", "prim_id", "cryptoObject")))
    np.testing.assert_allclose(frame.color, 0, atol=1e-6)
    assert np.isinf(frame.aovs["depth"]).all()
    assert not frame.aovs["prim_id"].any()
    assert not frame.aovs["cryptoObject"].any()


def test_blurs_show_a_held_set_as_a_black_one(renderer: FrameRenderer) -> None:
    settings, camera = replace(SETTINGS, engine="flag"), replace(CAMERA, f_stop=0.5)
    held, black = (renderer.render(captured(is_holdout=role), camera, settings).color for role in (True, False))
    np.testing.assert_allclose(held, black, atol=1e-4)
