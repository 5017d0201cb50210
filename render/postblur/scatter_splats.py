"""Splats: the choice of the spots to draw, and their drawing by the rasteriser, one quad for each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.limits import make_storage
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, load_source, set_uniforms
from render.postblur.scatter_spot import STEPS, Spot
from render.postblur.spot_cache import TableTextures

WIDER = 1.0
"""Ratio of spot radius to side from which a square of like pixels is drawn as one splat."""
SPAN = 0.05
"""Relative difference that radii in such a square may have, in addition to half a pixel."""
SHIFT = 0.05
"""Greatest offset of the square's centre of light from its middle, relative to the radius."""
MOST_SHIFT_PX = 0.25
"""Greatest such offset in pixels, so that a highlight stays in its place."""
_SIDE = 8  # side of a work group
_FIRST_PIECE, _LEAST_PIECE = 1 << 17, 1 << 12  # pixels that spots cover
_COUNTS, _OFFSETS, _SPOTS = 0, 0, 1  # as the shaders bind them


@dataclass(frozen=True, eq=False)
class Points:
    """Points of the near or the far field, one for each pixel.

    Attributes:
        light: RGBA32F, premultiplied.
        radii: radii of circles of confusion, in pixels of the light.
        channel: channel of ``radii``.
        spot: spot of the camera, in pixels of the light.
        behind: whether the points are of the far field.
    """

    light: moderngl.Texture
    radii: moderngl.Texture
    channel: int
    spot: Spot
    behind: bool

    def bind(self, program: moderngl.ComputeShader | moderngl.Program) -> None:
        """Bind the textures and set the uniforms of ``scatter/scatter.glsl``."""
        self.light.use(0)
        self.radii.use(1)
        p, q, r = self.spot.moments
        moments = p, q if self.behind else -q, r
        set_uniforms(program, light=0, radii=1, channel=self.channel, moments=moments, is_soft=self.spot.has_errors)


class Splats:
    """Draws splats, with the programs of one context. The cancellation is polled between pieces."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._piece = PieceSize(_FIRST_PIECE, least=_LEAST_PIECE)
        self._program: moderngl.Program | None = None

    def draw(
        self,
        points: Points,
        tables: TableTextures,
        edges: tuple[float, ...],
        scope: Resources,
        *,
        backward: bool = False,
    ) -> Iterator[moderngl.Texture]:
        """Draw the points' splats, size class by size class, into a texture as large as theirs, valid until the next class.

        Args:
            points: points of the near or the far field.
            tables: tables of their spots.
            edges: radii at which size classes begin, and at which the last one ends: pixels, ascending.
            scope: scope that owns the textures.
            backward: whether the class of the widest spots comes first.

        Yields:
            RGBA32F light and coverage. Classes without points are left out.
        """
        size, classes = points.light.size, len(edges) - 1
        groups = -(-size[0] // _SIDE), -(-size[1] // _SIDE)
        plan = scope.keep(self._ctx.texture(size, 1, dtype="u1"))
        counts = self._plan(points, edges, plan, groups, scope)
        totals = counts.sum(axis=1)
        if not totals.any():
            return
        firsts = np.concatenate([[0], np.cumsum(totals)])
        spots = self._list(plan, counts, groups, scope)
        target = scope.keep(self._ctx.texture(size, 4, dtype="f4"))
        target.repeat_x = target.repeat_y = False
        buffer = scope.keep(self._ctx.framebuffer(color_attachments=[target]))
        for kind in reversed(range(classes)) if backward else range(classes):
            if totals[kind]:
                most_px = (2 * min(edges[kind + 1] + points.spot.error_reach_px, tables.middle) + 1) ** 2
                self._draw_class(points, tables, spots, int(firsts[kind]), int(totals[kind]), buffer, most_px)
                yield target

    def _plan(
        self,
        points: Points,
        edges: tuple[float, ...],
        plan: moderngl.Texture,
        groups: tuple[int, int],
        scope: Resources,
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.uint32]]:
        """Plan the splats, and count them: ``(classes, groups)``."""
        classes = len(edges) - 1
        counts = scope.keep(self._ctx.buffer(reserve=4 * classes * groups[0] * groups[1]))
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

    def _list(
        self,
        plan: moderngl.Texture,
        counts: np.ndarray[tuple[int, ...], np.dtype[np.uint32]],
        groups: tuple[int, int],
        scope: Resources,
    ) -> moderngl.Buffer:
        before = np.cumsum(counts) - counts.ravel()
        offsets = scope.keep(self._ctx.buffer(before.astype(np.uint32).tobytes()))
        spots = scope.keep(make_storage(self._ctx, 4 * int(counts.sum()), "the list of spots"))
        program = self._programs.compute("scatter/scatter_list.comp", {"CLASSES": len(counts)})
        plan.use(0)
        set_uniforms(program, plan=0)
        offsets.bind_to_storage_buffer(_OFFSETS)
        spots.bind_to_storage_buffer(_SPOTS)
        program.run(*groups)
        self._ctx.memory_barrier()
        return spots

    def _draw_class(
        self,
        points: Points,
        tables: TableTextures,
        spots: moderngl.Buffer,
        first: int,
        count: int,
        target: moderngl.Framebuffer,
        most_px: float,
    ) -> None:
        """Draw one class of splats, none of which covers more than ``most_px`` pixels."""
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
            with Resources() as scope:
                quad = scope.keep(self._ctx.vertex_array(program, []))
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
        """Learn the size of a piece from its time; much smaller pieces do not predict the time of large ones."""
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
        """Release the program."""
        if self._program is not None:
            self._program.release()
            self._program = None
