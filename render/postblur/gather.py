"""The naive gather: simple, right, and quadratic in the radius. It is what faster blurs of the same sides are held to."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape
from render.postblur.joined import Blurred, Joiner, Part, parts_of
from render.postblur.shed import EVERYTHING, OUTLINE_DEFINES, Field, Shedder, Window
from render.postblur.sides import Sides

LOOKS_AT_ONCE = 1 << 30
"""Pixels that are looked at by one command to the device, about; a desktop takes one that runs for seconds for a fault."""
FIRST_LOOKS = 1 << 20
"""By the first one, while somebody may call the work off; how many later ones have is learnt."""
_GROUP = 8  # pixels along each side that are worked on together


class Gather:
    """Blurs fields as `render.postblur.flag.Flag` does, point by point, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._shedder = Shedder(ctx, programs)
        self._looks = PieceSize(FIRST_LOOKS)

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
        most = max(1, int(np.ceil(most_px)))
        program = self._programs.compute("postblur/gather.comp", OUTLINE_DEFINES)
        with Resources() as held:
            shed = self._shedder.shed(field, shape, most, window, held)
            for unit, texture in enumerate((shed.light, shed.reach, shed.outline)):
                texture.use(unit)
            set_uniforms(program, shed=0, reach=1, outline=2, most=most)
            target.bind_to_image(0, read=False, write=True)
            for left, top, columns, rows in self._pieces(target.width, target.height, (2 * most + 1) ** 2):
                set_uniforms(program, first=(left, top), piece_px=(columns, rows))
                program.run(-(-columns // _GROUP), -(-rows // _GROUP))
                self._ctx.finish()
                took_ms, looks = self._cancellation.poll(), columns * rows * (2 * most + 1) ** 2
                if 2 * looks >= self._looks.units:  # what is left at an edge says nothing of whole pieces
                    self._looks.learn(looks, took_ms)

    def _pieces(self, width: int, height: int, looks: int) -> Iterator[tuple[int, int, int, int]]:
        """Left, top, width and height of what is done by one command: whole rows of groups, or some groups of one row.

        Args:
            width: of the picture in pixels.
            height: likewise.
            looks: of each pixel.
        """
        top = 0
        while top < height:
            most = min(self._looks.units, LOOKS_AT_ONCE) if self._cancellation.is_cancellable else LOOKS_AT_ONCE
            groups = max(1, most // (_GROUP * _GROUP * looks))
            across = -(-width // _GROUP)
            rows = min(max(1, groups // across) * _GROUP, height - top)
            columns = min(groups, across) * _GROUP
            for left in range(0, width, columns):
                yield left, top, min(columns, width - left), rows
            top += rows


class GatherBlur:
    """The engine `gather`: the parts of a picture blurred by `Gather`, and joined as FLAG's are."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx = ctx
        self._gather, self._joiner = Gather(ctx, programs, cancellation), Joiner(ctx, programs)

    def blurred(self, sides: Sides, held: Resources) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        return self._joiner.joined(sides, {part.name: self._part(part, held) for part in parts_of(sides)}, held)

    def _part(self, part: Part, held: Resources) -> Blurred:
        fine = held.keep(self._ctx.texture(part.field.light.size, 4, dtype="f4"))
        self._gather.blur(part.field, part.shape, part.most_px, fine, part.window)
        return Blurred(fine)

    def release(self) -> None:
        """Nothing is kept between pictures."""
