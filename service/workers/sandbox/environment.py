"""Environment of a worker: an allow list, so that no secret of the service's environment reaches what parses uploads."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

_ALLOWED = frozenset(
    {
        # Language and time zone of texts and times.
        "LANG",
        "TZ",
        # The program and its libraries.
        "LD_LIBRARY_PATH",
        "PYTHONPATH",
        # Which driver of OpenGL draws, on which device, with how many threads.
        "CUDA_VISIBLE_DEVICES",
        "DRI_PRIME",
        "EGL_PLATFORM",
        "GALLIUM_DRIVER",
        "LIBGL_ALWAYS_SOFTWARE",
        "LIBGL_DRIVERS_PATH",
        "LP_NUM_THREADS",
        "MESA_GLSL_VERSION_OVERRIDE",
        "MESA_GL_VERSION_OVERRIDE",
        "MESA_LOADER_DRIVER_OVERRIDE",
        "MESA_SHADER_CACHE_DISABLE",
        "NVIDIA_DRIVER_CAPABILITIES",
        "NVIDIA_VISIBLE_DEVICES",
        "PYOPENGL_PLATFORM",
        "VK_DRIVER_FILES",
        "VK_ICD_FILENAMES",
        "__EGL_EXTERNAL_PLATFORM_CONFIG_DIRS",
        "__EGL_VENDOR_LIBRARY_DIRS",
        "__EGL_VENDOR_LIBRARY_FILENAMES",
        # Choices of the administrator's: the OpenColorIO configuration of shots that name none, and USD's number of threads.
        "OCIO",
        "PXR_WORK_THREAD_LIMIT",
        "PULLFOCUS_GL_DEBUG",
        "PULLFOCUS_NO_GPU",
    }
)
_ALLOWED_BEGINNING = "LC_"
NO_HOME = "/nonexistent"


def worker_environment(environ: Mapping[str, str]) -> dict[str, str]:
    """Return the environment of a worker process, which `cache_environment` completes.

    Args:
        environ: the service's own; what is not on the list is left out.
    """
    kept = {name: value for name, value in environ.items() if name in _ALLOWED or name.startswith(_ALLOWED_BEGINNING)}
    if environ.get("PULLFOCUS_CACHE") == "off":
        kept["PULLFOCUS_CACHE"] = "off"
    return kept | {
        "HOME": NO_HOME,
        "OPENBLAS_NUM_THREADS": "1",  # no thread is to exist before the worker enters its sandbox
        "PYTHONDONTWRITEBYTECODE": "1",  # the program's folders are read-only
    }


def cache_environment(cache: Path) -> dict[str, str]:
    """Return what names the folder for compiled shaders, for arrays kept between runs and for temporary files.

    Args:
        cache: the folder, which the worker may write.
    """
    return {
        "TMPDIR": str(cache),
        "MPLCONFIGDIR": str(cache),
        "XDG_CACHE_HOME": str(cache),
        "__GL_SHADER_DISK_CACHE_PATH": str(cache),  # of NVIDIA's driver
    }
