"""Files that the program itself needs, measured with strace on Debian: its code, shared libraries and drivers' files."""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

_PACKAGES = ("usd_schemas", "render", "service")
_LIBRARIES = ("/usr/lib", "/usr/lib64", "/usr/local/lib", "/usr/local/nvidia", "/lib", "/lib64", "/etc/ld.so.cache")
_TIME_ZONES = ("/usr/share/zoneinfo", "/etc/localtime")
_KERNEL = (
    "/dev/urandom",
    "/proc/self",
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/sys/devices/system/cpu",
    "/sys/devices/system/node",
)
_DRIVERS = tuple(
    f"{folder}/{name}"
    for folder in ("/etc", "/usr/share", "/usr/local/share")
    for name in ("glvnd", "egl", "drirc", "drirc.d", "vulkan", "nvidia", "libdrm")
)
"""Which drivers of OpenGL there are, and their settings for programs."""
_GRAPHICS_OF_KERNEL = ("/sys/dev/char", "/sys/devices", "/sys/bus/pci/devices", "/sys/class/drm", "/proc/driver/nvidia")
"""Files by which a driver finds its device."""
_GRAPHICS_DEVICES = ("/dev/dri", "/dev/udmabuf")
_LISTS_OF_FOLDERS = (
    "LD_LIBRARY_PATH",
    "LIBGL_DRIVERS_PATH",
    "__EGL_VENDOR_LIBRARY_DIRS",
    "__EGL_EXTERNAL_PLATFORM_CONFIG_DIRS",
)
_LISTS_OF_FILES = ("__EGL_VENDOR_LIBRARY_FILENAMES", "VK_DRIVER_FILES", "VK_ICD_FILENAMES")


def program_paths() -> tuple[Path, ...]:
    """Return the files and folders that any worker reads; those that do not exist are among them.

    Names of folders and files that the environment gives for libraries, drivers and OpenColorIO's configuration are included: the
    administrator set them. A configuration's own folder is, too, for the tables that it names.
    """
    schemes = sysconfig.get_paths()
    code = (schemes[name] for name in ("stdlib", "platstdlib", "purelib", "platlib"))
    fixed = (sysconfig.get_config_var("LIBDIR") or "", *_LIBRARIES, *_TIME_ZONES, *_KERNEL, *_DRIVERS)
    paths = (*code, *_packages(), *_sites(), *fixed, *_of_environment())
    return tuple(dict.fromkeys(Path(path) for path in paths if os.path.isabs(path)))


def graphics_paths() -> tuple[Path, ...]:
    """Return the kernel's files by which a driver of OpenGL finds its device."""
    return tuple(map(Path, _GRAPHICS_OF_KERNEL))


def graphics_devices() -> tuple[Path, ...]:
    """Return the devices that draw: those of the kernel's drivers, and NVIDIA's."""
    return (*map(Path, _GRAPHICS_DEVICES), *Path("/dev").glob("nvidia*"))


def _packages() -> Iterator[str]:
    """List the folders of our own packages, which need not be among the installed ones."""
    for name in _PACKAGES:
        spec = find_spec(name)
        if spec is not None:
            yield from spec.submodule_search_locations or ()


def _sites() -> Iterator[str]:
    """List the folders of installed packages that Python searches, such as those of the user."""
    return (path for path in sys.path if Path(path).name in ("site-packages", "dist-packages", "lib-dynload"))


def _of_environment() -> Iterator[str]:
    for name in (*_LISTS_OF_FOLDERS, *_LISTS_OF_FILES):
        yield from os.environ.get(name, "").split(os.pathsep)
    config = os.environ.get("OCIO", "")
    if os.path.isfile(config):
        yield os.path.dirname(config)
