"""The working colour space: the ``scene_linear`` role of an OpenColorIO configuration, and the way into it."""

from __future__ import annotations

import os
from functools import cache, lru_cache

import numpy as np
import PyOpenColorIO

from render.errors import SettingsError
from render.scene import FloatArray

BUILT_IN_CONFIG = "ocio://default"

# What UsdUVTexture and the older colorSpace metadata say, in the colour interop ids that USD and OpenColorIO share.
_USD_TOKENS = {"sRGB": "srgb_rec709_scene", "lin_rec709": "lin_rec709_scene", "raw": "data", "": "data"}
# Numbers that are no colours, or whose colours nobody knows: they are taken as they are.
_NOT_CONVERTED = frozenset({"data", "identity", "unknown"})


def working_config(path: str | os.PathLike[str] | None = None) -> PyOpenColorIO.Config:
    """The OpenColorIO configuration that says what the working space and the displays are. Read once and kept.

    Args:
        path: a file, or ``ocio://name`` for a built-in one; None takes what the environment variable ``OCIO`` names,
            else OpenColorIO's default built-in configuration (whose working space is ACEScg).

    Raises:
        SettingsError: it cannot be read, or has no ``scene_linear`` role.
    """
    return _read_config(os.fspath(path) if path is not None else os.environ.get("OCIO") or BUILT_IN_CONFIG)


def to_working(pixels: FloatArray, source: str, config_path: str | None = None) -> FloatArray:
    """Pixels converted from a colour space into the working space.

    Args:
        pixels: ``(..., 3 or 4)`` float32; a fourth channel, alpha, is left as it is.
        source: a USD token: ``sRGB``, ``raw``, ``lin_rec709``, or any name of USD's colour spaces
            (``srgb_p3d65_scene``) or of the configuration's. ``auto`` is decided by the caller.
        config_path: as `working_config`.

    Returns:
        A new contiguous float32 array of the same shape.

    Raises:
        SettingsError: nobody knows the colour space.
    """
    converted = np.array(pixels, np.float32, order="C")
    name = _USD_TOKENS.get(source, source)
    if name in _NOT_CONVERTED:
        return converted
    processor = _into_working(name, working_config(config_path).getCacheID(), config_path)
    # A single colour is a picture of one pixel to OpenColorIO.
    flat = converted.reshape(-1, converted.shape[-1])
    (processor.applyRGBA if converted.shape[-1] == 4 else processor.applyRGB)(flat)
    return converted


@cache
def _read_config(name: str) -> PyOpenColorIO.Config:
    try:
        config = PyOpenColorIO.Config.CreateFromFile(name)
    except (PyOpenColorIO.Exception, PyOpenColorIO.ExceptionMissingFile) as error:
        raise SettingsError(f"OpenColorIO configuration '{name}' cannot be read: {error}", code="bad_config") from error
    if not config.hasRole(PyOpenColorIO.ROLE_SCENE_LINEAR):
        raise SettingsError(
            f"OpenColorIO configuration '{name}' has no role '{PyOpenColorIO.ROLE_SCENE_LINEAR}' to work in",
            code="bad_config",
        )
    return config


@lru_cache(maxsize=64)
def _into_working(source: str, _config_id: str, config_path: str | None) -> PyOpenColorIO.CPUProcessor:
    """Processor from a named space to the working space (``_config_id`` tells configurations apart in the cache).

    A space that the configuration lacks is looked up in the built-in one, and the two are joined by their ACES
    interchange role.
    """
    config = working_config(config_path)
    try:
        if config.getColorSpace(source):
            return config.getProcessor(source, PyOpenColorIO.ROLE_SCENE_LINEAR).getDefaultCPUProcessor()
        built_in = _read_config(BUILT_IN_CONFIG)
        if built_in.getColorSpace(source):
            joined = PyOpenColorIO.Config.GetProcessorFromConfigs(
                built_in, source, config, PyOpenColorIO.ROLE_SCENE_LINEAR
            )
            return joined.getDefaultCPUProcessor()
    except (PyOpenColorIO.Exception, PyOpenColorIO.ExceptionMissingFile) as error:
        raise SettingsError(f"colour space '{source}' cannot be converted: {error}", code="bad_color_space") from error
    raise SettingsError(
        f"unknown colour space '{source}': expected sRGB, raw, or a name that OpenColorIO knows, like lin_rec709_scene",
        code="unknown_color_space",
    )
