"""The naive gather: simple, right, and quadratic in the radius. It is what faster blurs of the same sides are held to."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.held import Held
from render.gl.pulse import UNWATCHED, Pulse
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape
from render.postblur.joined import Blurred, Joiner, Part, parts_of
from render.postblur.shed import EVERYTHING, OUTLINE_DEFINES, Field, Shedder, Window
from render.postblur.sides import Sides

LOOKS_AT_ONCE = 1 << 30
"""Pixels that are looked at by one command to the device, about; a desktop takes one that runs for seconds for a fault."""
WATCHED_LOOKS = 1 << 20
"""While somebody may call the work off."""


class Gather:
    """Blurs fields as `render.postblur.flag.Flag` does, point by point, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, pulse: Pulse = UNWATCHED) -> None:
        self._ctx, self._programs, self._pulse = ctx, programs, pulse
        self._shedder = Shedder(ctx, programs)

    def blur(
        self, field: Field, shape: BlurShape, most_px: float, target: moderngl.Texture, window: Window = EVERYTHING
    ) -> None:
        """Blur a field: each of its points is spread evenly over its circle of confusion, and loses nothing.

        Args:
            field: what to blur.
            shape: of the blur.
            most_px: no radius in the window is larger.
            target: RGBA32F as large as the field: its light, and how much there is of it.
            window: the light that is meant.
        """
        width, height = field.light.size
        most = max(1, int(np.ceil(most_px)))
        looks = WATCHED_LOOKS if self._pulse.is_watched else LOOKS_AT_ONCE
        rows = max(8, looks // (width * (2 * most + 1) ** 2) // 8 * 8)
        program = self._programs.compute("gather.comp", OUTLINE_DEFINES)
        with Held() as held:
            shed = self._shedder.shed(field, shape, most, window, held)
            for unit, texture in enumerate((shed.light, shed.reach, shed.outline)):
                texture.use(unit)
            set_uniforms(program, shed=0, reach=1, outline=2, most=most)
            target.bind_to_image(0, read=False, write=True)
            for first in range(0, height, rows):
                set_uniforms(program, first_row=first, rows=rows)
                program.run(-(-width // 8), -(-min(rows, height - first) // 8))
                self._ctx.finish()
                self._pulse.beat()


class GatherBlur:
    """The engine `gather`: the parts of a picture blurred by `Gather`, and joined as FLAG's are."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, pulse: Pulse = UNWATCHED) -> None:
        self._ctx = ctx
        self._gather, self._joiner = Gather(ctx, programs, pulse), Joiner(ctx, programs)

    def blurred(self, sides: Sides, held: Held) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        return self._joiner.joined(sides, {part.name: self._part(part, held) for part in parts_of(sides)}, held)

    def _part(self, part: Part, held: Held) -> Blurred:
        fine = held.keep(self._ctx.texture(part.field.light.size, 4, dtype="f4"))
        self._gather.blur(part.field, part.shape, part.most_px, fine, part.window)
        return Blurred(fine)

    def release(self) -> None:
        """Nothing is kept between pictures."""
