"""Splats that are kept for the next picture, until a scene has none."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.splats import SplatBatch
from render.optics.view import PinholeView
from render.trace.picture_focus import picture_focus
from render.trace.splat_layers import SplatLayers, paint_nothing
from tests.render.kits.splats import CAMERA, SIZE, plain_cloud

pytestmark = pytest.mark.gl


def test_splats_of_the_last_scene_are_released() -> None:
    view = PinholeView.from_camera(CAMERA, *SIZE)
    focus = picture_focus(CAMERA, view)
    cloud = plain_cloud([[0, 0, -2]], [[0.1, 0.1, 0.1]], [[0.5, 0.5, 0.5]], [0.5])
    batches = (SplatBatch(cloud, np.eye(4)[None]),)
    kept = weakref.ref(batches[0])
    with GraphicsContext() as graphics:
        layers = SplatLayers(graphics.ctx, ProgramCache(graphics.ctx))
        assert layers.painting(batches, view, view, focus, 0.01) is not paint_nothing
        del batches, cloud
        assert kept() is not None
        assert layers.painting((), view, view, focus, 0.01) is paint_nothing
        gc.collect()
        assert kept() is None
