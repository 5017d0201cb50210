"""Shadow maps on the device. What stands still is drawn once and kept; what moves is drawn over a copy of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from render.gl.compat import GL
from render.gl.held import Making
from render.layers.index import Draw
from render.layers.shadows import SHADOW_MAP_SIDE_PX
from render.scene import Batch, DoubleArray

DrawMap = Callable[[int, DoubleArray, Sequence[Draw]], None]
"""Draws into the bound map of so many pixels a side, as this matrix sees it, these draws."""


class ShadowMaps:
    """The maps of one context.

    Args:
        draw: draws into them.
    """

    def __init__(self, draw: DrawMap) -> None:
        self._draw = draw
        self._all, self._still = _Maps(), _Maps()
        self._cast: tuple[Draw, ...] | None = None
        self._views = np.zeros((0, 4, 4))

    @property
    def texture(self) -> int:
        """OpenGL name of the array of maps; of one map that holds nothing where none was cast."""
        self._all.hold(1)
        return self._all.texture

    def cast(self, views: DoubleArray, draws: Sequence[Draw]) -> bool:
        """Draw the maps, where they are not what they were.

        Args:
            views: ``(n, 4, 4)`` clip from world, of each map.
            draws: all that casts shadows.

        Returns:
            Whether they are others now.
        """
        same_views = np.array_equal(views, self._views)
        if same_views and self._cast is not None and _batches(self._cast) == _batches(draws):
            return False
        before, self._cast = (self._cast if same_views else None), None  # which holds until all are drawn
        if not same_views:
            self._still.draws = ()
        self._views = views
        self._all.hold(len(views))
        kept = self._stand_still(before or (), draws, views)
        if kept:
            self._still.copy_to(self._all, len(views))
        self._all.draw(self._draw, views, [draw for draw in draws if id(draw.batch) not in kept], clear=not kept)
        self._cast = tuple(draws)
        return True

    def _stand_still(self, before: Sequence[Draw], draws: Sequence[Draw], views: DoubleArray) -> set[int]:
        """The identities of the batches that the still maps hold, all of which are among the draws."""
        now, last = _batches(draws), _batches(before)
        held = set(_batches(self._still.draws))
        if not held <= now.keys():
            held = set()
        found = [draw for draw in draws if id(draw.batch) in last]
        if _triangles(found) > 1.25 * _triangles([draw for draw in draws if id(draw.batch) in held]):
            self._still.draws = ()
            self._still.hold(len(views))
            self._still.draw(self._draw, views, found, clear=True)
            self._still.draws = tuple(found)
            held = set(_batches(found))
        return held

    def release(self) -> None:
        """Give the memory on the device back."""
        self._cast = None
        self._all.release()
        self._still.release()


class _Maps:
    """An array of maps, and the framebuffer that they are drawn through.

    Attributes:
        draws: what they hold, where that is kept.
    """

    def __init__(self) -> None:
        self.texture = 0
        self._framebuffer = 0
        self._layers = 0
        self.draws: tuple[Draw, ...] = ()

    def hold(self, layers: int) -> None:
        """Have at least so many maps, and one at the least; they hold nothing where there were fewer."""
        layers = max(1, layers)
        if self._layers >= layers:
            return
        self.release()
        with Making() as making:
            self.texture = _depth_array(SHADOW_MAP_SIDE_PX, layers)
            making.callback(GL.glDeleteTextures, [self.texture])
            self._framebuffer = GL.glGenFramebuffers(1)
        self._layers = layers

    def draw(self, draw: DrawMap, views: DoubleArray, draws: Sequence[Draw], *, clear: bool) -> None:
        """Draw into the first maps."""
        try:
            for layer, clip_from_world in enumerate(views):
                GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
                GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, self.texture, 0, layer)
                GL.glDepthMask(True)
                if clear:
                    GL.glClearBufferfv(GL.GL_DEPTH, 0, np.zeros(4, np.float32))
                draw(SHADOW_MAP_SIDE_PX, clip_from_world, draws)
        finally:
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)

    def copy_to(self, other: _Maps, layers: int) -> None:
        """Copy the first maps."""
        whole = (SHADOW_MAP_SIDE_PX, SHADOW_MAP_SIDE_PX, layers)
        array = GL.GL_TEXTURE_2D_ARRAY
        GL.glCopyImageSubData(self.texture, array, 0, 0, 0, 0, other.texture, array, 0, 0, 0, 0, *whole)

    def release(self) -> None:
        """Give the memory on the device back."""
        if self._layers:
            GL.glDeleteTextures([self.texture])
            GL.glDeleteFramebuffers(1, [self._framebuffer])
        self.texture = self._framebuffer = self._layers = 0
        self.draws = ()


def _batches(draws: Sequence[Draw]) -> dict[int, Batch]:
    """By their identities, which hold while the draws do."""
    return {id(draw.batch): draw.batch for draw in draws}


def _triangles(draws: Sequence[Draw]) -> int:
    return sum(len(draw.batch.geometry.triangles) * len(draw.instances) for draw in draws)


def _depth_array(side_px: int, layers: int) -> int:
    """A depth texture array for shadow comparison, lit where the reference is nearer or as near (reversed depth)."""
    name: int = GL.glGenTextures(1)
    with Making() as making:
        making.callback(GL.glDeleteTextures, [name])
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, name)
        GL.glTexImage3D(
            GL.GL_TEXTURE_2D_ARRAY,
            0,
            GL.GL_DEPTH_COMPONENT32F,
            side_px,
            side_px,
            layers,
            0,
            GL.GL_DEPTH_COMPONENT,
            GL.GL_FLOAT,
            None,
        )
        for parameter, value in (
            (GL.GL_TEXTURE_MIN_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_MAG_FILTER, GL.GL_LINEAR),
            (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_EDGE),
            (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_EDGE),
            (GL.GL_TEXTURE_COMPARE_MODE, GL.GL_COMPARE_REF_TO_TEXTURE),
            (GL.GL_TEXTURE_COMPARE_FUNC, GL.GL_GEQUAL),
        ):
            GL.glTexParameteri(GL.GL_TEXTURE_2D_ARRAY, parameter, value)
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, 0)
    return name
