"""Device buffers with the colours of instances (`Batch.instance_colors`)."""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.layers.index import Draw
from render.model.arrays import FloatArray

_BINDING = 2  # as layers/surface.vert binds it


class InstanceColors:
    """Buffers by draw, kept while the arrays and the draws' instances stay the same.

    Args:
        ctx: context of the device.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._buffers: dict[tuple[int, int, int], tuple[FloatArray, moderngl.Buffer]] = {}

    def bind(self, draw: Draw) -> None:
        """Bind the colours of a draw that has some.

        Raises:
            GraphicsError: they do not fit into a buffer of the device.
        """
        colors = draw.batch.instance_colors
        if colors is None:
            return
        key = _key(draw)
        if key not in self._buffers:
            own = np.ascontiguousarray(colors[draw.instances], np.float32)
            most = int(self._ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
            if own.nbytes > most:
                message = f"the colours of {len(own):,} instances take {own.nbytes / 2**20:.0f} MB"
                raise GraphicsError(f"{message}, and a buffer of the device holds {most / 2**20:.0f} MB")
            self._buffers[key] = colors, self._ctx.buffer(own.tobytes())
        self._buffers[key][1].bind_to_storage_buffer(_BINDING)

    def keep(self, draws: Iterable[Draw]) -> None:
        """Release the buffers of all other draws."""
        kept = {_key(draw) for draw in draws}
        for key in self._buffers.keys() - kept:
            self._buffers.pop(key)[1].release()

    def release(self) -> None:
        """Release the memory on the device."""
        self.keep(())


def _key(draw: Draw) -> tuple[int, int, int]:
    """Identity of the array, and which of its instances the draw has: those that mirror, or those that do not."""
    first = int(draw.instances[0]) if len(draw.instances) else -1
    return id(draw.batch.instance_colors), first, len(draw.instances)
