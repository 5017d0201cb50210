"""Blurs of a single image: what holds for every engine of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import moderngl
import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import posts_before_wall
from render.model.lens import IrisShape
from render.postblur.flag_blur import FlagBlur
from render.postblur.focus_split import Blur, FocusSplit
from render.postblur.gather import GatherBlur
from render.postblur.importance import ImportanceBlur
from render.postblur.linear import LinearBlur
from render.postblur.scatter import ScatterBlur
from tests.render.kits.blur_fields import as_array

BLURS: dict[str, Callable[[moderngl.Context, ProgramCache], Blur]] = {
    "flag": FlagBlur,
    "gather": GatherBlur,
    "scatter": ScatterBlur,
    "linear": LinearBlur,
    "importance": ImportanceBlur,
}


@pytest.mark.parametrize("f_stop", [1e-6, 1e-12, 1e-44])
@pytest.mark.parametrize("engine", BLURS)
def test_any_f_number_blurs_the_picture(renderer: FrameRenderer, engine: str, f_stop: float) -> None:
    scene, camera = posts_before_wall()
    settings = FrameSettings(48, 36, shading="unlit", supersample=1, rays=1)
    sharp = renderer.render(scene, camera, replace(settings, engine="pinhole")).color[..., :3]
    seen = renderer.render(scene, replace(camera, f_stop=f_stop), replace(settings, engine=engine)).color
    assert np.isfinite(seen).all()
    assert seen[..., :3].max() > 0.1 * sharp.max()
    assert np.abs(np.diff(seen[..., :3], axis=1)).mean() < 0.2 * np.abs(np.diff(sharp, axis=1)).mean()


@pytest.mark.parametrize("radius", [8.0, 30.0])
@pytest.mark.parametrize("squeeze", [0.5, 2.0])
@pytest.mark.parametrize("engine", BLURS)
def test_a_squeeze_widens_or_narrows_a_points_picture(
    renderer: FrameRenderer, engine: str, squeeze: float, radius: float
) -> None:
    """A faint point before black: it reaches as far as its circle up and down, and a squeeze less to the sides."""
    ctx, side = renderer.graphics.ctx, 151
    near, far = np.zeros((2, side, side, 4), np.float32)
    near[side // 2, side // 2] = [1, 1, 1, 1e-4]
    far[..., 3] = 1
    radii = np.zeros((side, side, 2), np.float32)
    radii[..., 0] = radius
    blur = BLURS[engine](ctx, ProgramCache(ctx))
    with Resources() as scope:
        near_made, far_made, radii_made = (
            scope.keep(ctx.texture((side, side), values.shape[-1], values.tobytes(), dtype="f4"))
            for values in (near, far, radii)
        )
        split = FocusSplit(near_made, far_made, radii_made, radius, IrisShape(), squeeze)
        light = as_array(blur.blur(split, scope))[..., 0].astype(np.float64)
    blur.release()
    off = np.arange(side) - side // 2
    down, across = (np.sqrt(4 * (light.sum(axis=axis) * off**2).sum() / light.sum()) for axis in (1, 0))
    assert down == pytest.approx(radius, rel=0.03, abs=0.3)
    assert across == pytest.approx(radius / squeeze, rel=0.03, abs=0.3)
