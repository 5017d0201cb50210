"""Importance ordering (Fearing 1995, "Importance Ordering for Real-Time Depth of Field"): a field of a picture is spread by what
has changed in it since the last one, what shows most first. The old effect of a pixel is taken from the sums of those around it,
and its new one added, so that they stay the sums that `render.postblur.linear` would make.

Fearing keeps a bitmap with each pixel of whom it did not shed on, since the decision cannot be made again once its neighbours
have changed. Here no record is needed but one: the sums are at all times those of the states that the pixels had when they were
last spread, of both who sheds and who is shed on. When a pixel's own state changes, what it hides is judged anew for all around
it. So what is taken away is what was added, whatever the order, without a bound of the distance; and the sums of all changes made
are to the bit those of the linear method, which with bitmaps they are not where something sharp has moved over what stands still.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import moderngl
import numpy as np

from render.errors import SettingsError
from render.gl.held import Held
from render.gl.pulse import UNWATCHED, PieceSize, Pulse
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.importance_order import ChangeSorter, Importance
from render.postblur.linear import HEADROOM, NO_CUTOFF, FieldSpreader
from render.postblur.shed import Field
from render.postblur.spread_tables import Spread

AFRESH_SHARE = 0.5
"""Where more of the pixels have changed than this, and all changes are wanted, all is spread afresh: that is less work."""
_LESS_LIGHT = 4  # powers of 2 that the brightest light must fall by for a finer scale
_FEW = 2048  # pixels of a first piece of the work


@dataclass(frozen=True)
class Extent:
    """How much of what has changed is made.

    Attributes:
        share: of the pixels, Fearing's M: above 0, at most 1.
        budget_ms: time after which no more is begun; None for no end. At least one piece is made.

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
    """What the last update did.

    Attributes:
        changed: pixels that had changed.
        made: how many of them were spread anew.
        was_afresh: whether all of the field was, from nothing.
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
        self._held = Held()
        self._is_whole = False  # whether the sums are those of what was taken last
        self._side = 0.0
        self._scale = 0
        self._piece = PieceSize(_FEW)
        self.done = Done(0, 0, False)

    def update(
        self,
        field: Field,
        side: float,
        spread: Spread,
        most_px: float,
        extent: Extent = ALL,
        pulse: Pulse = UNWATCHED,
    ) -> moderngl.Texture:
        """Spread what has changed.

        Args:
            field: the picture's. One of another size begins anew, and the first of a size is made whole.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            spread: how light is distributed over a circle of confusion. Another one begins anew.
            most_px: no radius is larger.
            extent: how much of the changes to make; what is left waits, and grows in importance.
            pulse: that beats between pieces of the work. What was done until it was interrupted stays done.

        Returns:
            RGBA32F: the sum of weighted light, and that of weights; valid until the next one.

        Raises:
            Interrupted: the work is stale.
        """
        made = self._spreader
        if made.fit(field.light.size):
            self._make_room()
        is_other = made.tabled(spread, most_px)
        scale = made.scale(field)
        if is_other or side != self._side or not scale - HEADROOM <= self._scale <= scale + _LESS_LIGHT:
            self._is_whole, self._side, self._scale = False, side, scale
        made.take(field, side, self._scale)
        if not self._is_whole:
            self._spread_afresh(pulse, made.size[0] * made.size[1])
            return made.shown
        firsts = self._sorter.sort(self._light, self._state)
        changed = firsts[-1]
        if extent.is_all and changed > AFRESH_SHARE * made.size[0] * made.size[1]:
            self._spread_afresh(pulse, changed)
            return made.shown
        done = 0
        for first, end in self._pieces(changed, extent, pulse):
            self._spread_pixels(first, end)
            done = end
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
        keep, size = self._held.keep, self._spreader.size
        pixels, tiles = size[0] * size[1], self._spreader.tiles[0] * self._spreader.tiles[1]
        self._light = keep(self._ctx.texture(size, 4, dtype="f4"))  # those of the sums
        self._state, self._before = (keep(self._ctx.texture(size, 2, dtype="f4")) for _ in range(2))
        self._sums = keep(self._ctx.buffer(reserve=32 * pixels))
        self._picked, self._reaches = (keep(self._ctx.buffer(reserve=bytes_ * tiles)) for bytes_ in (8, 4))
        self._reached, self._judged = (keep(self._ctx.buffer(reserve=4 * tiles)) for _ in range(2))
        self._listed = keep(self._ctx.buffer(reserve=4 * (tiles + 1)))
        self._sorter = ChangeSorter(self._ctx, self._programs, self._spreader, self._held, self._importance)

    def _spread_afresh(self, pulse: Pulse, changed: int) -> None:
        made = self._spreader
        self._is_whole = False
        made.spread_all(self._sums, pulse)
        made.light, self._light = self._light, made.light
        made.state, self._state = self._state, made.state
        self._sorter.forget()
        self._is_whole = True
        self.done = Done(changed, changed, True)

    def _pieces(self, changed: int, extent: Extent, pulse: Pulse) -> Iterator[tuple[int, int]]:
        """Stretches of the order, as long as there is time."""
        wanted = int(np.ceil(extent.share * changed))
        if extent.budget_ms is None and not pulse.is_watched:
            if wanted:
                yield 0, wanted
            return
        began, first = perf_counter(), 0
        while first < wanted:
            piece_began, end = perf_counter(), min(first + self._piece.units, wanted)
            yield first, end
            self._ctx.finish()
            self._piece.learn(end - first, 1000 * (perf_counter() - piece_began))
            pulse.beat()
            if extent.budget_ms is not None and 1000 * (perf_counter() - began) >= extent.budget_ms:
                return
            first = end

    def _spread_pixels(self, first: int, end: int) -> None:
        """Take the old effects of some pixels of the order from the sums, and add their new ones."""
        made = self._spreader
        self._pick(first, end)
        states = {
            "light_now": made.light,
            "state_now": made.state,
            "light_last": self._light,
            "state_last": self._state,
        }
        reach = self._program("reach")
        made.bound(reach, **states, table_reaches=made.made_tables.reaches)
        made.bind_tiles(reach, self._picked, self._reaches)
        for unit, marks in ((3, self._reached), (4, self._judged)):
            marks.clear()
            marks.bind_to_storage_buffer(unit)
        made.run(reach, made.tiles)
        listed = self._list(self._reached)
        spread = self._programs.compute(
            "linear_spread.comp", {"ROWS": made.rows, "KEEP": 1, "LISTED": 1, "DIFFERENCE": 1}
        )
        made.bound(spread, **states, weights=made.made_tables.weights)
        made.bind_tiles(spread, self._picked, self._reaches)
        self._run_listed(spread, listed)
        self._settle()
        if made.cutoff_px < NO_CUTOFF:
            self._rejudge()

    def _pick(self, first: int, end: int) -> None:
        program = self._program("pick")
        self._picked.clear()
        self._picked.bind_to_storage_buffer(1)
        self._sorter.order.bind_to_storage_buffer(5)
        set_uniforms(program, first=first, end=end, width=self._spreader.size[0], tiles_across=self._spreader.tiles[0])
        groups = -(-(end - first) // 64)
        program.run(min(groups, 1024), -(-groups // 1024))
        self._ctx.memory_barrier()

    def _settle(self) -> None:
        """Take note that the picked pixels are spread as they are now."""
        made, program = self._spreader, self._program("settle")
        made.bound(program, light_now=made.light, state_now=made.state, table_reaches=made.made_tables.reaches)
        for unit, image in enumerate((self._light, self._state, self._before, self._sorter.waiting)):
            image.bind_to_image(unit, read=unit < 2, write=True)
        set_uniforms(program, tiles=made.tiles)
        for unit, buffer in enumerate((self._picked, made.masks, made.reaches), start=1):
            buffer.bind_to_storage_buffer(unit)
        made.run(program, made.tiles)

    def _rejudge(self) -> None:
        """Judge anew what is hidden by pixels whose own state has changed."""
        made = self._spreader
        listed = self._list(self._judged)
        program = self._programs.compute(
            "linear_spread.comp", {"ROWS": made.rows, "KEEP": 1, "LISTED": 1, "REJUDGE": 1}
        )
        made.bound(
            program,
            light_now=self._light,
            state_now=self._state,
            state_before=self._before,
            weights=made.made_tables.weights,
        )
        made.bind_tiles(program, made.masks, made.reaches)
        self._run_listed(program, listed)

    def _list(self, marks: moderngl.Buffer) -> int:
        """List the tiles that are marked; how many there are."""
        program = self._program("list")
        self._listed.write(b"\0\0\0\0")
        self._listed.bind_to_storage_buffer(3)
        marks.bind_to_storage_buffer(4)
        count = self._spreader.tiles[0] * self._spreader.tiles[1]
        set_uniforms(program, count=count)
        program.run(-(-count // 64))
        self._ctx.memory_barrier()
        return int(np.frombuffer(self._listed.read(4), np.uint32)[0])

    def _run_listed(self, program: moderngl.ComputeShader, count: int) -> None:
        if count == 0:
            return
        self._listed.bind_to_storage_buffer(3)
        self._sums.bind_to_storage_buffer(0)
        self._spreader.bind_tables(program)
        program.run(min(count, 1024), -(-count // 1024))
        self._ctx.memory_barrier()

    def _program(self, name: str) -> moderngl.ComputeShader:
        return self._programs.compute(f"importance_{name}.comp")
