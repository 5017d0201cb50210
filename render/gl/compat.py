"""pyrender, made to run on today's Python. The only module that imports it or PyOpenGL directly.

Why each adaptation is here:

- pyrender 0.1.45 (2021, its last release) uses ``np.infty``, which NumPy 2 removed. The alias is set for the import alone.
- PyOpenGL picks its platform when it is first imported; without ``PYOPENGL_PLATFORM=egl`` it looks for an X display.
- pyrender imports its viewer, and so pyglet, which looks for X libraries unless ``PYGLET_HEADLESS`` is set.
- PyOpenGL knows the type of a ``ctypes.byref`` under its name before Python 3.12.
- pyrender's platform requests OpenGL 4.1, and NVIDIA's driver gives exactly that; `make_context` asks for 4.5 first.
- pyrender pins PyOpenGL 3.1.0 (2014), which knows OpenGL up to 4.4; ``glClipControl`` of 4.5 is fetched from the driver.
- PyOpenGL asks for the names of all extensions in one string, which the core profile refuses: it is given the list.
- pyrender's platform terminates its display when Python collects it, and with it every context of the process: on NVIDIA's
  driver the next call fails. It is kept from that; `release_context` destroys one context.
- pyrender's context cannot be a debug context, whose driver reports errors and undefined use; `make_context` can ask for one.
- pyrender imports its viewer (pyglet, tkinter, imageio), its fonts (freetype), and trimesh with all of SciPy: a second and more,
  for parts that are not used here. So its modules are imported one by one, and these packages run late: when one of their
  names is first used, which is never.
- PyOpenGL imports 230 modules of OpenGL's versions and extensions; those that neither pyrender nor this package uses run
  late too.
- pyrender's scene keeps the parents of its nodes in a graph of networkx, which takes a fifth of a second to import; `_NodeTree`
  keeps them in a dict.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Hashable, Iterator
from functools import cache
from importlib import import_module
from types import SimpleNamespace

os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
os.environ.setdefault("PYGLET_HEADLESS", "1")

import numpy as np
from numpy.typing import NDArray

from render.errors import GraphicsError
from render.gl.late_package import import_late

_NOT_USED = ("trimesh", "trimesh.transformations", "networkx", "freetype", "PIL.Image")
"""Packages that modules of pyrender import at their top."""
_NOT_USED_OF_GL = (
    *(f"VERSION.GL_4_{minor}" for minor in range(4)),
    "ARB.blend_func_extended",
    "ARB.copy_buffer",
    "ARB.draw_elements_base_vertex",
    "ARB.enhanced_layouts",
    "ARB.explicit_attrib_location",
    "ARB.imaging",
    "ARB.map_buffer_range",
    "ARB.provoking_vertex",
    "ARB.sampler_objects",
    "ARB.shader_bit_encoding",
    "ARB.texture_buffer_object",
    "ARB.texture_multisample",
    "ARB.texture_rgb10_a2ui",
    "ARB.texture_swizzle",
    "ARB.timer_query",
    "ARB.uniform_buffer_object",
    "ARB.vboimplementation",
    "ARB.vertex_type_2_10_10_10_rev",
    "vboimplementation",
)
"""Modules of OpenGL.GL that it imports all names of."""
_USED_OF_GL_4 = ("base_instance", "copy_image", "texture_storage", "texture_view")
"""Extensions that became part of these versions, and are used."""

_had_infty = hasattr(np, "infty")
if not _had_infty:
    np.infty = np.inf  # type: ignore[attr-defined]
try:
    for _name in (*_NOT_USED, "pyrender", "OpenGL.GL", *(f"OpenGL.GL.{name}" for name in _NOT_USED_OF_GL)):
        import_late(_name)
    from OpenGL import GL

    GL.glEnable  # noqa: B018 - runs the code of OpenGL.GL, before pyrender imports all of its names
    for _name in _USED_OF_GL_4:
        _extension = vars(import_module(f"OpenGL.GL.ARB.{_name}"))
        vars(GL).update((name, _extension[name]) for name in _extension if name.lower().startswith("gl"))
    import pyrender
    import pyrender.light
    import pyrender.material
    import pyrender.mesh
    import pyrender.node
    import pyrender.primitive
    import pyrender.renderer
    import pyrender.scene
    import pyrender.shader_program
    import pyrender.texture
    from OpenGL import EGL
    from OpenGL.error import Error as OpenGLError
    from OpenGL.extensions import VERSION_EXTENSIONS, GLQuerier
    from OpenGL.plugins import FormatHandler
    from OpenGL.raw.GL.VERSION.GL_1_1 import glTexImage2D as raw_tex_image_2d
    from OpenGL.raw.GL.VERSION.GL_1_2 import glTexImage3D as raw_tex_image_3d
    from pyrender.platforms import egl as pyrender_egl
except (ImportError, AttributeError) as error:  # PyOpenGL looks up a function in a library that it did not find
    raise GraphicsError(
        f"OpenGL's libraries cannot be loaded ({error}); on a machine without a GPU install Mesa's software rasteriser "
        "(Debian: libegl1 libgl1 libgl1-mesa-dri)"
    ) from error

if not _had_infty:
    del np.infty  # type: ignore[attr-defined]

for _module in (pyrender.material, pyrender.mesh, pyrender.node, pyrender.primitive, pyrender.scene, pyrender.texture):
    _name = _module.__name__.rpartition(".")[2].capitalize()
    setattr(pyrender, _name, getattr(_module, _name))  # as pyrender's own __init__ does

FormatHandler("byref", "OpenGL.arrays.ctypesparameters.CtypesParameterHandler", ["_ctypes.CArgObject"], isOutput=True)

__all__ = [
    "CLIP_NEGATIVE_ONE_TO_ONE",
    "CLIP_ZERO_TO_ONE",
    "GL",
    "FunctionLoader",
    "OpenGLError",
    "half_float_image",
    "hardware_devices",
    "make_context",
    "pyrender",
    "pyrender_egl",
    "query_integers",
    "release_context",
    "report_to",
    "set_clip_depth",
    "software_device",
]

Report = Callable[[int, int, str], None]
"""Receiver of the driver's messages: type and severity as in ``GL_KHR_debug``, and the text."""

