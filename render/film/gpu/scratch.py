"""Scratch textures and buffers, reused between pictures and reallocated when their size changes."""

from __future__ import annotations

import moderngl

from render.errors import GraphicsError

_LANES = 64  # of the shaders that work along a line


def groups(threads: int) -> int:
    """Number of work groups that cover ``threads`` invocations of a one-dimensional shader."""
    return -(-threads // _LANES)


class TooLargeError(GraphicsError):
    """A picture needs more of the device at once than that gives."""


class Scratch:
    """Buffers and textures that a pass keeps between pictures, by name."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._buffers: dict[str, moderngl.Buffer] = {}
        self._textures: dict[str, moderngl.Texture] = {}

    def buffer(self, name: str, size: int) -> moderngl.Buffer:
        """Buffer of ``size`` bytes with undefined contents. Raises `TooLargeError` above the device's limit."""
        most = self._ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]
        if size > most:
            raise TooLargeError(
                f"a picture needs a buffer of {size} bytes, and the device's shaders read {most} at most"
            )
        kept = self._buffers.get(name)
        if kept is None or kept.size != size:
            if kept is not None:
                self._buffers.pop(name).release()
            kept = self._buffers[name] = self._ctx.buffer(reserve=size)
        return kept

    def texture(self, name: str, size: tuple[int, int], components: int, dtype: str) -> moderngl.Texture:
        """A texture of that size and format, with whatever is in it."""
        kept = self._textures.get(name)
        if kept is None or (kept.size, kept.components, kept.dtype) != (size, components, dtype):
            if kept is not None:
                self._textures.pop(name).release()
            kept = self._textures[name] = self._ctx.texture(size, components, dtype=dtype)
        return kept

    def release(self) -> None:
        """Release the memory on the device."""
        for named in (self._buffers, self._textures):
            while named:
                named.popitem()[1].release()
