"""Order of the changes of a picture: by importance (Fearing 1995, section 4.3), by a counting sort on the device."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl

from render.errors import SettingsError
from render.gl.limits import make_storage
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.linear import LANES, FieldSpreader

BUCKETS = 64


@dataclass(frozen=True)
class Importance:
    """Importance of a change: h = coc_weight · Δcoc + rgb_weight · Δrgb (Fearing 1995, section 4).

    Attributes:
        coc_weight: weight of one pixel of circle-of-confusion radius.
        rgb_weight: weight of one unit of colour distance.
        is_perceptual: measure colour distance in Oklab instead of linear light.

    Raises:
        SettingsError: a weight is below 0.
    """

    coc_weight: float = 0.5
    rgb_weight: float = 0.5
    is_perceptual: bool = False

    def __post_init__(self) -> None:
        for name, weight in (("coc_weight", self.coc_weight), ("rgb_weight", self.rgb_weight)):
            if not 0 <= weight < float("inf"):
                raise SettingsError(f"{name} must be 0 or more, got {weight}")


class ChangeSorter:
    """Sorts the changed pixels of a field by importance. Its size is that of its spreader.

    Attributes:
        waiting: bucket of each pixel, 0 for no change, and for how many pictures it has waited.
        order: changed pixels, the most important first.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        spreader: FieldSpreader,
        scope: Resources,
        importance: Importance,
    ) -> None:
        self._ctx, self._programs, self._spreader, self._importance = ctx, programs, spreader, importance
        self._chunks = -(-spreader.half_tiles // LANES)
        self.waiting = scope.keep(ctx.texture(spreader.size, 1, dtype="u4"))
        self.order = scope.keep(make_storage(ctx, 4 * 32 * LANES * self._chunks, "the order of changes"))
        self._counts = scope.keep(ctx.buffer(reserve=4 * BUCKETS * self._chunks))
        self.clear()

    def clear(self) -> None:
        """Clear all waiting changes."""
        width, height = self._spreader.size
        self.waiting.write(bytes(4 * width * height))

    def bind(self, program: moderngl.ComputeShader) -> None:
        """Bind the counts of the buckets to a variant of linear/linear_load.comp."""
        weights = self._importance
        set_uniforms(program, coc_weight=weights.coc_weight, rgb_weight=weights.rgb_weight, chunks=self._chunks)
        set_uniforms(program, is_perceptual=weights.is_perceptual)
        self.waiting.bind_to_image(2, read=True, write=True)
        self._counts.bind_to_storage_buffer(6)

    def sort(self) -> None:
        """Sort the counted changes."""
        scan, sort = (self._programs.compute(f"importance/importance_{name}.comp") for name in ("scan", "sort"))
        self._counts.bind_to_storage_buffer(6)
        set_uniforms(scan, chunks=self._chunks)
        scan.run(1)
        self._ctx.memory_barrier()
        self.waiting.bind_to_image(2, read=True, write=False)
        self.order.bind_to_storage_buffer(5)
        set_uniforms(sort, chunks=self._chunks, tiles=self._spreader.tiles)
        sort.run(self._chunks)
        self._ctx.memory_barrier()
