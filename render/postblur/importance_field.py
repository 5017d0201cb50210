"""Importance ordering (Fearing 1995, "Importance Ordering for Real-Time Depth of Field"): incremental blur of a field.

A field is updated by the pixels that changed since the last picture, the most visible first. The old effect of a pixel
is subtracted from the sums around it and its new effect is added, so that the sums stay those of
`render.postblur.linear`.

Fearing keeps for each pixel a bitmap of the neighbours it did not spread to, since that decision cannot be repeated
once the neighbours have changed. Here the sums always belong to the states that the pixels had when they were last
spread, both those of the pixel that spreads and of the pixel that receives. When a pixel's own state changes, all that
it hides is tested again. So exactly what was added is subtracted, in any order and at any distance; and once all
changes are spread, the sums equal those of the linear method to the bit. With bitmaps they do not, where something
sharp has moved over something still.

Memory per pixel is 112 bytes: twice its light, three times its state, its sums and their picture, its place in the
order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import moderngl
import numpy as np

from render.errors import SettingsError
from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint, PieceSize
from render.gl.limits import make_storage
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.importance_order import ChangeSorter, Importance
from render.postblur.linear import LANES, FieldSpreader
from render.postblur.point_spread import Field
from render.postblur.spread_tables import Spread

RESPREAD_SHARE = 0.5
"""Share of changed pixels above which, without a limit, the whole field is spread from nothing, which is less work."""
_FEW = 2048  # pixels of the first piece


@dataclass(frozen=True)
class UpdateLimit:
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
            raise SettingsError(f"the share of changes to be spread must be above 0 and at most 1, got {self.share}")
        if self.budget_ms is not None and not self.budget_ms >= 0:
            raise SettingsError(f"budget_ms must be 0 or more, got {self.budget_ms}")

    @property
    def is_unlimited(self) -> bool:
        """Whether all changes are spread."""
        return self.share == 1 and self.budget_ms is None


UNLIMITED = UpdateLimit()


@dataclass(frozen=True)
class UpdateStats:
    """Statistics of one update.

    Attributes:
        changed: number of pixels that had changed.
        spread: number of them that were spread again.
        from_scratch: whether the whole field was spread from nothing.
    """

    changed: int
    spread: int
    from_scratch: bool


class ImportanceField:
    """A field that is kept spread from picture to picture.

    Args:
        ctx: the context.
        programs: programs of the context.
        spreader: spreader that no other field uses.
        importance: weights of the importance of a change.

    Attributes:
        stats: statistics of the last update.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        programs: ProgramCache,
        spreader: FieldSpreader,
        importance: Importance = Importance(),  # noqa: B008 - it is frozen
    ) -> None:
        self._ctx, self._programs, self._spreader, self._importance = ctx, programs, spreader, importance
        self._resources = Resources()
        self._is_whole = False  # whether the sums hold the whole field
        self._side = 0.0
        self._is_ordered = False
        self._may_wait = False  # whether a change may be waiting
        self._piece = PieceSize(_FEW)
        self.stats = UpdateStats(0, 0, False)

    def update(
        self,
        field: Field,
        side: float,
        spread: Spread,
        most_px: float,
        limit: UpdateLimit = UNLIMITED,
        cancellation: CancellationPoint = NEVER_CANCELLED,
    ) -> moderngl.Texture:
        """Spread the changes of a field.

        Args:
            field: field of the picture. The first one of a size is spread from nothing.
            side: 1 in front of the focus, -1 behind it; 1 where radii are signed, above 0 in front.
            spread: distribution of light over a circle of confusion. Another one starts from nothing.
            most_px: upper bound on the radii.
            limit: limit on the changes that are spread; the rest waits, and grows in importance.
            cancellation: polled between pieces of the work. Pieces that are done stay done.

        Returns:
            RGBA32F: the sum of weighted light, and the sum of weights; valid until the next update.

        Raises:
            Cancelled: the work is stale.
        """
        spreader = self._spreader
        if spreader.resize(field.light.size):
            self._allocate()
        if spreader.update_tables(spread, most_px) or side != self._side:
            self._is_whole, self._side = False, side
        pixels = spreader.size[0] * spreader.size[1]
        changed = (
            self._compare(field, is_ordered=not limit.is_unlimited or cancellation.is_cancellable)
            if self._is_whole
            else None
        )
        if changed is None or (limit.is_unlimited and changed > RESPREAD_SHARE * pixels):
            self._respread(field, cancellation, pixels if changed is None else changed)
            return spreader.result
        done = 0
        for first, end in self._pieces(changed, limit, cancellation):
            self._spread_changes(first, end)
            done = end
        self._may_wait = self._may_wait and done < changed
        self.stats = UpdateStats(changed, done, False)
        return spreader.result

    def release(self) -> None:
        """Release the memory; the next field is spread from nothing."""
        self._resources.close()
        self._is_whole = False
        self._spreader.release()

    def _allocate(self) -> None:
        self._resources.close()
        self._is_whole = False
        keep, spreader = self._resources.keep, self._spreader
        self._light = keep(self._ctx.texture(spreader.size, 4, dtype="f4"))  # light and state that the sums belong to
        self._state, self._before = (keep(self._ctx.texture(spreader.size, 2, dtype="f4")) for _ in range(2))
        self._sums = keep(make_storage(self._ctx, 32 * spreader.size[0] * spreader.size[1], "the sums of light"))
        self._changes, self._reaches, self._picked = (
            keep(self._ctx.buffer(reserve=size * spreader.half_tiles)) for size in (16, 4, 4)
        )
        self._buffers = self._changes, self._reaches, keep(spreader.make_tile_bits())
        tiles = spreader.half_tiles // 2
        self._reached, self._rechecked = (keep(self._ctx.buffer(reserve=4 * tiles)) for _ in range(2))
        self._listed = keep(self._ctx.buffer(reserve=4 * (tiles + 1)))
        self._sorter = ChangeSorter(self._ctx, self._programs, spreader, self._resources, self._importance)

    def _compare(self, field: Field, *, is_ordered: bool) -> int | None:
        """Load a field and count the pixels that have changed; None where it must be spread from nothing."""
        program = self._programs.compute(
            "linear/linear_load.comp", {"COMPARE": 1} | ({"ORDERED": 1} if is_ordered else {})
        )
        self._is_ordered = is_ordered
        self._may_wait = self._may_wait or is_ordered
        if is_ordered:
            self._sorter.bind(program)
        fits, changed = self._spreader.run_load(
            program, field, self._side, self._buffers, light_last=self._light, state_last=self._state
        )
        if is_ordered and fits and changed:
            self._sorter.sort()
        return changed if fits else None

    def _respread(self, field: Field, cancellation: CancellationPoint, changed: int) -> None:
        spreader = self._spreader
        self._is_whole = False
        spreader.load(field, self._side)
        spreader.spread_all(self._sums, cancellation)
        spreader.light, self._light = self._light, spreader.light
        spreader.state, self._state = self._state, spreader.state
        self._sorter.clear()
        self._is_whole, self._may_wait = True, False
        self.stats = UpdateStats(changed, changed, True)

    def _pieces(self, changed: int, limit: UpdateLimit, cancellation: CancellationPoint) -> Iterator[tuple[int, int]]:
        """Ranges of the order, as long as there is time."""
        total = int(np.ceil(limit.share * changed))
        if limit.budget_ms is None and not cancellation.is_cancellable:
            if total:
                yield 0, total
            return
        began, first = perf_counter(), 0
        while first < total:
            piece_began, end = perf_counter(), min(first + self._piece.units, total)
            yield first, end
            self._ctx.finish()
            self._piece.learn(end - first, 1000 * (perf_counter() - piece_began))
            cancellation.poll()
            if limit.budget_ms is not None and 1000 * (perf_counter() - began) >= limit.budget_ms:
                return
            first = end

    def _spread_changes(self, first: int, end: int) -> None:
        """Subtract the old effects of some pixels of the order and add their new ones; of all changed pixels without an
        order.
        """
        spreader = self._spreader
        if self._is_ordered:
            self._pick(first, end)
        states = {
            "light_now": spreader.light,
            "state_now": spreader.state,
            "light_last": self._light,
            "state_last": self._state,
        }
        mark = self._programs.compute("importance/importance_mark.comp", self._pick_defines)
        spreader.bind_textures(mark, **states)
        set_uniforms(mark, has_cutoff=spreader.has_cutoff)
        for unit, marks in ((3, self._reached), (4, self._rechecked)):
            marks.clear()
            marks.bind_to_storage_buffer(unit)
        for unit, buffer in ((1, self._changes), (2, self._reaches), (5, self._picked)):
            buffer.bind_to_storage_buffer(unit)
        spreader.run_half_tiles(mark)
        listed = self._list_tiles(self._reached)
        spread = spreader.spread_program(KEEP=1, LISTED=1, DIFFERENCE=1, **self._pick_defines)
        spreader.bind_textures(spread, **states, weights=spreader.tables.weights)
        spreader.bind_spread(spread, self._buffers)
        self._picked.bind_to_storage_buffer(5)
        self._run_on_list(spread, listed)
        self._commit()
        if spreader.has_cutoff:
            self._update_cutoff()

    @property
    def _pick_defines(self) -> dict[str, int]:
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

    def _commit(self) -> None:
        """Record the picked pixels' light and state as those of the sums."""
        spreader = self._spreader
        defines = (
            self._pick_defines
            | ({"CUTOFF": 1} if spreader.has_cutoff else {})
            | ({"WAITING": 1} if self._may_wait else {})
        )
        program = self._programs.compute("importance/importance_commit.comp", defines)
        spreader.bind_textures(program, light_now=spreader.light, state_now=spreader.state)
        set_uniforms(program, wide=spreader.tables.wide, beyond_px=spreader.tables.beyond_px)
        for unit, image in enumerate((self._light, self._state, self._before, self._sorter.waiting)):
            image.bind_to_image(unit, read=unit < 2, write=True)
        for unit, buffer in (
            (1, self._changes),
            (2, spreader.emitters),
            (3, spreader.reaches),
            (4, spreader.tile_bits),
            (5, self._picked),
        ):
            buffer.bind_to_storage_buffer(unit)
        spreader.run_half_tiles(program)

    def _update_cutoff(self) -> None:
        """Update the light that pixels with a new state hide."""
        spreader = self._spreader
        listed = self._list_tiles(self._rechecked)
        program = spreader.spread_program(KEEP=1, LISTED=1, RECHECK=1)
        spreader.bind_textures(
            program,
            light_now=self._light,
            state_now=self._state,
            state_before=self._before,
            weights=spreader.tables.weights,
        )
        spreader.bind_spread(program, (spreader.emitters, spreader.reaches, spreader.tile_bits))
        self._run_on_list(program, listed)

    def _list_tiles(self, marks: moderngl.Buffer) -> int:
        """List the marked tiles and return their number."""
        program = self._programs.compute("importance/importance_list.comp")
        self._listed.write(bytes(4))
        self._listed.bind_to_storage_buffer(3)
        marks.bind_to_storage_buffer(4)
        count = self._spreader.half_tiles // 2
        set_uniforms(program, count=count)
        program.run(-(-count // LANES))
        self._ctx.memory_barrier()
        return int(np.frombuffer(self._listed.read(4), np.uint32)[0])

    def _run_on_list(self, program: moderngl.ComputeShader, count: int) -> None:
        if count == 0:
            return
        self._listed.bind_to_storage_buffer(3)
        self._sums.bind_to_storage_buffer(0)
        program.run(min(count, 1024), -(-count // 1024))
        self._ctx.memory_barrier()
