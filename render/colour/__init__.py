"""Colour into the working space, through OpenColorIO.

USD's own colours (authored constants, light colours, displayColor) are linear with Rec. 709 primaries. Textures say by their
``sourceColorSpace`` what they hold: in USD's words, or by a name, an alias or an input role (``texture_paint``) of the
configuration. All of it is converted to the working space, which is the role ``scene_linear`` of the configuration: ACEScg in
OpenColorIO's default one.
"""

from __future__ import annotations

import functools
import os
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio
from numpy.typing import NDArray

from render.colour.confined import ConfinedConfig, ConfinedConfigError, read_confined_config
from render.errors import InputError, SettingsError
from render.near_names import hint, near_names

USD_LINEAR = "lin_rec709"
_WORKING_ROLE = ocio.ROLE_SCENE_LINEAR
_BUILTIN_NAMES = {"sRGB": "srgb_texture", "lin_rec709": "lin_rec709"}
BUILTIN_PREFIX = "ocio://"
DEFAULT_CONFIG = "ocio://default"
_UNCONVERTED = ("raw", "data", "unknown", "identity", "")
# Messages that hold bytes of a damaged file cannot always be made Python strings.
ConfigSource = str | Path | ConfinedConfig | None
"""Configuration file or built-in name such as ``ocio://default``; None for what the environment variable ``OCIO`` names."""
OCIO_ERRORS = (ocio.Exception, ocio.ExceptionMissingFile, UnicodeDecodeError)


def working_config(path: ConfigSource = None) -> ocio.Config:
    """The OpenColorIO configuration to work in.

    Args:
        path: a configuration file, or a built-in name such as ``ocio://default``; by default the environment variable
            ``OCIO`` where it is set, else OpenColorIO's default built-in configuration. One that is confined reads nothing
            outside of its folder, and nothing of the environment.

    Raises:
        SettingsError: the file is missing, damaged, or has no ``scene_linear`` role.
    """
    stamp = file_stamp(path.path if isinstance(path, ConfinedConfig) else config_name(path))
    return _read_config(path if isinstance(path, ConfinedConfig) else config_name(path), stamp)


def config_name(path: ConfigSource = None) -> str:
    """The file or built-in name of a configuration; arguments as for `working_config`."""
    return str(path or os.environ.get("OCIO") or DEFAULT_CONFIG)


def file_stamp(name: str | Path) -> tuple[int, int]:
    """Stamp that changes when a file is rewritten: modification time (ns) and size; zeros where there is no file."""
    try:
        status = os.stat(name)
    except (OSError, ValueError):
        return (0, 0)
    return (status.st_mtime_ns, status.st_size)


def _read_config(source: str | ConfinedConfig, stamp: tuple[int, int]) -> ocio.Config:
    """A configuration with the role that is needed."""
    name = str(source)
    try:
        if isinstance(source, ConfinedConfig):
            config, _ = read_confined_config(source, stamp)
        else:
            config = _config_file(name, stamp)
    except (*OCIO_ERRORS, ConfinedConfigError) as error:
        raise SettingsError(
            f"cannot read the OpenColorIO configuration {name}: {_reason(name, error)}", code="bad_colour_config"
        ) from error
    if not config.hasRole(_WORKING_ROLE):
        raise SettingsError(
            f"the OpenColorIO configuration {name} has no role {_WORKING_ROLE}, which is where rendering happens",
            code="bad_colour_config",
        )
    return config


@functools.lru_cache(maxsize=32)
def _config_file(name: str, stamp: tuple[int, int]) -> ocio.Config:
    """A configuration file, or a built-in one; the stamp makes a file that was edited be read again."""
    del stamp
    return ocio.Config.CreateFromFile(name)


def _reason(name: str, error: Exception) -> str:
    """Why a configuration cannot be read, in one sentence."""
    if name.startswith(BUILTIN_PREFIX):
        known = ["default", "cg-config-latest", "studio-config-latest"]
        known += [row[0] for row in ocio.BuiltinConfigRegistry().getBuiltinConfigs()]
        return f"there is none built in of that name: {hint(name, (BUILTIN_PREFIX + own for own in known))}"
    if os.path.isdir(name):
        return "it is a folder, expected a file"
    if isinstance(error, UnicodeDecodeError):
        return "it is no text"
    # OpenColorIO names the file once more, in front of what is wrong with it.
    said = " ".join(str(error).split()).removeprefix(f"Error: Loading the OCIO profile '{name}' failed. ")
    return said.removeprefix("Error: Loading the OCIO profile failed. ")


def to_working(
    pixels: NDArray[np.float32], source: str = USD_LINEAR, config: ocio.Config | None = None
) -> NDArray[np.float32]:
    """Convert colours to the working space.

    Args:
        pixels: ``(..., 3)`` or ``(..., 4)`` float32; alpha passes through.
        source: ``sRGB``, ``raw``; or a colour space of the configuration, by name, alias or role; or one that OpenColorIO's
            default configuration knows, such as ``lin_rec709`` or ``lin_ap1_scene``. ``raw`` and ``data`` are not converted.
        config: the configuration; by default ``working_config()``.

    Returns:
        A new array of the same shape.

    Raises:
        InputError: the source colour space is not known.
    """
    if source in _UNCONVERTED:
        return np.array(pixels, np.float32)
    return _apply(_to_working_processor(source, config or working_config()), pixels)


