"""The naive gather (Moersch & Hamilton 2014, section 3.1): simple, and quadratic in the radius. The baseline of faster blurs."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape
from render.postblur.composite import BlurredPart, Compositor, Part
from render.postblur.focus_split import FocusSplit
from render.postblur.point_spread import ALL_RADII, OUTLINE_DEFINES, Field, PointSpreadPass, RadiusWindow

MAX_DISPATCH_SAMPLES = 1 << 30
"""Samples of one dispatch, about; a desktop takes a dispatch that runs for seconds for a fault."""
FIRST_DISPATCH_SAMPLES = 1 << 20
"""Samples of the first dispatch where the work may be cancelled; later ones are sized by measured time."""
_GROUP = 8  # pixels along each side of a work group


class Gather:
    """Blurs fields as `render.postblur.flag.Flag` does, pixel by pixel, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._programs, self._cancellation = ctx, programs, cancellation
        self._point_spread = PointSpreadPass(ctx, programs)
        self._piece = PieceSize(FIRST_DISPATCH_SAMPLES)

    def blur(
        self, field: Field, shape: BlurShape, most_px: float, target: moderngl.Texture, window: RadiusWindow = ALL_RADII
    ) -> None:
        """Blur a field: the light of each pixel is spread evenly over its circle of confusion, without loss.

        Args:
            field: what to blur.
            shape: shape of the blur.
            most_px: upper bound on the radii in the window.
            target: RGBA32F as large as the field: receives light and coverage.
            window: range of radii that is included.
        """
        most, across = max(1, int(np.ceil(most_px))), max(1, int(np.ceil(most_px * shape.wide)))
        program = self._programs.compute("postblur/gather.comp", OUTLINE_DEFINES)
        with Resources() as scope:
            spread = self._point_spread.run(field, shape, window, scope)
            for unit, texture in enumerate((spread.intensity, spread.radii, spread.outline)):
                texture.use(unit)
            set_uniforms(program, intensity=0, radii=1, outline=2, most=(across, most))
            shape.set_uniforms(program)
            target.bind_to_image(0, read=False, write=True)
            samples = min(2 * across + 1, target.width) * min(2 * most + 1, target.height)
            for left, top, columns, rows in self._pieces(target.width, target.height, samples):
                set_uniforms(program, first=(left, top), piece_px=(columns, rows))
                program.run(-(-columns // _GROUP), -(-rows // _GROUP))
                self._ctx.memory_barrier()
                self._ctx.finish()
                took_ms, done = self._cancellation.poll(), columns * rows * samples
                if 2 * done >= self._piece.units:  # small pieces at an edge do not predict the time of whole ones
                    self._piece.learn(done, took_ms)

    def _pieces(self, width: int, height: int, samples: int) -> Iterator[tuple[int, int, int, int]]:
        """Rectangles of the dispatches: left, top, width, height. Each is whole rows of work groups, or part of one row.

        Args:
            width: picture width in pixels.
            height: picture height in pixels.
            samples: samples of each pixel.
        """
        top = 0
        while top < height:
            most = (
                min(self._piece.units, MAX_DISPATCH_SAMPLES)
                if self._cancellation.is_cancellable
                else MAX_DISPATCH_SAMPLES
            )
            groups = max(1, most // (_GROUP * _GROUP * samples))
            across = -(-width // _GROUP)
            rows = min(max(1, groups // across) * _GROUP, height - top)
            columns = min(groups, across) * _GROUP
            for left in range(0, width, columns):
                yield left, top, min(columns, width - left), rows
            top += rows


class GatherBlur:
    """The engine `gather`: parts of a picture blurred by `Gather`, and composited as FLAG's are."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._ctx, self._compositor = ctx, Compositor(ctx, programs)
        self._gather = Gather(ctx, programs, cancellation)

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        return self._compositor.blur_parts(split, self._blur_part, scope)

    def release(self) -> None:
        """Nothing is kept between pictures."""

    def _blur_part(self, part: Part, scope: Resources) -> BlurredPart:
        fine = scope.keep(self._ctx.texture(part.field.light.size, 4, dtype="f4"))
        self._gather.blur(part.field, part.shape, part.most_px, fine, part.window)
        return BlurredPart(fine)
