"""Spots on a target: which are drawn, where, and the drawing of them by the rasteriser, one quad for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, load_source, set_uniforms
from render.postblur.scatter_spot import STEPS, Spot
from render.postblur.scatter_store import TableTextures

WIDER = 1.0
"""Squares of alike pixels are drawn as one where their spots' radii are at least this many times their side."""
SPAN = 0.05
"""By how much of them, and half a pixel, radii in such a square may differ."""
SHIFT = 0.05
"""By how much of the radius the middle of its light may be off its own."""
MOST_SHIFT_PX = 0.25
"""And by no more, so that a highlight stays in its place."""
_SIDE = 8  # of the squares that a work group has
_FIRST_PIECE, _LEAST_PIECE = 1 << 17, 1 << 12  # pixels that spots cover
_COUNTS, _OFFSETS, _SPOTS = 0, 0, 1  # as the shaders bind them


@dataclass(frozen=True, eq=False)
class Points:
    """Points of one side of the focus, one for each pixel.

    Attributes:
        light: RGBA32F, premultiplied.
        radii: of circles of confusion, in pixels of the light.
        channel: of the radii.
        spot: of the camera, in pixels of the light.
        behind: whether they are behind the focus.
    """

    light: moderngl.Texture
    radii: moderngl.Texture
    channel: int
    spot: Spot
    behind: bool

    def bind(self, program: moderngl.ComputeShader | moderngl.Program) -> None:
        """Let a shader that includes ``scatter/scatter.glsl`` know them."""
        self.light.use(0)
        self.radii.use(1)
        p, q, r = self.spot.moments
        moments = p, q if self.behind else -q, r
        set_uniforms(program, light=0, radii=1, channel=self.channel, moments=moments, is_soft=self.spot.has_errors)


class Splats:
    """Draws spots, with the programs of one context; the cancellation beats between some of them and the next."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._piece = PieceSize(_FIRST_PIECE, least=_LEAST_PIECE)
        self._program: moderngl.Program | None = None

    def drawn(
        self,
        points: Points,
        tables: TableTextures,
        edges: tuple[float, ...],
        held: Resources,
        *,
        backward: bool = False,
    ) -> Iterator[moderngl.Texture]:
        """Draw the points' splats, size class by size class, into a texture as large as theirs, valid until the next class.

        Args:
            points: points of the near or the far field.
            tables: tables of their spots.
            edges: radii at which size classes begin, and at which the last one ends: pixels, ascending.
            held: scope that owns the textures.
            backward: whether the widest come first.

        Yields:
            RGBA32F light and how much of it there is. Classes without points are left out.
        """
        size, classes = points.light.size, len(edges) - 1
        groups = -(-size[0] // _SIDE), -(-size[1] // _SIDE)
        plan = held.keep(self._ctx.texture(size, 1, dtype="u1"))
        counts = self._planned(points, edges, plan, groups, held)
        totals = counts.sum(axis=1)
        if not totals.any():
            return
        firsts = np.concatenate([[0], np.cumsum(totals)])
        spots = self._listed(plan, counts, groups, held)
        target = held.keep(self._ctx.texture(size, 4, dtype="f4"))
        target.repeat_x = target.repeat_y = False
        buffer = held.keep(self._ctx.framebuffer(color_attachments=[target]))
        for kind in reversed(range(classes)) if backward else range(classes):
            if totals[kind]:
                most_px = (2 * min(edges[kind + 1] + points.spot.error_reach_px, tables.middle) + 1) ** 2
                self._draw(points, tables, spots, int(firsts[kind]), int(totals[kind]), buffer, most_px)
                yield target

    def _planned(
        self, points: Points, edges: tuple[float, ...], plan: moderngl.Texture, groups: tuple[int, int], held: Resources
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.uint32]]:
        """``(classes, groups)`` how many spots are to be drawn."""
        classes = len(edges) - 1
        counts = held.keep(self._ctx.buffer(reserve=4 * classes * groups[0] * groups[1]))
        program = self._programs.compute(
            "scatter/scatter_plan.comp",
            {"CLASSES": classes, "WIDER": WIDER, "SPAN": SPAN, "SHIFT": SHIFT, "MOST_SHIFT": MOST_SHIFT_PX},
        )
        points.bind(program)
        begins = (*edges[:-1], *(0.0,) * (4 - len(edges)), edges[-1])
        set_uniforms(program, edges=begins)
        plan.bind_to_image(0, read=False, write=True)
        counts.bind_to_storage_buffer(_COUNTS)
        program.run(*groups)
        self._ctx.memory_barrier()
        return np.frombuffer(counts.read(), np.uint32).reshape(classes, -1)

    def _listed(
        self,
        plan: moderngl.Texture,
        counts: np.ndarray[tuple[int, ...], np.dtype[np.uint32]],
        groups: tuple[int, int],
        held: Resources,
    ) -> moderngl.Buffer:
        before = np.cumsum(counts) - counts.ravel()
        offsets = held.keep(self._ctx.buffer(before.astype(np.uint32).tobytes()))
        spots = held.keep(self._ctx.buffer(reserve=4 * int(counts.sum())))
        program = self._programs.compute("scatter/scatter_list.comp", {"CLASSES": len(counts)})
        plan.use(0)
        set_uniforms(program, plan=0)
        offsets.bind_to_storage_buffer(_OFFSETS)
        spots.bind_to_storage_buffer(_SPOTS)
        program.run(*groups)
        self._ctx.memory_barrier()
        return spots

    def _draw(
        self,
        points: Points,
        tables: TableTextures,
        spots: moderngl.Buffer,
        first: int,
        count: int,
        target: moderngl.Framebuffer,
        most_px: float,
    ) -> None:
        """Draw some of the spots, none of which covers more than so many pixels."""
        program = self._quads()
        points.bind(program)
        tables.weights.use(2)
        tables.reach.use(3)
        set_uniforms(program, weights=2, reaches=3, steps=tables.steps, middle=tables.middle)
        set_uniforms(program, target_px=target.size)
        spots.bind_to_storage_buffer(_SPOTS)
        before = self._ctx.detect_framebuffer()
        try:
            target.use()
            target.viewport = (0, 0, *target.size)
            target.clear(0.0, 0.0, 0.0, 0.0)
            self._ctx.enable_only(moderngl.BLEND)
            self._ctx.blend_func = moderngl.ONE, moderngl.ONE
            with Resources() as held:
                quad = held.keep(self._ctx.vertex_array(program, []))
                last = first + count
                while first < last:
                    left = last - first
                    some = (
                        min(max(1, int(self._piece.units / most_px)), left)
                        if self._cancellation.is_cancellable
                        else left
                    )
                    set_uniforms(program, first=first)
                    quad.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=some)
                    self._learn(some * most_px, self._cancellation.poll())
                    first += some
        finally:
            self._ctx.enable_only(moderngl.NOTHING)
            before.use()

    def _learn(self, pixels: float, took_ms: float) -> None:
        """Take note of a piece; those much smaller than they might be say nothing of large ones."""
        if 2 * pixels >= self._piece.units:
            self._piece.learn(int(pixels), took_ms)

    def _quads(self) -> moderngl.Program:
        if self._program is None:
            try:
                self._program = self._ctx.program(
                    load_source("scatter/scatter.vert", {"STEPS": f"{STEPS}.0"}), load_source("scatter/scatter.frag")
                )
            except moderngl.Error as error:
                raise GraphicsError(f"the shaders of scattering did not compile: {error}") from error
        return self._program

    def release(self) -> None:
        """Give the device's memory back."""
        if self._program is not None:
            self._program.release()
            self._program = None
