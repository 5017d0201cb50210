"""The engine `scatter`: each point out of focus drawn as the picture of the iris (Kyaw 2013, section 7.3).

Beyond the paper: the near and the far field are drawn apart, each in size classes of spots, so that a strong blur leaks
over nothing that is less blurred; every spot keeps the point's light exactly; like neighbours are drawn as one splat,
and wide spots at less resolution, so that the time is nearly independent of the radius.

Memory beside the fields: 16 bytes a pixel for each of both sums, the picture and a class, and 6 for plan and list. Targets
follow each other, and all but the finest have a quarter of its pixels or fewer. The spot tables of a camera take 6 MB whatever
the picture's size; of a lens with errors up to 40 MB for each resolution; and more with a squeeze below 1, 19 MB at 0.5.
"""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.focus_split import SPLIT_PX, FocusSplit
from render.postblur.scatter_splats import Points, Splats
from render.postblur.spot_cache import SpotCache

MOST_ERROR_PX = 48.0
"""Error in pixels above which a lens is drawn at less resolution altogether: it shows no fine detail."""
_EDGES = (0.0, 2.0, 6.0, SPLIT_PX)
"""Radii at which the size classes of the finest target begin and the last ends; each coarser target has one class.
Targets are half as large from `SPLIT_PX` on, a quarter from twice of it on, and so on.
"""


class ScatterBlur:
    """Blurs pictures by scattering, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs = ctx, programs
        self._splats = Splats(ctx, programs, cancellation)
        self._spots = SpotCache(ctx)

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        spot = self._spots.spot(split)
        near = Points(split.near, split.radii, 0, spot, behind=False)
        far = Points(split.far, split.radii, 1, spot, behind=True)
        picture = scope.keep(self._ctx.texture(split.size, 4, dtype="f4"))
        with Resources() as inner_scope:
            near_sum = self._sum(near, split.most_px, inner_scope)
            far_sum = self._sum(far, split.most_px, inner_scope)
            program = self._programs.compute("scatter/scatter_finish.comp")
            near.bind(program)
            for unit, (name, texture) in enumerate(
                (("far", split.far), ("near_sum", near_sum), ("far_sum", far_sum)), start=2
            ):
                texture.use(unit)
                set_uniforms(program, **{name: unit})
            self._run(program, picture, read=False)
        return picture

    def _sum(self, points: Points, most_px: float, scope: Resources) -> moderngl.Texture:
        """Sum the splats of a field, from the front to the back."""
        total = scope.keep(self._ctx.texture(points.light.size, 4, dtype="f4"))
        program = self._programs.compute("scatter/scatter_sharp.comp")
        points.bind(program)
        set_uniforms(program, is_kept=points.behind)
        self._run(program, total, read=False)
        levels = self._levels(points, most_px)
        for shrink in levels if points.behind else reversed(levels):
            with Resources() as inner_scope:
                for light in self._draw_splats(points, shrink, levels[0], inner_scope):
                    self._composite(total, light, shrink)
        return total

    def _levels(self, points: Points, most_px: float) -> list[int]:
        """Factors by which the targets are smaller, the finest first. The finest takes all points that no other one takes."""
        first = max(int(np.ceil(np.log2(max(points.spot.error_reach_px / MOST_ERROR_PX, 1e-9)))), 0)
        last = max(int(np.floor(np.log2(max(most_px / SPLIT_PX, 1e-9)))) + 1, first)
        return [1 << level for level in range(first, last + 1)]

    def _draw_splats(self, points: Points, shrink: int, finest: int, scope: Resources) -> Iterator[moderngl.Texture]:
        """Draw the splats of one resolution, size class by size class from the front; each texture is valid until the next."""
        is_finest = shrink == finest
        tables = self._spots.tables(points.spot, shrink, behind=points.behind)
        if shrink > 1:
            bounds = 0.0 if is_finest else shrink * SPLIT_PX / 2, shrink * SPLIT_PX
            points = self._reduce(points, shrink, bounds, scope)
        edges = _EDGES if is_finest else (0.0, SPLIT_PX)
        yield from self._splats.draw(points, tables, edges, scope, backward=not points.behind)

    def _reduce(self, points: Points, shrink: int, bounds: tuple[float, float], scope: Resources) -> Points:
        size = tuple(-(-side // shrink) for side in points.light.size)
        light = scope.keep(self._ctx.texture(size, 4, dtype="f4"))
        radii = scope.keep(self._ctx.texture(size, 1, dtype="f4"))
        program = self._programs.compute("scatter/scatter_reduce.comp")
        points.bind(program)
        set_uniforms(program, shrink=shrink, bounds=bounds)
        radii.bind_to_image(1, read=False, write=True)
        self._run(program, light, read=False)
        return Points(light, radii, 0, points.spot.reduce(shrink), points.behind)

    def _composite(self, total: moderngl.Texture, light: moderngl.Texture, shrink: int) -> None:
        program = self._programs.compute("scatter/scatter_composite.comp")
        light.use(0)
        set_uniforms(program, class_light=0, class_px=tuple(float(shrink * side) for side in light.size))
        self._run(program, total, read=True)

    def _run(self, program: moderngl.ComputeShader, target: moderngl.Texture, *, read: bool) -> None:
        target.bind_to_image(0, read=read, write=True)
        program.run(-(-target.width // 8), -(-target.height // 8))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Release the memory."""
        self._spots.release()
        self._splats.release()
