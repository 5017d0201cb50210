"""Shadow maps on the device. Still draws are drawn once and cached; moving draws are drawn over a copy."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import moderngl
import numpy as np

from render.gl.compat import GL
from render.gl.resources import Construction
from render.gl.shaders import ProgramCache
from render.layers.index import Draw
from render.layers.shadow_cells import ShadowCells
from render.layers.shadows import SHADOW_MAP_SIDE_PX
from render.model.arrays import DoubleArray

SHADOW_UNIT = 10
"""Texture unit as ``layers/shadow.glsl`` binds it."""
DrawMap = Callable[[int, DoubleArray, Sequence[Draw]], None]
"""Function that draws into the bound map: side in pixels, ``(4, 4)`` clip from world, draws."""


@dataclass(frozen=True, eq=False)
class _CachedMap:
    """Contents of one shadow map.

    Attributes:
        view: ``(4, 4)`` clip from world.
        draws: all draws that cast shadows in it.
        still: those of them that are in the cached map of still draws.
    """

    view: DoubleArray
    draws: tuple[Draw, ...]
    still: tuple[Draw, ...] = ()


class ShadowMaps:
    """Shadow maps of one context.

    Args:
        draw: function that draws into a bound map.
        ctx: context.
        programs: its programs.
    """

    def __init__(self, draw: DrawMap, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._draw, self._ctx, self._programs = draw, ctx, programs
        self._cells: ShadowCells | None = None
        self._all, self._still = _Maps(), _Maps()
        self._cast: dict[int, _CachedMap] = {}
        self._has_cells: set[int] = set()

    @property
    def texture(self) -> int:
        """OpenGL name of the array of maps; of one empty map where there are none."""
        self._all.reserve(1)
        return self._all.texture

    def bind(self, soft: Collection[int]) -> None:
        """Bind the maps to their texture unit, and the cells of some of them, which are built where they are out of date.

        Args:
            soft: maps whose cells are needed.
        """
        if soft and self._cells is None:
            self._cells = ShadowCells(
                self._ctx, self._programs, self._all.texture, SHADOW_MAP_SIDE_PX, self._all.layers
            )
        GL.glActiveTexture(GL.GL_TEXTURE0 + SHADOW_UNIT)
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, self.texture)
        if self._cells is not None:
            for layer in sorted(set(soft) - self._has_cells):
                self._cells.build(layer)
                self._has_cells.add(layer)
            self._cells.bind()

    def cast(self, views: DoubleArray, casting: Sequence[Sequence[Draw]]) -> bool:
        """Draw the maps that have changed.

        Args:
            views: ``(n, 4, 4)`` clip from world of each map.
            casting: all draws that cast shadows, for each map.

        Returns:
            Whether any map was drawn.
        """
        if self._all.reserve(len(views)):
            self._cast = {}
            self._release_cells()
        changed = False
        for layer, (view, draws) in enumerate(zip(views, casting, strict=True)):
            last = self._cast.get(layer)
            if last is not None and not np.array_equal(last.view, view):
                last = None
            if last is not None and _ids(last.draws) == _ids(draws):
                continue
            self._cast.pop(layer, None)  # until it is drawn
            self._has_cells.discard(layer)
            self._cast[layer] = self._draw_map(layer, view, tuple(draws), last, len(views))
            changed = True
        return changed

    def _draw_map(
        self, layer: int, view: DoubleArray, draws: tuple[Draw, ...], last: _CachedMap | None, count: int
    ) -> _CachedMap:
        """Draw a map, reusing its last contents of the same view."""
        still: tuple[Draw, ...] = ()
        if last is not None:
            last_ids = _ids(last.draws)
            still = last.still if _ids(last.still) <= _ids(draws) else ()
            seen_before = tuple(draw for draw in draws if id(draw.batch) in last_ids)
            if _triangles(seen_before) > 1.25 * _triangles(still):
                if self._still.reserve(count):
                    self._cast = {other: replace(cast, still=()) for other, cast in self._cast.items()}
                self._still.draw(self._draw, layer, view, seen_before, clear=True)
                still = seen_before
        kept = _ids(still)
        if kept:
            self._still.copy_to(self._all, layer)
        moving = [draw for draw in draws if id(draw.batch) not in kept]
        self._all.draw(self._draw, layer, view, moving, clear=not kept)
        return _CachedMap(view, draws, still)

    def release(self) -> None:
        """Release the memory on the device."""
        self._cast = {}
        self._release_cells()
        self._all.release()
        self._still.release()

    def _release_cells(self) -> None:
        if self._cells is not None:
            self._cells.release()
        self._cells = None
        self._has_cells = set()


class _Maps:
    """Array of maps, and the framebuffer that they are drawn through."""

    def __init__(self) -> None:
        self.texture = 0
        self._framebuffer = 0
        self.layers = 0

    def reserve(self, layers: int) -> bool:
        """Allocate at least ``layers`` maps, and at least one; true where they are new and empty."""
        layers = max(1, layers)
        if self.layers >= layers:
            return False
        self.release()
        with Construction() as making:
            self.texture = _depth_array(SHADOW_MAP_SIDE_PX, layers)
            making.callback(GL.glDeleteTextures, [self.texture])
            self._framebuffer = GL.glGenFramebuffers(1)
        self.layers = layers
        return True

    def draw(self, draw: DrawMap, layer: int, view: DoubleArray, draws: Sequence[Draw], *, clear: bool) -> None:
        """Draw into one map."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        try:
            GL.glFramebufferTextureLayer(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, self.texture, 0, layer)
            GL.glDepthMask(True)
            if clear:
                # A program that samples the maps may be bound, and a driver checks its textures when it clears.
                GL.glUseProgram(0)
                GL.glClearBufferfv(GL.GL_DEPTH, 0, np.zeros(4, np.float32))
            draw(SHADOW_MAP_SIDE_PX, view, draws)
        finally:
            GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, 0)

    def copy_to(self, other: _Maps, layer: int) -> None:
        """Copy one map."""
        size = (SHADOW_MAP_SIDE_PX, SHADOW_MAP_SIDE_PX, 1)
        array = GL.GL_TEXTURE_2D_ARRAY
        GL.glCopyImageSubData(self.texture, array, 0, 0, 0, layer, other.texture, array, 0, 0, 0, layer, *size)

    def release(self) -> None:
        """Release the memory on the device."""
        if self.layers:
            GL.glDeleteTextures([self.texture])
            GL.glDeleteFramebuffers(1, [self._framebuffer])
        self.texture = self._framebuffer = self.layers = 0


def _ids(draws: Sequence[Draw]) -> set[int]:
    """Ids of the draws' batches, valid while the draws are alive."""
    return {id(draw.batch) for draw in draws}


def _triangles(draws: Sequence[Draw]) -> int:
    return sum(len(draw.batch.geometry.triangles) * len(draw.instances) for draw in draws)


def _depth_array(side_px: int, layers: int) -> int:
    """Depth texture array for shadow comparison, lit where the reference is nearer or equal (reversed depth)."""
    name: int = GL.glGenTextures(1)
    with Construction() as making:
        making.callback(GL.glDeleteTextures, [name])
        GL.glBindTexture(GL.GL_TEXTURE_2D_ARRAY, name)
        GL.glTexStorage3D(GL.GL_TEXTURE_2D_ARRAY, 1, GL.GL_DEPTH_COMPONENT32F, side_px, side_px, layers)
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
