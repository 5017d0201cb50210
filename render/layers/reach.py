"""The reach of lens rays behind peeled layers: a bound from above on the inverse depth of what they can meet there.

Every ray is a line ``s(w) = a + b·w`` on the layers with ``|b| <= pupil_px`` (`render.layers.umbra`), so that between two
inverse depths it moves by no more than ``pupil_px`` pixels for each 1/m. Clamping to the layers' picture, whose edge pixels
are repeated beyond it, only shortens the way.

A layer is a sheet over the pixels, at ``w(s)``; where it is empty, nothing is behind it. A ray starts in front of it, and is
behind it where it meets something of a later layer. Consider the last time that it came behind: from one pixel to the next,
between whose surfaces there is a gap, or through a surface that is partly transparent. At that time its ``w`` was no greater
than that of the surface it came behind. From there it has moved ``d`` pixels to ``s``, so that it is now at

    w' <= R(s) = max over all gaps g of  w(g) - d(g, s) / pupil_px

Nothing nearer than ``R(s)`` is met by a ray behind the layer, whatever the lens, its focus and its iris. The same holds behind
each layer before: the least of their bounds counts, also where a gap of a later layer is passed.

**Gaps.** The surfaces of two neighbouring pixels, each extended as a plane to their border, leave no gap where they meet there
within ``LEAST_GAP`` of the umbra (``layers/reach_gaps.comp``): segments of the tracer's walk overlap by as much, for the shortest
segment, half a pixel of the ray with the largest ``|b|``. Surfaces whose w changes over a pixel by more than the umbra, or by
too much to be extended that far, count as gaps.

**Distance.** The maximum over gaps is taken over blocks of 2x2 pixels by scans along rows and columns
(``layers/reach_spread.comp``), with ``d >= (|dx| + |dy|) / sqrt(2)``, which is too small by 29 % at most. The tracer meets a
surface up to `MEETING_PX` beside its pixel; both ends of the way, and the block's side, shorten it along either axis.

**Use.** ``layers/depth.frag`` discards what lies nearer than the bound, by more than the surface's change of w over a pixel and
the difference that the tracer takes for one surface (``UNLIKE``). What is left moves up a layer, so that fewer layers hold
more. Pictures stay the same but for rays whose walk begins elsewhere, since the N-buffers hold less.

**Strips.** Rays come into a strip of the layers from beside. One that is behind the layer at the border is behind the surface
of a pixel there, so that each of these pixels counts as a gap with that surface's ``w``.

Not bounded are layers that hold moving surfaces, where each ray is searched for along the surface's own line, and layers that are
blurred, whose hidden parts are spread too. Rays that
cross more than ``MAX_STEPS`` pixels in one interval of depths skip some, and may slip through a closed layer; they then see
what lies behind the surface that is left out.
"""

from __future__ import annotations

import math

import moderngl

from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.targets import Slot

BLOCK_PX = 2
"""Side of a block, pixels."""
MEETING_PX = 0.55
"""Greatest distance along either axis from a pixel to where a ray meets its surface: half a segment, and the overlap."""
OpenSides = tuple[bool, bool, bool, bool]
"""Whether more layers lie beyond the left, upper, right and lower side of those that are bounded."""
CLOSED: OpenSides = (False, False, False, False)
_NOWHERE = -1e30
_SPREAD_GROUP = 32  # invocations of a work group of layers/reach_spread.comp


class ReachBounder:
    """Bounds the reach of rays behind the layers of one peeling after another.

    Args:
        ctx: context of the device.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._textures: tuple[moderngl.Texture, moderngl.Texture, moderngl.Texture] | None = None

    def bound(
        self, slot: Slot, slopes: moderngl.Texture, umbra: float, *, is_first: bool, open_sides: OpenSides = CLOSED
    ) -> moderngl.Texture:
        """Bound the reach behind a layer and those before it.

        Args:
            slot: the layer, drawn.
            slopes: slopes of its pack.
            umbra: `render.layers.umbra.umbra_reach` of the rays, 1/m.
            is_first: whether it is the first layer of its peeling; otherwise the last call was for the layer before.
            open_sides: sides that rays come in through.

        Returns:
            R32F: for each block of 2x2 pixels the greatest w of what a ray may meet, 1/m. Valid until the next call.
        """
        gaps, along_rows, reach = self._allocate(-(-slot.w.width // BLOCK_PX), -(-slot.w.height // BLOCK_PX))
        defines: dict[str, int | float | str] = {"NOWHERE": _NOWHERE}
        if not is_first:
            defines["BEHIND_OTHERS"] = 1
        program = self._programs.compute("layers/reach_gaps.comp", defines)
        for unit, (name, texture) in enumerate((("w", slot.w), ("slopes", slopes), ("reach_before", reach))):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        set_uniforms(program, channel=slot.channel, umbra=umbra, open_sides=tuple(map(int, open_sides)))
        gaps.bind_to_image(0, read=False, write=True)
        program.run(-(-gaps.width // 8), -(-gaps.height // 8))
        self._ctx.memory_barrier()
        fall = umbra / math.sqrt(2)  # of each pixel along a row or column
        shortened_px = BLOCK_PX + 2 * MEETING_PX  # along either axis
        reach.bind_to_image(2, read=True, write=True)
        for source, target, columns in ((gaps, along_rows, {}), (along_rows, gaps, {"COLUMNS": 1})):
            program = self._programs.compute("layers/reach_spread.comp", defines | columns)
            set_uniforms(program, fall=BLOCK_PX * fall, room=shortened_px * fall)
            source.bind_to_image(0, read=True, write=False)
            target.bind_to_image(1, read=True, write=True)
            program.run(-(-(gaps.width if columns else gaps.height) // _SPREAD_GROUP))
            self._ctx.memory_barrier()
        return reach

    def release(self) -> None:
        """Release the memory on the device."""
        for texture in self._textures or ():
            texture.release()
        self._textures = None

    def _allocate(self, width: int, height: int) -> tuple[moderngl.Texture, moderngl.Texture, moderngl.Texture]:
        if self._textures is None or self._textures[0].size != (width, height):
            self.release()
            with Construction() as making:
                one, two, three = (making.keep(self._ctx.texture((width, height), 1, dtype="f4")) for _ in range(3))
            self._textures = one, two, three
            for texture in self._textures:
                texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return self._textures
