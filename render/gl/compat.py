"""pyrender, made to run on today's Python. The only module that imports it or PyOpenGL directly.

Why each adaptation is here:

- pyrender 0.1.45 (2021, its last release) uses ``np.infty``, which NumPy 2 removed. The alias is set for the import alone.
- PyOpenGL picks its platform when it is first imported; without ``PYOPENGL_PLATFORM=egl`` it looks for an X display.
- pyrender imports its viewer, and so pyglet, which looks for X libraries unless ``PYGLET_HEADLESS`` is set.
- PyOpenGL knows the type of a ``ctypes.byref`` under its name before Python 3.12.
- pyrender's platform requests OpenGL 4.1, and NVIDIA's driver gives exactly that; `make_context` asks for 4.5.
- pyrender pins PyOpenGL 3.1.0 (2014), which knows OpenGL up to 4.4; ``glClipControl`` of 4.5 is fetched from the driver.
"""

from __future__ import annotations

import ctypes
import os
from functools import cache

os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("PYGLET_HEADLESS", "1")

import numpy as np
from numpy.typing import NDArray

from render.errors import GraphicsError

_had_infty = hasattr(np, "infty")
if not _had_infty:
    np.infty = np.inf  # type: ignore[attr-defined]
try:
    import pyrender
    import pyrender.light
    import pyrender.material
    import pyrender.renderer
    import pyrender.shader_program
    import pyrender.texture
    from OpenGL import EGL, GL
    from OpenGL.error import Error as OpenGLError
    from OpenGL.plugins import FormatHandler
    from OpenGL.raw.GL.VERSION.GL_1_1 import glTexImage2D as raw_tex_image_2d
    from pyrender.platforms import egl as pyrender_egl
except (ImportError, AttributeError) as error:  # PyOpenGL looks up a function in a library that it did not find
    raise GraphicsError(
        f"OpenGL's libraries cannot be loaded ({error}); on a machine without a GPU install Mesa's software rasteriser "
        "(Debian: libegl1 libgl1 libgl1-mesa-dri)"
    ) from error

if not _had_infty:
    del np.infty  # type: ignore[attr-defined]

FormatHandler("byref", "OpenGL.arrays.ctypesparameters.CtypesParameterHandler", ["_ctypes.CArgObject"], isOutput=True)

__all__ = [
    "CLIP_NEGATIVE_ONE_TO_ONE",
    "CLIP_ZERO_TO_ONE",
    "GL",
    "OpenGLError",
    "half_float_image",
    "make_context",
    "pyrender",
    "pyrender_egl",
    "release_context",
    "set_clip_depth",
]

CLIP_NEGATIVE_ONE_TO_ONE = 0x935E
CLIP_ZERO_TO_ONE = 0x935F
_LOWER_LEFT = 0x8CA1
_VERSION = (4, 5)


def make_context(platform: pyrender_egl.EGLPlatform) -> None:
    """Initialise a platform and make its context current: OpenGL 4.5 core, or its own 4.1 where 4.5 is missing."""
    platform.init_context()
    config_attributes = [
        EGL.EGL_SURFACE_TYPE,
        EGL.EGL_PBUFFER_BIT,
        EGL.EGL_RENDERABLE_TYPE,
        EGL.EGL_OPENGL_BIT,
        EGL.EGL_NONE,
    ]
    configs, count = (EGL.EGLConfig * 1)(), ctypes.c_long()
    EGL.eglChooseConfig(
        platform._egl_display, (EGL.EGLint * len(config_attributes))(*config_attributes), configs, 1, count
    )
    version = [EGL.EGL_CONTEXT_MAJOR_VERSION, _VERSION[0], EGL.EGL_CONTEXT_MINOR_VERSION, _VERSION[1]]
    version += [EGL.EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL.EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL.EGL_NONE]
    attributes = (EGL.EGLint * len(version))(*version)
    context = EGL.eglCreateContext(platform._egl_display, configs[0], EGL.EGL_NO_CONTEXT, attributes)
    if context:
        release_context(platform)
        platform._egl_context = context
    platform.make_current()


def release_context(platform: pyrender_egl.EGLPlatform) -> None:
    """Destroy a platform's context. pyrender's own way terminates the display, and with it every context of the process.

    Args:
        platform: platform whose context is destroyed.
    """
    EGL.eglMakeCurrent(platform._egl_display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, EGL.EGL_NO_CONTEXT)
    EGL.eglDestroyContext(platform._egl_display, platform._egl_context)


def set_clip_depth(mode: int) -> None:
    """``glClipControl`` with the origin at the lower left; ``mode`` is one of the two constants of this module."""
    _clip_control()(_LOWER_LEFT, mode)


def half_float_image(pixels: NDArray[np.float16]) -> None:
    """Fill the bound 2D texture with ``(height, width, 4)`` half floats. PyOpenGL 3.1.0's own call has no half floats."""
    height, width = pixels.shape[:2]
    data = np.ascontiguousarray(pixels, np.float16)
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    raw_tex_image_2d(
        GL.GL_TEXTURE_2D,
        0,
        GL.GL_RGBA16F,
        width,
        height,
        0,
        GL.GL_RGBA,
        GL.GL_HALF_FLOAT,
        ctypes.c_void_p(data.ctypes.data),
    )


@cache
def _clip_control() -> ctypes._CFunctionType:
    address = ctypes.cast(EGL.eglGetProcAddress(b"glClipControl"), ctypes.c_void_p).value
    if address is None:
        raise GraphicsError("the driver has no glClipControl; OpenGL 4.5 is needed")
    return ctypes.CFUNCTYPE(None, ctypes.c_uint, ctypes.c_uint)(address)
