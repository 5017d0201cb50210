"""The engine `flag`: both sides of the focus blurred in linear time, and joined."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.held import Held
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape, blur_shape
from render.postblur.flag import Field, Flag
from render.postblur.sides import Sides

SPLIT_PX = 24.0
"""Circles of confusion from this radius on are spread at less resolution, at which they are half as large to as large."""


class FlagBlur:
    """Blurs pictures by `Flag`, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._flag = Flag(ctx, programs)

    def blurred(self, sides: Sides, held: Held) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        shrink = 1 << max(0, int(np.ceil(np.log2(max(sides.most_px, 1e-9) / SPLIT_PX))))
        blurred = {}
        for channel, (name, light) in enumerate((("near", sides.near), ("far", sides.far))):
            shape = blur_shape(sides.iris, behind=name == "far", squeeze=sides.squeeze)
            field = Field(light, sides.radii, channel)
            blurred[name], blurred[f"{name}_wide"] = self._both(held, field, shape, sides.most_px, shrink)
        program = self._programs.compute("postblur_join.comp")
        for unit, (name, texture) in enumerate((blurred | {"far_sharp": sides.far, "radii": sides.radii}).items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        covered = [shrink * side for side in blurred["far_wide"].size]
        set_uniforms(program, is_split=shrink > 1, wide_px=tuple(covered))
        picture = held.keep(self._ctx.texture(sides.size, 4, dtype="f4"))
        picture.bind_to_image(0, read=False, write=True)
        program.run(-(-picture.width // 8), -(-picture.height // 8))
        self._ctx.memory_barrier()
        return picture

    def _both(
        self, held: Held, field: Field, shape: BlurShape, most_px: float, shrink: int
    ) -> tuple[moderngl.Texture, moderngl.Texture]:
        """A field blurred at its resolution, and what is spread wide at less; the same twice where nothing is."""
        split = SPLIT_PX if shrink > 1 else 0.0
        blurred = held.keep(self._ctx.texture(field.light.size, 4, dtype="f4"))
        self._flag.blur(field, shape, min(most_px, SPLIT_PX), blurred, split_px=split)
        if shrink == 1:
            return blurred, blurred
        reduced = self._flag.reduced(field, shrink, split)
        held.keep(reduced.light)
        held.keep(reduced.radii)
        wide = held.keep(self._ctx.texture(reduced.light.size, 4, dtype="f4"))
        wide.repeat_x = wide.repeat_y = False
        self._flag.blur(reduced, shape, most_px / shrink, wide)
        return blurred, wide

    def release(self) -> None:
        """Nothing is kept between pictures."""
