"""Limits of a device: what drawing needs beyond OpenGL 4.5's least values, and sizes that a device may refuse.

Bindings, work groups, attributes and outputs keep to the least values that OpenGL 4.5 allows, which the tests check in the
shaders. A driver says nothing about a texture or buffer beyond its limits, and pictures get black or wrong: ask here first.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import moderngl

from render.errors import GraphicsError
from render.gl.compat import query_integers

_DEDICATED_MEMORY_NVX, _TEXTURE_FREE_MEMORY_ATI = 0x9047, 0x87FC
_NEEDED = {"GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS": (2, "storage buffers in a vertex shader")}  # OpenGL 4.5 allows 0


def check_device(renderer: str, info: Mapping[str, Any]) -> None:
    """Check that a device offers what OpenGL 4.5 leaves to it.

    Args:
        renderer: name of the device.
        info: limits by OpenGL's names.

    Raises:
        GraphicsError: it lacks something; the message says what.
    """
    for name, (least, what) in _NEEDED.items():
        if int(info[name]) < least:
            raise GraphicsError(f"{renderer} offers {info[name]} {what} ({name}), and {least} are needed")


def memory_bytes(ctx: moderngl.Context) -> int:
    """Ask for the memory of a GPU, bytes; 0 where the driver does not say (Intel's, for one, which shares the processor's).

    Args:
        ctx: context of the GPU, which is current.

    Sources: GL_NVX_gpu_memory_info (the GPU's own memory) and GL_ATI_meminfo (memory that is free for textures), both in KiB.
    """
    if "GL_NVX_gpu_memory_info" in ctx.extensions:
        return query_integers(_DEDICATED_MEMORY_NVX, 1)[0] << 10
    if "GL_ATI_meminfo" in ctx.extensions:
        return query_integers(_TEXTURE_FREE_MEMORY_ATI, 4)[0] << 10
    return 0


def make_storage(ctx: moderngl.Context, size: int, what: str) -> moderngl.Buffer:
    """Make a storage buffer with undefined contents.

    Args:
        ctx: context of the device.
        size: bytes.
        what: contents, for the message.

    Raises:
        GraphicsError: shaders cannot read so large a buffer.
    """
    most = int(ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"])
    if size > most:
        raise GraphicsError(
            f"{what} would take {size / 2**20:.0f} MB, and shaders of this device read buffers of at most"
            f" {most / 2**20:.0f} MB: ask for a smaller picture"
        )
    return ctx.buffer(reserve=max(size, 4))


def check_texture_array(ctx: moderngl.Context, size: tuple[int, int, int], what: str) -> None:
    """Check the size of a texture array.

    Args:
        ctx: context of the device.
        size: width and height in texels, and slices.
        what: contents, for the message.

    Raises:
        GraphicsError: it is beyond the device's limits.
    """
    side, slices = int(ctx.info["GL_MAX_TEXTURE_SIZE"]), int(ctx.info["GL_MAX_ARRAY_TEXTURE_LAYERS"])
    if max(size[:2]) > side or size[2] > slices:
        raise GraphicsError(
            f"{what} would take {size[2]} textures of {size[0]}x{size[1]}, and this device has at most {slices} of {side}x{side}"
        )
