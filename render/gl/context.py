"""The one place that makes an OpenGL context: pyrender's EGL platform, with moderngl attached to the same context."""

from __future__ import annotations

import os
from types import TracebackType
from typing import Any

import moderngl

from render.errors import GraphicsError
from render.gl.cancellation import CancellationPoint
from render.gl.compat import (
    FunctionLoader,
    hardware_devices,
    make_context,
    pyrender_egl,
    release_context,
    report_to,
    software_device,
)
from render.gl.debug import DebugLog, is_debugging
from render.gl.limits import check_device, memory_bytes
from render.gl.no_gpu import check_software, is_gpu_refused

REQUIRED_VERSION = 450
GPU = "PULLFOCUS_GPU"
"""Environment variable: number of the GPU that draws, from 0 on, where there are several."""


class GraphicsContext:
    """An off-screen OpenGL 4.5 context that belongs to the thread that made it.

    Attributes:
        ctx: moderngl's view of the context.
        renderer: the driver's name of the device, such as ``llvmpipe (LLVM 15.0.6, 256 bits)``.
        is_software: whether the device is a CPU rasteriser.
        memory_bytes: memory of the GPU, as its driver states it; 0 where it states none, and of a CPU rasteriser.
        cancellation: cancellation point of long work on it.
    """

    def __init__(self) -> None:
        """Make the context current.

        Raises:
            GraphicsError: no EGL device, or one that lacks OpenGL 4.5 or what that leaves to a device (`render.gl.limits`), or
                a GPU where none may be used (`render.gl.no_gpu`).
        """
        platform = None
        try:
            platform = self._platform = pyrender_egl.EGLPlatform(1, 1, _chosen_device())
            debug = is_debugging()
            make_context(self._platform, debug=debug)
            # Not create_context: from its second call in a process on, it asks GLX, which knows no EGL context.
            moderngl.init_context(FunctionLoader())
            self.ctx = moderngl.get_context()
        except Exception as error:  # EGL and PyOpenGL raise their own kinds, bare assertions included
            if platform is not None:
                release_context(platform)
            raise GraphicsError(
                f"no OpenGL context could be made through EGL ({type(error).__name__}: {error}); on a machine without a GPU "
                "install Mesa's software rasteriser (Debian: libegl1 libgl1 libgl1-mesa-dri)"
            ) from error
        self.renderer: str = self.ctx.info["GL_RENDERER"]
        self.is_software = "llvmpipe" in self.renderer or "softpipe" in self.renderer
        if self.ctx.version_code < REQUIRED_VERSION:
            version = self.ctx.info["GL_VERSION"]
            self.close()
            raise GraphicsError(f"OpenGL 4.5 is needed, {self.renderer} offers {version}")
        try:
            check_software(self.renderer, self.is_software)
            check_device(self.renderer, self.ctx.info)
        except GraphicsError:
            self.close()
            raise
        self.memory_bytes = 0 if self.is_software else memory_bytes(self.ctx)
        self._log = DebugLog()
        if debug:
            report_to(self._platform, self._log.add)
        self.cancellation = CancellationPoint(self.ctx.finish)

    def make_current(self) -> None:
        """Make this context current in the calling thread."""
        self._platform.make_current()

    def raise_faults(self) -> None:
        """Raise what the driver has reported so far, where debug output is on (`render.gl.debug`).

        Raises:
            GraphicsError: it reported an error or undefined use.
        """
        self._log.raise_faults()

    def close(self) -> None:
        """Destroy the context and everything in it; other contexts of the process stay."""
        release_context(self._platform)

    def __enter__(self) -> GraphicsContext:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
        if kind is None:
            self.raise_faults()


def _chosen_device() -> Any:
    """Return EGL's device that draws; None for the one that EGL prefers."""
    if is_gpu_refused():
        return software_device()
    devices, number = hardware_devices(), os.environ.get(GPU, "")
    return devices[int(number) % len(devices)] if devices and number.isdecimal() else None