def from_working(pixels: NDArray[np.float32], space: str, config: ocio.Config | None = None) -> NDArray[np.float32]:
    """Convert colours from the working space to another linear one.

    Args:
        pixels: ``(..., 3)`` or ``(..., 4)`` float32; alpha passes through.
        space: a linear colour space, named as for :func:`to_working`.
        config: the configuration; by default ``working_config()``.

    Raises:
        InputError: the colour space is not known, or not linear.
    """
    return _apply(_from_working_processor(space, config or working_config()), pixels)


def is_working_space(space: str) -> bool:
    """Whether a linear colour space is the working space under whatever name; errors as for :func:`from_working`."""
    return bool(_from_working_processor(space, working_config()).isNoOp())


def interop_id(space: str) -> str:
    """Colour interop id of a known colour space, such as ``lin_ap1_scene``; empty where the configuration gives none."""
    config = working_config()
    return str(_config_with(space, config).getColorSpace(_BUILTIN_NAMES.get(space, space)).getInteropID())


def linearise(pixels: NDArray[np.float32], source: str, config: ocio.Config | None = None) -> NDArray[np.float32]:
    """Undo a colour space's transfer function and keep Rec. 709 primaries: for single channels that were stored as colour.

    Args:
        pixels: ``(..., 3)`` or ``(..., 4)`` float32.
        source: as for :func:`to_working`.
        config: the configuration; by default ``working_config()``.

    Raises:
        InputError: the source colour space is not known.
    """
    if source in (*_UNCONVERTED, USD_LINEAR):
        return np.array(pixels, np.float32)
    return _apply(_linear_processor(source, config or working_config()), pixels)


def is_known(source: str, config: ocio.Config | None = None) -> bool:
    """Whether a colour space has a name that :func:`to_working` takes, and is converted."""
    own = config or working_config()
    return (
        source not in _UNCONVERTED
        and _config_with(source, own).getColorSpace(_BUILTIN_NAMES.get(source, source)) is not None
    )


def rgb_to_working(rgb: tuple[float, float, float]) -> tuple[float, float, float]:
    """Convert one authored USD colour (linear Rec. 709) to the working space."""
    red, green, blue = to_working(np.array([rgb], np.float32))[0].tolist()
    return (red, green, blue)


@functools.lru_cache(maxsize=64)
def _to_working_processor(source: str, config: ocio.Config) -> ocio.CPUProcessor:
    try:
        if _is_own(source, config):
            return config.getProcessor(source, _WORKING_ROLE).getDefaultCPUProcessor()
        return ocio.Config.GetProcessorFromBuiltinColorSpace(
            _BUILTIN_NAMES.get(source, source), config, _WORKING_ROLE
        ).getDefaultCPUProcessor()
    except OCIO_ERRORS as error:
        raise _unusable_space(source, config, error) from error


@functools.lru_cache(maxsize=64)
def _from_working_processor(space: str, config: ocio.Config) -> ocio.CPUProcessor:
    name = _BUILTIN_NAMES.get(space, space)
    try:
        if not _config_with(space, config).isColorSpaceLinear(name, ocio.REFERENCE_SPACE_SCENE):
            raise InputError(f"colour space {space!r} is not linear", code="nonlinear_space")
        if _is_own(space, config):
            return config.getProcessor(_WORKING_ROLE, space).getDefaultCPUProcessor()
        return ocio.Config.GetProcessorToBuiltinColorSpace(config, _WORKING_ROLE, name).getDefaultCPUProcessor()
    except OCIO_ERRORS as error:
        raise _unusable_space(space, config, error) from error


@functools.lru_cache(maxsize=64)
def _linear_processor(source: str, config: ocio.Config) -> ocio.CPUProcessor:
    try:
        if _is_own(source, config):
            return ocio.Config.GetProcessorToBuiltinColorSpace(config, source, USD_LINEAR).getDefaultCPUProcessor()
        return (
            working_config(DEFAULT_CONFIG)
            .getProcessor(_BUILTIN_NAMES.get(source, source), USD_LINEAR)
            .getDefaultCPUProcessor()
        )
    except OCIO_ERRORS as error:
        raise _unusable_space(source, config, error) from error


def _is_own(source: str, config: ocio.Config) -> bool:
    """Whether the configuration has such a space. USD's own words mean the same whatever configuration there is."""
    return source not in _BUILTIN_NAMES and config.getColorSpace(source) is not None


def _config_with(space: str, config: ocio.Config) -> ocio.Config:
    """The configuration that defines a colour space: the given one, else OpenColorIO's default."""
    return config if _is_own(space, config) else working_config(DEFAULT_CONFIG)


def _unusable_space(source: str, config: ocio.Config, error: Exception) -> InputError:
    if _is_own(source, config):
        reason = " ".join(str(error).split())
        return InputError(f"colour space {source!r} cannot be converted: {reason}", code="bad_colour_space")
    near = near_names(
        source, [*_BUILTIN_NAMES, *config.getColorSpaceNames(), *working_config(DEFAULT_CONFIG).getColorSpaceNames()]
    )
    meant = " or ".join(f"'{name}'" for name in near)
    expected = f"did you mean {meant}?" if near else "expected sRGB, raw or a name of the OpenColorIO configuration"
    return InputError(f"colour space {source!r} is not known: {expected}", code="unknown_colour_space")


def _apply(processor: ocio.CPUProcessor, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
    out = np.array(pixels, np.float32, order="C")
    if out.size == 0:
        return out
    if out.shape[-1] == 4:
        processor.applyRGBA(out)
    else:
        processor.applyRGB(out)
    return out