CLIP_NEGATIVE_ONE_TO_ONE = 0x935E
CLIP_ZERO_TO_ONE = 0x935F
_LOWER_LEFT = 0x8CA1
_VERSION = (4, 5)
_EGL_CONTEXT_FLAGS, _EGL_DEBUG_BIT = 0x30FC, 1
_DEBUG_OUTPUT, _DEBUG_OUTPUT_SYNCHRONOUS = 0x92E0, 0x8242
_DebugCallback = ctypes.CFUNCTYPE(
    None,
    ctypes.c_uint,
    ctypes.c_uint,
    ctypes.c_uint,
    ctypes.c_uint,
    ctypes.c_int,
    ctypes.c_char_p,
    ctypes.c_void_p,
)
_debug_callbacks: dict[int, ctypes._CFunctionType] = {}  # by context, which calls them as long as it lives


class _NodeTree:
    """The part of networkx's ``DiGraph`` that pyrender's scene uses: nodes, each with one edge to its parent."""

    def __init__(self) -> None:
        self._parents: dict[Hashable, Hashable] = {}

    def add_node(self, node: Hashable) -> None:
        """Add a node, without a parent yet."""

    def add_edge(self, node: Hashable, parent: Hashable) -> None:
        """Set the parent of a node."""
        self._parents[node] = parent

    def neighbors(self, node: Hashable) -> Iterator[Hashable]:
        """Iterate over the one parent of a node."""
        return iter((self._parents[node],))

    def remove_node(self, node: Hashable) -> None:
        """Remove a node whose children are removed already."""
        del self._parents[node]

    def path(self, node: Hashable, root: Hashable) -> list[Hashable]:
        """List the nodes from one up to the root, both included."""
        path = [node]
        while path[-1] != root:
            path.append(self._parents[path[-1]])
        return path


