"""Configuration file of the service: the fields of `Settings` by name, in TOML.

A section groups settings and means nothing else: ``max_upload_mb`` may stand alone or in any section. In a section whose name is
the first word of a setting, the rest of that name is enough: ``[log] format`` is ``log_format``.
"""

from __future__ import annotations

import math
import tomllib
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from render.errors import SettingsError
from render.near_names import hint
from service.http.settings import Settings

_NOT_IN_FILES = frozenset({"static"})  # a part of the program
_WORDS = {
    str: "a text",
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    Path: "the path of a folder, as a text",
}


def read_configuration(file: Path) -> dict[str, Any]:
    """Read a configuration file.

    Args:
        file: TOML. Paths in it are relative to its folder; ``~`` is the home folder.

    Returns:
        The settings that it names, as keyword arguments of `Settings`.

    Raises:
        SettingsError: the file cannot be read, names no setting of the service, or gives one a value of another type.
    """
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise SettingsError(f"the configuration {file} cannot be read: {error.strerror}", code="bad_config") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"the configuration {file} is no TOML: {error}", code="bad_config") from error
    except RecursionError as error:
        raise SettingsError(f"the configuration {file} is nested too deeply", code="bad_config") from error
    settings: dict[str, Any] = {}
    for written, name, value in _entries(content):
        where = f"{file}: {written}"
        if name not in setting_types():
            raise SettingsError(f"{where} is no setting: {hint(name, setting_types())}", code="bad_config")
        if name in settings:
            raise SettingsError(f"{where} is set a second time", code="bad_config")
        settings[name] = _converted(value, setting_types()[name], where, file.absolute().parent)
    return settings


def setting_types() -> dict[str, Any]:
    """Types of the settings that a configuration may name."""
    hints = typing.get_type_hints(Settings)
    return {field.name: hints[field.name] for field in fields(Settings) if field.name not in _NOT_IN_FILES}


def _entries(content: Mapping[str, Any]) -> Iterator[tuple[str, str, Any]]:
    """Yield each value as it is written, with the name of its setting."""
    for key, value in content.items():
        if not isinstance(value, dict):
            yield key, key, value
            continue
        for inner, setting in value.items():
            whole = f"{key}_{inner}"
            yield f"[{key}] {inner}", whole if whole in setting_types() else inner, setting


def _converted(value: Any, expected: Any, where: str, folder: Path) -> Any:
    """Return a value of TOML as a value of a setting.

    Raises:
        SettingsError: it is of another type, or a number that no limit can be.
    """
    if get_origin(expected) is Literal:
        if value not in get_args(expected):
            words = hint(str(value), get_args(expected))
            raise SettingsError(f"{where} = {value!r} is none of its values: {words}", code="bad_config")
        return value
    if get_origin(expected) is tuple:
        if not isinstance(value, list):
            raise SettingsError(f"{where} takes a list in [ ], got {value!r}", code="bad_config")
        return tuple(_converted(item, get_args(expected)[0], where, folder) for item in value)
    if get_origin(expected) in (types.UnionType, typing.Union):  # a value or None; TOML has no None
        return _converted(value, next(kind for kind in get_args(expected) if kind is not type(None)), where, folder)
    if expected is Path and isinstance(value, str):
        return folder / Path(value).expanduser()
    if expected is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if type(value) is not expected:
        raise SettingsError(f"{where} takes {_WORDS[expected]}, got {value!r}", code="bad_config")
    if expected in (int, float) and not (math.isfinite(value) and value >= 0):
        raise SettingsError(f"{where} = {value} is no limit: it takes a number that is not negative", code="bad_config")
    return value
