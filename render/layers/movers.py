"""Moving surfaces of peeled layers, block by block: where a ray must search for them, and where each may be at a moment."""

from __future__ import annotations

from types import TracebackType

import moderngl
import numpy as np

from render.gl.limits import make_storage
from render.gl.resources import Construction
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.limits import BLOCK_PX, EMPTY_MIN
from render.layers.peeled import Layers
from render.layers.targets import LAYERS_PER_PACK
from render.optics.view import PinholeView

_ARRIVALS, _SWEPT = 3, 1  # as the shaders bind them
_GROUP = 8
_MOST_TRIES = 20  # in trace/march_moving.glsl, for one interval of a ray
_KINDS = 4  # movers per block and layer: the fastest and the slowest, in either half of the exposure


def block_counts(view: PinholeView) -> tuple[int, int]:
    """Number of blocks across and down a view."""
    return -(-view.width // BLOCK_PX), -(-view.height // BLOCK_PX)


class Movers:
    """Movers of one peeling; to be released before the next.

    Args:
        ctx: context of the device.
        programs: programs of that context.
        layers: layers with motion.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache, layers: Layers) -> None:
        motion = layers.targets.motion
        if motion is None:
            raise ValueError("these layers do not keep how surfaces move")
        self._ctx, self._programs, self._layers, self._motion = ctx, programs, layers, motion
        self._blocks = block_counts(layers.view)
        count = self._blocks[0] * self._blocks[1]
        with Construction() as making:
            # half floats suffice: they only say where to search first
            self._movers = making.keep(ctx.texture_array((*self._blocks, _KINDS * layers.count), 4, dtype="f2"))
            self._movers.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._arrivals = making.keep(make_storage(ctx, count * 16, "moving surfaces"))
            empty = np.array([EMPTY_MIN, 0.0], np.float32)
            self._swept = making.keep(ctx.buffer(np.tile(empty, count).tobytes()))
            self._find()

    def _find(self) -> None:
        packs = self._layers.targets.packed_w
        program = self._programs.compute("layers/movers.comp")
        packs[0].use(0)
        packs[min(1, len(packs) - 1)].use(1)
        self._motion.use(2)
        set_uniforms(program, near_w=0, far_w=1, motion=2)
        self.bind_swept()
        self._movers.bind_to_image(0, read=False, write=True)
        self._run(program)

    def bind_swept(self) -> None:
        """Bind the swept ranges of inverse depth."""
        self._swept.bind_to_storage_buffer(_SWEPT)

    def update(self, shutter_time: float) -> None:
        """Compute the surfaces that may be in each block at a moment: from -0.5, as the shutter opens, to 0.5."""
        self._arrivals.clear()
        program = self._programs.compute("layers/arrivals.comp")
        self._movers.use(0)
        self._arrivals.bind_to_storage_buffer(_ARRIVALS)
        for writes_indices in (False, True):
            set_uniforms(program, movers=0, shutter_time=shutter_time, writes_indices=writes_indices)
            self._run(program)

    def bind(self, program: moderngl.ComputeShader | moderngl.Program, first_unit: int) -> None:
        """Bind the results for the tracer; textures take two units."""
        self._motion.use(first_unit)
        self._movers.use(first_unit + 1)
        set_uniforms(program, motion=first_unit, movers=first_unit + 1, most_tries=_MOST_TRIES)
        self._arrivals.bind_to_storage_buffer(_ARRIVALS)

    def _run(self, program: moderngl.ComputeShader) -> None:
        view = self._layers.view
        set_uniforms(
            program,
            layer_axis=(view.cx, view.cy),
            layer_focal=(view.fx, view.fy),
            nearest_m=view.near_m,
            blocks=self._blocks,
            layers=min(self._layers.count, LAYERS_PER_PACK * len(self._layers.targets.packed_w)),
        )
        program.run(-(-self._blocks[0] // _GROUP), -(-self._blocks[1] // _GROUP))
        self._ctx.memory_barrier()

    def __enter__(self) -> Movers:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for resource in (self._movers, self._arrivals, self._swept):
            resource.release()
