"""Mipmaps by a compute shader: each level holds the means of the texture over the rectangles of its pixels."""

from __future__ import annotations

import numpy as np
import pytest

from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.arrays import DoubleArray
from render.trace.highlights.mipmaps import build_mipmaps

pytestmark = pytest.mark.gl


def mean_weights(fine: int, coarse: int) -> DoubleArray:
    """Weights ``(coarse, fine)`` by which pixels of a line count in those of a shorter one."""
    edges = np.arange(coarse + 1) * fine / coarse
    pixels = np.arange(fine)
    overlaps = np.minimum(edges[1:, None], pixels + 1) - np.maximum(edges[:-1, None], pixels)
    return np.asarray(np.maximum(overlaps, 0) * coarse / fine)


@pytest.mark.parametrize("channels", [1, 2])
@pytest.mark.parametrize("size", [(16, 8), (35, 20), (7, 1), (1, 1)])
def test_each_level_holds_means_of_the_one_before(size: tuple[int, int], channels: int) -> None:
    width, height = size
    pixels = np.random.default_rng(1).random((height, width, channels), np.float32)
    with GraphicsContext() as graphics:
        texture = graphics.ctx.texture(size, channels, pixels.tobytes(), dtype="f4")
        build_mipmaps(graphics.ctx, ProgramCache(graphics.ctx), texture)
        expected, level = pixels.astype(np.float64), 0
        while expected.shape[:2] != (1, 1):
            height, width = (max(side // 2, 1) for side in expected.shape[:2])
            rows, columns = mean_weights(expected.shape[0], height), mean_weights(expected.shape[1], width)
            expected, level = np.einsum("yj,xi,jic->yxc", rows, columns, expected), level + 1
            found = np.empty(expected.shape, np.float32)
            texture.use()
            GL.glGetTexImage(GL.GL_TEXTURE_2D, level, (GL.GL_RED, GL.GL_RG)[channels - 1], GL.GL_FLOAT, found)
            np.testing.assert_allclose(found, expected, rtol=1e-5)
        np.testing.assert_allclose(expected[0, 0], pixels.mean((0, 1)), rtol=1e-5)
