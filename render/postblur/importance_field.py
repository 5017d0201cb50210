"""Importance ordering (Fearing 1995, "Importance Ordering for Real-Time Depth of Field"): a field of a picture is spread by what
has changed in it since the last one, what shows most first. The old effect of a pixel is taken from the sums of those around it,
and its new one added, so that they stay the sums that `render.postblur.linear` would make.

Fearing keeps a bitmap with each pixel of whom it did not shed on, since the decision cannot be made again once its neighbours
have changed. Here no record is needed but one: the sums are at all times those of the states that the pixels had when they were
last spread, of both who sheds and who is shed on. When a pixel's own state changes, what it hides is judged anew for all around
it. So what is taken away is what was added, whatever the order, without a bound of the distance; and the sums of all changes made
are to the bit those of the linear method, which with bitmaps they are not where something sharp has moved over what stands still.

Kept for each pixel are 112 bytes: twice its light and three times its state, its sums and what they show, its place in the order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import moderngl
import numpy as np

from render.errors import SettingsError
from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.importance_order import ChangeSorter, Importance
from render.postblur.linear import LANES, FieldSpreader
from render.postblur.shed import Field
from render.postblur.spread_tables import Spread

AFRESH_SHARE = 0.5
"""Where more of the pixels have changed than this, and all changes are wanted, all is spread afresh: that is less work."""
_FEW = 2048  # pixels of a first piece of the work


@dataclass(frozen=True)
class Extent:
    """Limit on the changes that one update spreads.

    Attributes:
        share: share of the pixels, Fearing's M: above 0, at most 1.
        budget_ms: time after which no further piece is begun; None for no limit. At least one piece is spread.

    Raises:
        SettingsError: one is out of range.
    """

    share: float = 1.0
    budget_ms: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.share <= 1:
            raise SettingsError(f"the share of changes to be made must be above 0 and at most 1, got {self.share}")
        if self.budget_ms is not None and not self.budget_ms >= 0:
            raise SettingsError(f"budget_ms must be 0 or more, got {self.budget_ms}")

    @property
    def is_all(self) -> bool:
        """Whether it is all that has changed."""
        return self.share == 1 and self.budget_ms is None


ALL = Extent()


@dataclass(frozen=True)
class Done:
    """Statistics of one update.

    Attributes:
        changed: number of pixels that had changed.
        made: number of them that were spread again.
        was_afresh: whether the whole field was spread from nothing.
    """

    changed: int
    made: int
    was_afresh: bool


class ImportanceField:
    """Keeps a field spread from picture to picture.

    Args:
        ctx: the context.
        programs: of it.
        spreader: of its own.
        importance: what makes a change important.

    Attributes:
        done: what the last update did.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        spreader: FieldSpreader,
        importance: Importance = Importance(),  # noqa: B008 - it is frozen
    ) -> None:
        self._ctx, self._programs, self._spreader, self._importance = ctx, programs, spreader, importance
        self._held = Resources()
        self._is_whole = False  # whether the sums are those of what was taken last
        self._side = 0.0
        self._is_ordered = False
        self._may_wait = False  # whether any change waits
        self._piece = PieceSize(_FEW)
        self.done = Done(0, 0, False)

    def update(
        self,
        field: Field,
        side: float,
        spread: Spread,
        most_px: float,
        extent: Extent = ALL,
        cancellation: CancellationPoint = NEVER_CANCELLED,
    ) -> moderngl.Texture:
        """Spread what has changed.

        Args:
            field: the picture's. One of another size begins anew, and the first of a size is made whole.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            spread: how light is distributed over a circle of confusion. Another one begins anew.
            most_px: no radius is larger.
            extent: how much of the changes to make; what is left waits, and grows in importance.
            cancellation: that beats between pieces of the work. What was done until it was interrupted stays done.

        Returns:
            RGBA32F: the sum of weighted light, and that of weights; valid until the next one.

        Raises:
            Cancelled: the work is stale.
        """
        made = self._spreader
        if made.fit(field.light.size):
            self._make_room()
        if made.tabled(spread, most_px) or side != self._side:
            self._is_whole, self._side = False, side
        pixels = made.size[0] * made.size[1]
        changed = (
            self._compared(field, is_ordered=not extent.is_all or cancellation.is_cancellable)
            if self._is_whole
            else None
        )
        if changed is None or (extent.is_all and changed > AFRESH_SHARE * pixels):
            self._spread_afresh(field, cancellation, pixels if changed is None else changed)
            return made.shown
        done = 0
        for first, end in self._pieces(changed, extent, cancellation):
            self._spread_changes(first, end)
            done = end
        self._may_wait = self._may_wait and done < changed
        self.done = Done(changed, done, False)
        return made.shown

    def release(self) -> None:
        """Give the memory back; the next field begins anew."""
        self._held.close()
        self._is_whole = False
        self._spreader.release()

    def _make_room(self) -> None:
        self._held.close()
        self._is_whole = False
        keep, made = self._held.keep, self._spreader
        self._light = keep(self._ctx.texture(made.size, 4, dtype="f4"))  # those of the sums
        self._state, self._before = (keep(self._ctx.texture(made.size, 2, dtype="f4")) for _ in range(2))
        self._sums = keep(self._ctx.buffer(reserve=32 * made.size[0] * made.size[1]))
        self._changes, self._reaches, self._picked = (
            keep(self._ctx.buffer(reserve=size * made.half_tiles)) for size in (16, 4, 4)
        )
        self._buffers = self._changes, self._reaches, keep(made.bits_of_tiles())
        tiles = made.half_tiles // 2
        self._reached, self._judged = (keep(self._ctx.buffer(reserve=4 * tiles)) for _ in range(2))
        self._listed = keep(self._ctx.buffer(reserve=4 * (tiles + 1)))
        self._sorter = ChangeSorter(self._ctx, self._programs, made, self._held, self._importance)

    def _compared(self, field: Field, *, is_ordered: bool) -> int | None:
        """Take a field, and find what has changed in it: how many pixels; None where it is to be spread afresh."""
        program = self._programs.compute(
            "linear/linear_take.comp", {"COMPARE": 1} | ({"ORDERED": 1} if is_ordered else {})
        )
        self._is_ordered = is_ordered
        self._may_wait = self._may_wait or is_ordered
        if is_ordered:
            self._sorter.bind(program)
        fits, changed = self._spreader.run_take(
            program, field, self._side, self._buffers, light_last=self._light, state_last=self._state
        )
        if is_ordered and fits and changed:
            self._sorter.sort()
        return changed if fits else None

    def _spread_afresh(self, field: Field, cancellation: CancellationPoint, changed: int) -> None:
        made = self._spreader
        self._is_whole = False
        made.take(field, self._side)
        made.spread_all(self._sums, cancellation)
        made.light, self._light = self._light, made.light
        made.state, self._state = self._state, made.state
        self._sorter.forget()
        self._is_whole, self._may_wait = True, False
        self.done = Done(changed, changed, True)

    def _pieces(self, changed: int, extent: Extent, cancellation: CancellationPoint) -> Iterator[tuple[int, int]]:
        """Stretches of the order, as long as there is time."""
        wanted = int(np.ceil(extent.share * changed))
        if extent.budget_ms is None and not cancellation.is_cancellable:
            if wanted:
                yield 0, wanted
            return
        began, first = perf_counter(), 0
        while first < wanted:
            piece_began, end = perf_counter(), min(first + self._piece.units, wanted)
            yield first, end
            self._ctx.finish()
            self._piece.learn(end - first, 1000 * (perf_counter() - piece_began))
            cancellation.poll()
            if extent.budget_ms is not None and 1000 * (perf_counter() - began) >= extent.budget_ms:
                return
            first = end

    def _spread_changes(self, first: int, end: int) -> None:
        """Take the old effects of some pixels of the order from the sums, and add their new ones; of all without an order."""
        made = self._spreader
        if self._is_ordered:
            self._pick(first, end)
        states = {
            "light_now": made.light,
            "state_now": made.state,
            "light_last": self._light,
            "state_last": self._state,
        }
        mark = self._programs.compute("importance/importance_mark.comp", self._picking)
        made.bound(mark, **states)
        set_uniforms(mark, has_cutoff=made.has_cutoff)
        for unit, marks in ((3, self._reached), (4, self._judged)):
            marks.clear()
            marks.bind_to_storage_buffer(unit)
        for unit, buffer in ((1, self._changes), (2, self._reaches), (5, self._picked)):
            buffer.bind_to_storage_buffer(unit)
        made.run_half_tiles(mark)
        listed = self._list(self._reached)
        spread = made.spreading(KEEP=1, LISTED=1, DIFFERENCE=1, **self._picking)
        made.bound(spread, **states, weights=made.tables.weights)
        made.bind_spread(spread, self._buffers)
        self._picked.bind_to_storage_buffer(5)
        self._run_listed(spread, listed)
        self._settle()
        if made.has_cutoff:
            self._rejudge()

    @property
    def _picking(self) -> dict[str, int]:
        return {"PICKED": 1} if self._is_ordered else {}

    def _pick(self, first: int, end: int) -> None:
        program = self._programs.compute("importance/importance_pick.comp")
        self._picked.clear()
        self._picked.bind_to_storage_buffer(5)
        self._sorter.order.bind_to_storage_buffer(6)
        set_uniforms(program, first=first, end=end)
        groups = -(-(end - first) // LANES)
        program.run(min(groups, 1024), -(-groups // 1024))
        self._ctx.memory_barrier()

    def _settle(self) -> None:
        """Take note that the picked pixels are spread as they are now."""
        made = self._spreader
        defines = (
            self._picking | ({"CUTOFF": 1} if made.has_cutoff else {}) | ({"WAITING": 1} if self._may_wait else {})
        )
        program = self._programs.compute("importance/importance_settle.comp", defines)
        made.bound(program, light_now=made.light, state_now=made.state)
        set_uniforms(program, beyond_px=made.tables.beyond_px)
        for unit, image in enumerate((self._light, self._state, self._before, self._sorter.waiting)):
            image.bind_to_image(unit, read=unit < 2, write=True)
        for unit, buffer in (
            (1, self._changes),
            (2, made.shedding),
            (3, made.reaches),
            (4, made.filled),
            (5, self._picked),
        ):
            buffer.bind_to_storage_buffer(unit)
        made.run_half_tiles(program)

    def _rejudge(self) -> None:
        """Judge anew what is hidden by pixels whose own state has changed."""
        made = self._spreader
        listed = self._list(self._judged)
        program = made.spreading(KEEP=1, LISTED=1, REJUDGE=1)
        made.bound(
            program,
            light_now=self._light,
            state_now=self._state,
            state_before=self._before,
            weights=made.tables.weights,
        )
        made.bind_spread(program, (made.shedding, made.reaches, made.filled))
        self._run_listed(program, listed)

    def _list(self, marks: moderngl.Buffer) -> int:
        """List the tiles that are marked; how many there are."""
        program = self._programs.compute("importance/importance_list.comp")
        self._listed.write(bytes(4))
        self._listed.bind_to_storage_buffer(3)
        marks.bind_to_storage_buffer(4)
        count = self._spreader.half_tiles // 2
        set_uniforms(program, count=count)
        program.run(-(-count // LANES))
        self._ctx.memory_barrier()
        return int(np.frombuffer(self._listed.read(4), np.uint32)[0])

    def _run_listed(self, program: moderngl.ComputeShader, count: int) -> None:
        if count == 0:
            return
        self._listed.bind_to_storage_buffer(3)
        self._sums.bind_to_storage_buffer(0)
        program.run(min(count, 1024), -(-count // 1024))
        self._ctx.memory_barrier()