del pyrender_egl.Platform.__del__
pyrender.scene.nx = SimpleNamespace(DiGraph=_NodeTree, shortest_path=_NodeTree.path)


class FunctionLoader:
    """Addresses of OpenGL's functions, for moderngl. Its own loader starts ``ldconfig``, which a worker's sandbox forbids."""

    def load_opengl_function(self, name: str) -> int:
        """Return the address of a function; 0 where the driver has none."""
        return ctypes.cast(EGL.eglGetProcAddress(name.encode()), ctypes.c_void_p).value or 0


def make_context(platform: pyrender_egl.EGLPlatform, *, debug: bool = False) -> None:
    """Initialise a platform and make its context current: OpenGL 4.5 core, or its own 4.1 where 4.5 is missing.

    Args:
        platform: platform that gets the context.
        debug: make a debug context, which checks more and can report (`report_to`).
    """
    _open_display(platform)
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
    version += [EGL.EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL.EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT]
    version += [_EGL_CONTEXT_FLAGS, _EGL_DEBUG_BIT if debug else 0, EGL.EGL_NONE]
    attributes = (EGL.EGLint * len(version))(*version)
    try:
        platform._egl_context = EGL.eglCreateContext(platform._egl_display, configs[0], EGL.EGL_NO_CONTEXT, attributes)
    except OpenGLError:  # PyOpenGL raises where EGL refuses
        platform.init_context()
    platform.make_current()
    if not GLQuerier.extensions:
        included = [name for _, names in VERSION_EXTENSIONS for name in names]  # by OpenGL 4.2
        count = GL.glGetIntegerv(GL.GL_NUM_EXTENSIONS)
        GLQuerier.extensions = [*(GL.glGetStringi(GL.GL_EXTENSIONS, i) for i in range(count)), *included]


def software_device() -> pyrender_egl.EGLDevice | None:
    """Find EGL's device that is a software rasteriser; None where EGL lists none."""
    return next(filter(_is_software, _devices()), None)


def hardware_devices() -> list[pyrender_egl.EGLDevice]:
    """List EGL's devices but for software rasterisers."""
    return [device for device in _devices() if not _is_software(device)]


def _devices() -> list[pyrender_egl.EGLDevice]:
    return [] if pyrender_egl._eglQueryDevicesEXT is None else pyrender_egl.query_devices()


def _is_software(device: pyrender_egl.EGLDevice) -> bool:
    extensions = pyrender_egl._eglQueryDeviceStringEXT(device._display, EGL.EGL_EXTENSIONS) or b""
    return b"EGL_MESA_device_software" in extensions.split()


def _open_display(platform: pyrender_egl.EGLPlatform) -> None:
    """Open the display of a platform's device, as pyrender's ``init_context`` does before it makes a context of its own.

    Raises:
        OpenGLError: EGL refuses.
    """
    screen = os.environ.pop("DISPLAY", None)  # of X, which a device without a screen does not have
    try:
        platform._egl_display = platform._egl_device.get_display()
    finally:
        if screen is not None:
            os.environ["DISPLAY"] = screen
    EGL.eglInitialize(platform._egl_display, ctypes.c_long(), ctypes.c_long())
    EGL.eglBindAPI(EGL.EGL_OPENGL_API)


def release_context(platform: pyrender_egl.EGLPlatform) -> None:
    """Destroy a platform's context, if it has one. pyrender's own way terminates the display, and with it every context of the
    process.

    Args:
        platform: platform whose context is destroyed.
    """
    if platform._egl_context is None:
        return
    EGL.eglMakeCurrent(platform._egl_display, EGL.EGL_NO_SURFACE, EGL.EGL_NO_SURFACE, EGL.EGL_NO_CONTEXT)
    EGL.eglDestroyContext(platform._egl_display, platform._egl_context)
    _debug_callbacks.pop(_address(platform), None)
    platform._egl_context = None


