"""The engine `flag`: parts of a picture blurred in linear time and composited."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.postblur.composite import BlurredPart, Compositor, Part
from render.postblur.flag import Flag
from render.postblur.focus_split import SPLIT_PX, FocusSplit


class FlagBlur:
    """Blurs pictures by `Flag`, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._compositor = ctx, Compositor(ctx, programs)
        self._flag = Flag(ctx, programs, cancellation)

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        return self._compositor.blur_parts(split, self._blur_part, scope)

    def release(self) -> None:
        """Nothing is kept between pictures."""

    def _blur_part(self, part: Part, scope: Resources) -> BlurredPart:
        """Blur a part at full resolution, and its blurs wider than `SPLIT_PX` at less, at which they are half to all of it."""
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
