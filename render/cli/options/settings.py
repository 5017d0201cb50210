"""Options that set a declared setting of the camera for one run: each setting that declares an option has one."""

from __future__ import annotations

import argparse
import math
from typing import Any

from render.cli.options.shared import check_number
from render.errors import SettingsError
from usd_schemas.settings.setting import Option, Setting
from usd_schemas.settings.tables import SETTINGS

MAX_SECONDS = 1e6
"""The longest time that a shutter is open: twelve days."""
_TRIPLE = tuple[float, float, float]
_OPTIONS = [(item, item.option) for item in SETTINGS.values() if item.option is not None]


def add_settings(group: argparse._ArgumentGroup) -> None:
    """Add an option for each setting that declares one, for `read_settings`."""
    for setting, option in _OPTIONS:
        kind: dict[str, Any] = {}
        if setting.type is bool:
            kind = {"action": "store_const", "const": True}
        elif setting.choices:
            kind = {"choices": setting.choices}
        else:
            kind = {
                "metavar": option.metavar,
                "type": str if option.is_time or setting.type == _TRIPLE else setting.type,
            }
        group.add_argument(option.flag, dest=_dest(setting), help=_help(setting, option), **kind)


def read_settings(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the settings that were typed, by name.

    Args:
        arguments: as `add_settings` declares them.

    Raises:
        SettingsError: a value is out of its option's range, no time, or not the three numbers that it has to be.
    """
    typed = {setting.name: _value(setting, option, getattr(arguments, _dest(setting))) for setting, option in _OPTIONS}
    return {name: value for name, value in typed.items() if value is not None}


def read_seconds(option: str, typed: str) -> float:
    """Read seconds, or a fraction of them such as ``1/50``.

    Args:
        option: name of the option, for the message.
        typed: what the user typed.

    Raises:
        SettingsError: it is no time above 0 and up to `MAX_SECONDS`.
    """
    over, _, under = typed.partition("/")
    try:
        time_s = float(over) / float(under or 1)
    except (ValueError, ZeroDivisionError):
        time_s = math.nan
    if not 0 < time_s <= MAX_SECONDS:
        most = f", up to {MAX_SECONDS:g}" if time_s > MAX_SECONDS else ""
        raise SettingsError(f"{option} takes seconds such as 0.02 or 1/50{most}, got {typed!r}")
    return time_s


def _value(setting: Setting, option: Option, typed: Any) -> Any:
    if typed is not None and option.is_time:
        return read_seconds(option.flag, typed)
    if typed is not None and setting.type == _TRIPLE:
        return _read_triple(option.flag, typed)
    if option.range is not None:
        return check_number(option.flag, typed, option.range.least, option.range.most, option.noun)
    return typed


def _read_triple(flag: str, typed: str) -> tuple[float, float, float]:
    try:
        red, green, blue = (float(number) for number in typed.split(","))
    except ValueError:
        raise SettingsError(f"{flag} takes three numbers such as 1.515,1.521,1.528, got {typed[:40]!r}") from None
    return red, green, blue


def _dest(setting: Setting) -> str:
    """Attribute of the parsed arguments."""
    return f"setting_{setting.name}"


def _help(setting: Setting, option: Option) -> str:
    """The first sentence of the documentation, as help texts are written: without its capital and its full stop."""
    text = setting.help.rstrip(".")
    text = text if text[1].isupper() else text[0].lower() + text[1:]
    return (f"{text}; seconds such as 0.02 or 1/50" if option.is_time else text).replace("%", "%%")
