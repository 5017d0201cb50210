"""The engine `flag`: the parts of a picture blurred in linear time, and joined."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.postblur.flag import Flag
from render.postblur.joined import Blurred, Joiner, Part, parts_of
from render.postblur.sides import Sides

SPLIT_PX = 24.0
"""Circles of confusion from this radius on are spread at less resolution, at which they are half as large to as large."""


class FlagBlur:
    """Blurs pictures by `Flag`, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx = ctx
        self._flag, self._joiner = Flag(ctx, programs, cancellation), Joiner(ctx, programs)

    def blurred(self, sides: Sides, held: Resources) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        return self._joiner.joined(sides, {part.name: self._part(part, held) for part in parts_of(sides)}, held)

    def _part(self, part: Part, held: Resources) -> Blurred:
        """A part blurred at its resolution, and what of it is spread wide at less."""
        fine = held.keep(self._ctx.texture(part.field.light.size, 4, dtype="f4"))
        if part.most_px <= SPLIT_PX:
            self._flag.blur(part.field, part.shape, part.most_px, fine, part.window)
            return Blurred(fine)
        shrink = 1 << int(np.ceil(np.log2(part.most_px / SPLIT_PX)))
        between = 0.5 * SPLIT_PX, SPLIT_PX
        self._flag.blur(part.field, part.shape, SPLIT_PX, fine, replace(part.window, fall=between))
        reduced = self._flag.reduced(part.field, shrink, replace(part.window, rise=between))
        held.keep(reduced.light)
        held.keep(reduced.radii)
        wide = held.keep(self._ctx.texture(reduced.light.size, 4, dtype="f4"))
        wide.repeat_x = wide.repeat_y = False
        self._flag.blur(reduced, part.shape, part.most_px / shrink, wide)
        return Blurred(fine, wide, shrink)

    def release(self) -> None:
        """Nothing is kept between pictures."""