def report_to(platform: pyrender_egl.EGLPlatform, report: Report) -> None:
    """Have the driver report errors and undefined use of the current context, before the call that causes them returns.

    Args:
        platform: platform of the context, which was made with ``debug``.
        report: called with each message; an exception that it raises is lost.
    """

    def receive(
        source: int, kind: int, number: int, severity: int, length: int, text: bytes, parameter: int | None
    ) -> None:
        report(kind, severity, text[:length].decode(errors="replace"))

    callback = _debug_callbacks[_address(platform)] = _DebugCallback(receive)
    GL.glEnable(_DEBUG_OUTPUT)
    GL.glEnable(_DEBUG_OUTPUT_SYNCHRONOUS)
    _gl_function("glDebugMessageCallback", _DebugCallback, ctypes.c_void_p)(callback, None)


def query_integers(name: int, count: int) -> list[int]:
    """``glGetIntegerv`` of a name that PyOpenGL does not know, as of an extension, which has ``count`` values."""
    values = (ctypes.c_int * count)()
    _gl_function("glGetIntegerv", ctypes.c_uint, ctypes.c_void_p)(name, values)
    return list(values)


def set_clip_depth(mode: int) -> None:
    """``glClipControl`` with the origin at the lower left; ``mode`` is one of the two constants of this module."""
    _gl_function("glClipControl", ctypes.c_uint, ctypes.c_uint)(_LOWER_LEFT, mode)


def read_first_texel(array: int, layer: int) -> tuple[float, float]:
    """First texel of a layer of an array texture of the format RG32F, by its OpenGL name (``glGetTextureSubImage``)."""
    texel = np.zeros(2, np.float32)
    whole, unsigned = ctypes.c_int, ctypes.c_uint
    get = _gl_function("glGetTextureSubImage", unsigned, *(whole,) * 7, unsigned, unsigned, whole, ctypes.c_void_p)
    get(array, 0, 0, 0, layer, 1, 1, 1, int(GL.GL_RG), int(GL.GL_FLOAT), texel.nbytes, texel.ctypes.data)
    return float(texel[0]), float(texel[1])


def half_float_image(pixels: NDArray[np.float16]) -> None:
    """Fill the bound 2D texture with ``(height, width, 4)`` half floats, or the bound array of ``count`` with as many images.

    PyOpenGL 3.1.0's own call has no half floats. Images of an array are ``(count, height, width, 4)``.
    """
    data = np.ascontiguousarray(pixels, np.float16)
    content = (0, GL.GL_RGBA, GL.GL_HALF_FLOAT, ctypes.c_void_p(data.ctypes.data))
    GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
    if data.ndim == 4:
        count, height, width = data.shape[:3]
        raw_tex_image_3d(GL.GL_TEXTURE_2D_ARRAY, 0, GL.GL_RGBA16F, width, height, count, *content)
    else:
        height, width = data.shape[:2]
        raw_tex_image_2d(GL.GL_TEXTURE_2D, 0, GL.GL_RGBA16F, width, height, *content)


@cache
def _gl_function(name: str, *arguments: type) -> ctypes._CFunctionType:
    """Function of the driver that PyOpenGL does not know, without a result."""
    address = FunctionLoader().load_opengl_function(name)
    if not address:
        raise GraphicsError(f"the driver has no {name}; OpenGL 4.5 is needed")
    return ctypes.CFUNCTYPE(None, *arguments)(address)


def _address(platform: pyrender_egl.EGLPlatform) -> int:
    """Address of a platform's context."""
    return ctypes.cast(platform._egl_context, ctypes.c_void_p).value or 0
