"""Choice of a processor in place of a GPU, by an environment variable."""

from __future__ import annotations

import os

from render.errors import GraphicsError

NO_GPU = "PULLFOCUS_NO_GPU"
"""Environment variable: where it is set, OpenGL must be drawn by the processor."""


def request_software() -> None:
    """Ask Mesa for its software rasteriser where `NO_GPU` is set. To be called before a context is made."""
    if os.environ.get(NO_GPU):
        os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"


def check_software(renderer: str, is_software: bool) -> None:
    """Refuse a GPU where `NO_GPU` is set.

    Args:
        renderer: the driver's name of the device.
        is_software: whether it is a software rasteriser.

    Raises:
        GraphicsError: it is a GPU.
    """
    if os.environ.get(NO_GPU) and not is_software:
        raise GraphicsError(
            f"no GPU was to be used, and OpenGL draws with {renderer}: install Mesa's software rasteriser (Debian: "
            "libgl1-mesa-dri), and name it in __EGL_VENDOR_LIBRARY_FILENAMES where another driver comes first"
        )
