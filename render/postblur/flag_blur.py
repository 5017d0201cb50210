"""The engine `flag`: parts of a picture blurred in linear time and composited."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.postblur.composite import BlurredPart, Compositor, Part, split_into_parts
from render.postblur.flag import Flag
from render.postblur.focus_split import FocusSplit

SPLIT_PX = 24.0
"""Radius from which circles of confusion are blurred at less resolution, at which they are half to all of this radius."""


class FlagBlur:
    """Blurs pictures by `Flag`, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx = ctx
        self._flag, self._compositor = Flag(ctx, programs, cancellation), Compositor(ctx, programs)

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        return self._compositor.composite(
            split, {part.name: self._blur_part(part, scope) for part in split_into_parts(split)}, scope
        )

    def _blur_part(self, part: Part, scope: Resources) -> BlurredPart:
        """Blur a part at full resolution, and its wide blurs at less."""
        fine = scope.keep(self._ctx.texture(part.field.light.size, 4, dtype="f4"))
        if part.most_px <= SPLIT_PX:
            self._flag.blur(part.field, part.shape, part.most_px, fine, part.window)
            return BlurredPart(fine)
        shrink = 1 << int(np.ceil(np.log2(part.most_px / SPLIT_PX)))
        between = 0.5 * SPLIT_PX, SPLIT_PX
        self._flag.blur(part.field, part.shape, SPLIT_PX, fine, replace(part.window, fall=between))
        reduced = self._flag.reduce(part.field, shrink, replace(part.window, rise=between))
        scope.keep(reduced.light)
        scope.keep(reduced.radii)
        wide = scope.keep(self._ctx.texture(reduced.light.size, 4, dtype="f4"))
        wide.repeat_x = wide.repeat_y = False
        self._flag.blur(reduced, part.shape, part.most_px / shrink, wide)
        return BlurredPart(fine, wide, shrink)

    def release(self) -> None:
        """Nothing is kept between pictures."""
