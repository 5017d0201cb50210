"""The engine ``importance``: both sides of the focus kept spread from frame to frame (Fearing 1995), and joined."""

from __future__ import annotations

import moderngl

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.postblur.importance_field import ALL, Done, Extent, ImportanceField
from render.postblur.importance_order import Importance
from render.postblur.joined import Blurred, Joiner
from render.postblur.linear import FieldSpreader, fields_of
from render.postblur.sides import Sides


class ImportanceBlur:
    """Keeps what it has spread, with the programs of one context: a frame costs what has changed since the one before.

    Args:
        ctx: the context.
        programs: of it.
        cancellation: that beats between pieces of the work.
        importance: what makes a change important.

    Attributes:
        extent: how much of the changes to make; all of them makes the picture of the engine ``linear``.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        cancellation: CancellationPoint = NEVER_CANCELLED,
        importance: Importance = Importance(),  # noqa: B008 - it is frozen
    ) -> None:
        self._cancellation, self._joiner = cancellation, Joiner(ctx, programs)
        self.extent: Extent = ALL
        self._fields = tuple(ImportanceField(ctx, programs, FieldSpreader(ctx, programs), importance) for _ in range(2))

    @property
    def done(self) -> tuple[Done, ...]:
        """Statistics of the last update, for the near and the far field."""
        return tuple(field.done for field in self._fields)

    def blurred(self, sides: Sides, held: Resources) -> moderngl.Texture:
        """As `render.postblur.sides.Blur` has it."""
        near, far = (
            made.update(field, side, spread, sides.most_px, self.extent, self._cancellation)
            for made, (field, side, spread) in zip(self._fields, fields_of(sides), strict=True)
        )
        return self._joiner.joined(sides, {"near": Blurred(near), "far": Blurred(far)}, held)

    def release(self) -> None:
        """Give the memory back; the next frame begins anew."""
        for field in self._fields:
            field.release()
