"""The engine ``importance``: near and far field updated from frame to frame (Fearing 1995), and composited."""

from __future__ import annotations

import moderngl

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.postblur.composite import BlurredPart, Compositor
from render.postblur.focus_split import FocusSplit
from render.postblur.importance_field import ImportanceField, UpdateStats
from render.postblur.linear import FieldSpreader, split_fields


class ImportanceBlur:
    """Blurs pictures incrementally, with the programs of one context: a frame costs what changed since the last one.

    Args:
        ctx: the context.
        programs: programs of the context.
        cancellation: polled between pieces of the work.
    """

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._cancellation, self._compositor = cancellation, Compositor(ctx, programs)
        self._fields = tuple(ImportanceField(ctx, programs, FieldSpreader(ctx, programs)) for _ in range(2))

    @property
    def stats(self) -> tuple[UpdateStats, ...]:
        """Statistics of the last update, for the near and the far field."""
        return tuple(field.stats for field in self._fields)

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """See `render.postblur.focus_split.Blur`."""
        near, far = (
            target.update(field, side, spread, split.most_px, cancellation=self._cancellation)
            for target, (field, side, spread) in zip(self._fields, split_fields(split), strict=True)
        )
        return self._compositor.composite(split, {"near": BlurredPart(near), "far": BlurredPart(far)}, scope)

    def release(self) -> None:
        """Release the memory; the next frame is spread from nothing."""
        for field in self._fields:
            field.release()
