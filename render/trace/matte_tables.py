"""Tables of what the rays of each pixel meet (``trace/mattes.glsl``), on the device."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.errors import GraphicsError, SettingsError
from render.gl.compat import GL
from render.layers.matte_numbers import MatteNumbers
from render.layers.peeled import Layers
from render.model.arrays import FloatArray

SLOTS = 16
"""Surfaces of a pixel that are told apart."""
_TABLE, _LIGHT_TABLE = 1, 2  # image units, as the shader binds them
_OBJECTS, _NUMBERS = 0, 2  # storage buffers, likewise


class MatteTables:
    """Tables of one area of a picture.

    Args:
        ctx: context of the device.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._numbers: MatteNumbers | None = None
        self._buffers: tuple[moderngl.Buffer, moderngl.Buffer] | None = None
        self._table: moderngl.TextureArray | None = None
        self._light: moderngl.TextureArray | None = None

    def begin(self, numbers: MatteNumbers, size: tuple[int, int]) -> None:
        """Empty the tables of an area of a size.

        Raises:
            SettingsError: a merged mesh has more triangles than a buffer of the device holds numbers.
            GraphicsError: the device has no memory for the tables.
        """
        if numbers is not self._numbers:
            self._upload(numbers)
        if self._table is None or self._table.size[:2] != size or (self._light is not None) != numbers.is_deep:
            self._allocate(size, numbers.is_deep)
        if self._table is not None:
            GL.glClearTexImage(self._table.glo, 0, GL.GL_RG_INTEGER, GL.GL_UNSIGNED_INT, np.zeros(2, np.uint32))

    def bind(self, program: moderngl.ComputeShader, layers: Layers, unit: int) -> None:
        """Bind the tables and the ids of layers, which hold some, for a program; the ids to a texture unit."""
        if self._buffers is None or self._table is None or layers.targets.ids is None:
            raise ValueError("no mattes were begun, or the layers hold no ids")
        for buffer, binding in zip(self._buffers, (_OBJECTS, _NUMBERS), strict=True):
            buffer.bind_to_storage_buffer(binding)
        self._table.bind_to_image(_TABLE, read=True, write=True)
        if self._light is not None:
            self._light.bind_to_image(_LIGHT_TABLE, read=True, write=True)
        layers.targets.ids.use(unit)
        program["surface_ids"] = unit

    def read(self) -> tuple[NDArray[np.uint32], FloatArray]:
        """Read numbers ``(SLOTS, height, width)``, 0 where not used, and what `MatteSum.put` takes as values."""
        if self._table is None:
            raise ValueError("no mattes were begun")
        width, height, _ = self._table.size
        table = np.frombuffer(self._table.read(), np.uint32).reshape(SLOTS, height, width, 2)
        weights = np.ascontiguousarray(table[..., 1]).view(np.float32)[..., None]
        if self._light is None:
            return table[..., 0], weights
        light = np.frombuffer(self._light.read(), np.float32).reshape(SLOTS, height, width, 4)
        return table[..., 0], np.concatenate([weights, light], axis=-1)

    def release(self) -> None:
        """Release the memory."""
        for resource in (*(self._buffers or ()), self._table, self._light):
            if resource is not None:
                resource.release()
        self._buffers = self._table = self._light = self._numbers = None

    def _allocate(self, size: tuple[int, int], is_deep: bool) -> None:
        for table in (self._table, self._light):
            if table is not None:
                table.release()
        self._table = self._light = None
        try:
            self._table = self._ctx.texture_array((*size, SLOTS), 2, dtype="u4")
            self._light = self._ctx.texture_array((*size, SLOTS), 4, dtype="f4") if is_deep else None
        except moderngl.Error as error:
            raise GraphicsError(f"the device cannot hold the mattes of {size[0]}x{size[1]} pixels: {error}") from error

    def _upload(self, numbers: MatteNumbers) -> None:
        most = int(self._ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
        needed = max(numbers.objects.nbytes, numbers.surfaces.nbytes)
        if needed > most:
            raise SettingsError(
                f"the scene has too many surfaces for mattes: their numbers take {needed} bytes, and a buffer of this device"
                f" holds {most}"
            )
        for buffer in self._buffers or ():
            buffer.release()
        self._buffers = None
        # a buffer cannot be empty
        objects, surfaces = (
            self._ctx.buffer(np.ascontiguousarray(array).tobytes() or bytes(8))
            for array in (numbers.objects, numbers.surfaces)
        )
        self._numbers, self._buffers = numbers, (objects, surfaces)
