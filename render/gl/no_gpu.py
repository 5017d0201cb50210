"""Choice of the processor in place of a GPU, by an environment variable."""

from __future__ import annotations

import os

from render.errors import GraphicsError

NO_GPU = "PULLFOCUS_NO_GPU"
"""Environment variable: where it is set, OpenGL must be drawn by the processor."""


def is_gpu_refused() -> bool:
    """Whether OpenGL must be drawn by the processor."""
    return bool(os.environ.get(NO_GPU))


def check_software(renderer: str, is_software: bool) -> None:
    """Refuse a GPU where OpenGL must be drawn by the processor.

    Args:
        renderer: the driver's name of the device.
        is_software: whether it is a software rasteriser.

    Raises:
        GraphicsError: it is a GPU.
    """
    if is_gpu_refused() and not is_software:
        raise GraphicsError(
            f"no GPU was to be used, and OpenGL has none but {renderer}: install Mesa's software rasteriser (Debian: "
            "libegl1 libgl1 libgl1-mesa-dri)"
        )
