"""Colour into the working space, through OpenColorIO.

USD's own colours (authored constants, light colours, displayColor) are linear with Rec. 709 primaries. Textures say by their
``sourceColorSpace`` what they hold. All of it is converted to the working space, which is the role ``scene_linear`` of the
configuration: ACEScg in OpenColorIO's default one.
"""

from __future__ import annotations

import functools
import os
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio
from numpy.typing import NDArray

from render.errors import InputError, SettingsError

USD_LINEAR = "lin_rec709"
_WORKING_ROLE = ocio.ROLE_SCENE_LINEAR
_BUILTIN_NAMES = {"sRGB": "srgb_texture", "lin_rec709": "lin_rec709"}
_UNCONVERTED = ("raw", "data", "unknown", "identity", "")


def working_config(path: str | Path | None = None) -> ocio.Config:
    """The OpenColorIO configuration to work in.

    Args:
        path: a configuration file, or a built-in name such as ``ocio://default``; by default the environment variable
            ``OCIO`` where it is set, else OpenColorIO's default built-in configuration.

    Raises:
        SettingsError: the file is missing, damaged, or has no ``scene_linear`` role.
    """
    return _read_config(str(path or os.environ.get("OCIO") or "ocio://default"))


@functools.cache
def _read_config(name: str) -> ocio.Config:
    try:
        config = ocio.Config.CreateFromFile(name)
    except (ocio.Exception, ocio.ExceptionMissingFile) as error:
        reason = str(error).splitlines()[0]
        raise SettingsError(
            f"cannot read the OpenColorIO configuration {name}: {reason}", code="bad_colour_config"
        ) from error
    if not config.hasRole(_WORKING_ROLE):
        raise SettingsError(
            f"the OpenColorIO configuration {name} has no role {_WORKING_ROLE}, which is where rendering happens",
            code="bad_colour_config",
        )
    return config


def to_working(
    pixels: NDArray[np.float32], source: str = USD_LINEAR, config: ocio.Config | None = None
) -> NDArray[np.float32]:
    """Convert colours to the working space.

    Args:
        pixels: ``(..., 3)`` or ``(..., 4)`` float32; alpha passes through.
        source: ``sRGB``, ``raw``, or a colour space name that OpenColorIO's default configuration knows, such as
            ``lin_rec709`` or ``lin_ap1_scene``. ``raw`` and ``data`` are not converted.
        config: the configuration; by default ``working_config()``.

    Returns:
        A new array of the same shape.

    Raises:
        InputError: the source colour space is not known.
    """
    if source in _UNCONVERTED:
        return np.array(pixels, np.float32)
    return _apply(_to_working_processor(source, config or working_config()), pixels)


def linearise(pixels: NDArray[np.float32], source: str) -> NDArray[np.float32]:
    """Undo a colour space's transfer function and keep Rec. 709 primaries: for single channels that were stored as colour.

    Args:
        pixels: ``(..., 3)`` or ``(..., 4)`` float32.
        source: as for :func:`to_working`.

    Raises:
        InputError: the source colour space is not known.
    """
    if source in (*_UNCONVERTED, USD_LINEAR):
        return np.array(pixels, np.float32)
    return _apply(_linear_processor(source), pixels)


def rgb_to_working(rgb: tuple[float, float, float]) -> tuple[float, float, float]:
    """Convert one authored USD colour (linear Rec. 709) to the working space."""
    red, green, blue = to_working(np.array([rgb], np.float32))[0].tolist()
    return (red, green, blue)


@functools.lru_cache(maxsize=64)
def _to_working_processor(source: str, config: ocio.Config) -> ocio.CPUProcessor:
    try:
        return ocio.Config.GetProcessorFromBuiltinColorSpace(
            _BUILTIN_NAMES.get(source, source), config, _WORKING_ROLE
        ).getDefaultCPUProcessor()
    except ocio.Exception as error:
        raise InputError(
            f"colour space {source!r} is not known: expected sRGB, raw or a name of OpenColorIO's default configuration",
            code="unknown_colour_space",
        ) from error


@functools.lru_cache(maxsize=64)
def _linear_processor(source: str) -> ocio.CPUProcessor:
    builtin = ocio.Config.CreateFromBuiltinConfig("ocio://default")
    try:
        return builtin.getProcessor(_BUILTIN_NAMES.get(source, source), USD_LINEAR).getDefaultCPUProcessor()
    except ocio.Exception as error:
        raise InputError(f"colour space {source!r} is not known", code="unknown_colour_space") from error


def _apply(processor: ocio.CPUProcessor, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    out = np.array(pixels, np.float32, order="C")
    if out.size == 0:
        return out
    if out.shape[-1] == 4:
        processor.applyRGBA(out)
    else:
        processor.applyRGB(out)
    return out
