"""The order that changes of a picture are made in: by importance (Fearing 1995, section 4.3), by a counting sort on the
device."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import SettingsError
from render.gl.held import Held
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.linear import FieldSpreader

BUCKETS = 64
_CHUNK = 1024  # pixels that a group sorts


@dataclass(frozen=True)
class Importance:
    """What makes a change important: h = coc_weight · Δcoc + rgb_weight · Δrgb.

    Attributes:
        coc_weight: of a pixel of radius of the circle of confusion.
        rgb_weight: of a unit of colour distance.
        is_perceptual: take distances in Oklab in place of those of light.

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
    """Finds what has changed in a field, and sorts it. Of the size that its spreader has.

    Attributes:
        waiting: of each pixel its bucket, 0 for no change, and how long it has waited.
        order: numbers of the pixels that have changed, the most important first.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, spreader: FieldSpreader, held: Held, importance: Importance
    ) -> None:
        self._programs, self._spreader, self._importance = programs, spreader, importance
        width, height = spreader.size
        self._chunks = -(-width * height // _CHUNK)
        self.waiting = held.keep(ctx.texture((width, height), 1, dtype="u4"))
        self.order = held.keep(ctx.buffer(reserve=4 * _CHUNK * self._chunks))
        self._counts = held.keep(ctx.buffer(reserve=4 * BUCKETS * self._chunks))
        self._firsts = held.keep(ctx.buffer(reserve=4 * BUCKETS))
        self._ctx = ctx
        self.forget()

    def forget(self) -> None:
        """Let nothing wait."""
        width, height = self._spreader.size
        self.waiting.write(bytes(4 * width * height))

    def sort(self, light_last: moderngl.Texture, state_last: moderngl.Texture) -> list[int]:
        """Sort what differs from what the sums were made of.

        Returns:
            Where the buckets begin in `order`, from the most important to the least, and how many pixels there are in all.
        """
        made = self._spreader
        compare, scan, sort = (
            self._programs.compute(f"importance_{name}.comp") for name in ("compare", "scan", "sort")
        )
        made.bound(compare, light_now=made.light, state_now=made.state, light_last=light_last, state_last=state_last)
        weights = self._importance
        set_uniforms(compare, coc_weight=weights.coc_weight, rgb_weight=weights.rgb_weight)
        set_uniforms(compare, is_perceptual=weights.is_perceptual)
        self.waiting.bind_to_image(0, read=True, write=True)
        self.order.bind_to_storage_buffer(5)
        self._counts.bind_to_storage_buffer(6)
        self._firsts.bind_to_storage_buffer(7)
        for program, groups in ((compare, self._chunks), (scan, 1), (sort, self._chunks)):
            set_uniforms(program, chunks=self._chunks)
            program.run(groups)
            self._ctx.memory_barrier()
        return [int(first) for first in np.frombuffer(self._firsts.read(), np.uint32)]
