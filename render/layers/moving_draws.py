"""Device buffers with the poses and positions of moving draws, from which each pixel of a layer gets its motion."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType

import moderngl
import numpy as np

from render.errors import GraphicsError
from render.gl.resources import Construction
from render.layers.index import Draw
from render.layers.movement import Movement
from render.model.arrays import DoubleArray

_POSES, _POSITIONS = 0, 1  # as layers/surface.vert binds them


class MovingDraws:
    """Buffers with the opening and closing state of moving draws; to be released after the peeling.

    Args:
        ctx: context of the device.
        draws: draws of the peeling.
        moves: movements by the ids of their batches.
        camera_from_world: ``(4, 4)`` of the layers' view.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        draws: list[Draw],
        moves: Mapping[int, Movement],
        camera_from_world: DoubleArray,
    ) -> None:
        self._poses: dict[int, moderngl.Buffer] = {}
        self._positions: dict[int, moderngl.Buffer] = {}
        with Construction() as making:
            for draw in draws:
                movement = moves.get(id(draw.batch))
                if movement is None:
                    continue
                times = movement.opening_poses, draw.batch.poses, movement.closing_poses
                poses = np.stack([camera_from_world @ there[draw.instances] for there in times], axis=1)
                self._poses[id(draw)] = making.keep(_buffer(ctx, poses.transpose(0, 1, 3, 2)))
                first, last = movement.opening_positions, movement.closing_positions
                if first is not None and last is not None and id(draw.batch) not in self._positions:
                    self._positions[id(draw.batch)] = making.keep(_buffer(ctx, np.stack([first, last], axis=1)))

    @property
    def any(self) -> bool:
        """Whether any draw moves."""
        return bool(self._poses)

    def defines(self, draw: Draw) -> dict[str, object]:
        """Shader defines for a draw: whether it moves and whether it bends."""
        defines: dict[str, object] = {"MOTION": 1}
        if id(draw) in self._poses:
            defines["MOVES"] = 1
        if id(draw) in self._poses and id(draw.batch) in self._positions:
            defines["BENDS"] = 1
        return defines

    def bind(self, draw: Draw) -> None:
        """Bind a draw's buffers."""
        if id(draw) in self._poses:
            self._poses[id(draw)].bind_to_storage_buffer(_POSES)
        if id(draw.batch) in self._positions:
            self._positions[id(draw.batch)].bind_to_storage_buffer(_POSITIONS)

    def __enter__(self) -> MovingDraws:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for buffer in (*self._poses.values(), *self._positions.values()):
            buffer.release()


def _buffer(
    ctx: moderngl.Context, values: np.ndarray[tuple[int, ...], np.dtype[np.float64 | np.float32]]
) -> moderngl.Buffer:
    most = int(ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
    if values.size * 4 > most:
        raise GraphicsError(
            f"moving surfaces take {values.size * 4 / 2**20:.0f} MB, and a buffer of the device holds {most / 2**20:.0f} MB:"
            " ask for motion by moments"
        )
    return ctx.buffer(np.ascontiguousarray(values, np.float32).tobytes())
