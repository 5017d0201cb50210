"""What moves on peeled layers while the shutter is open, block by block: where to look for it, where it may be at a moment."""

from __future__ import annotations

from types import TracebackType

import moderngl
import numpy as np

from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.limits import BLOCK_PX, EMPTY_MIN
from render.layers.peel import Layers
from render.layers.targets import LAYERS_PER_PACK
from render.optics.view import PinholeView

_FASTEST, _LANDING, _SWEPT = 9, 10, 11  # as the shaders bind them
_GROUP = 64  # of landing.comp
_MOST_TRIES = 16  # of march_moving.glsl, in one stretch of a ray


def blocks_of(view: PinholeView) -> tuple[int, int]:
    """Blocks of a view's pixels, across and down."""
    return -(-view.width // BLOCK_PX), -(-view.height // BLOCK_PX)


class Movers:
    """The movers of one peeling; to be given back before the next.

    Args:
        ctx: of the device.
        programs: of that context.
        layers: that keep how their surfaces move.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, layers: Layers) -> None:
        self._ctx, self._programs, self._layers = ctx, programs, layers
        self._blocks = blocks_of(layers.view)
        blocks = self._blocks[0] * self._blocks[1]
        self._count = layers.count * blocks
        self._index_bits = self._count.bit_length()
        self._fastest = ctx.buffer(reserve=max(1, self._count) * 16)
        self._landing = ctx.buffer(reserve=blocks * 4)
        empty = np.array([EMPTY_MIN, 0.0], np.float32)
        self._swept = ctx.buffer(np.tile(empty, blocks).tobytes())
        self._find()

    def _find(self) -> None:
        targets = self._layers.targets
        program = self._programs.compute("movers.comp")
        if targets.motion is None:
            raise ValueError("these layers do not keep how surfaces move")
        packs = targets.packed_w
        packs[0].use(0)
        packs[min(1, len(packs) - 1)].use(1)
        targets.motion.use(2)
        set_uniforms(program, near_w=0, far_w=1, motion=2)
        self._carry(program)
        set_uniforms(program, layers=min(self._layers.count, LAYERS_PER_PACK * len(packs)))
        self._fastest.bind_to_storage_buffer(_FASTEST)
        self.bind_swept()
        program.run(-(-self._blocks[0] // 8), -(-self._blocks[1] // 8))
        self._ctx.memory_barrier()

    def bind_swept(self) -> None:
        """Let a program see the ranges of inverse depth that are swept."""
        self._swept.bind_to_storage_buffer(_SWEPT)

    def land(self, since: float) -> None:
        """Find what may be in each block at a moment: from -0.5, when the shutter opens, to 0.5."""
        self._landing.clear()
        program = self._programs.compute("landing.comp")
        self._carry(program)
        set_uniforms(program, count=self._count, index_bits=self._index_bits, since=since)
        self._fastest.bind_to_storage_buffer(_FASTEST)
        self._landing.bind_to_storage_buffer(_LANDING)
        program.run(max(1, -(-self._count // _GROUP)))
        self._ctx.memory_barrier()

    def bind(self, program: moderngl.ComputeShader, unit: int, since: float) -> None:
        """Let the tracer see what has landed; the motion takes a texture unit."""
        motion = self._layers.targets.motion
        assert motion is not None
        motion.use(unit)
        set_uniforms(program, motion=unit, since=since, key_mask=(1 << self._index_bits) - 1, most_tries=_MOST_TRIES)
        self._fastest.bind_to_storage_buffer(_FASTEST)
        self._landing.bind_to_storage_buffer(_LANDING)

    def _carry(self, program: moderngl.ComputeShader) -> None:
        view = self._layers.view
        set_uniforms(program, layer_axis=(view.cx, view.cy), layer_focal=(view.fx, view.fy), blocks=self._blocks)

    def __enter__(self) -> Movers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for buffer in (self._fastest, self._landing, self._swept):
            buffer.release()
