"""Options of `pullfocus render`: one for each setting that a render has, from the model of its request."""

from __future__ import annotations

import argparse
import types
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import ValidationError

from render.errors import SettingsError
from service.client import RenderSettings
from service.jobs.frame_ranges import parse_frames
from service.models.renders import RenderRequest

_FIRST = ("frames", "name", "priority", "camera", "width", "height", "lens", "formats", "products", "aovs")
_SETTINGS = [name for name in RenderRequest.model_fields if name != "shot"]
_METAVARS = {"frames": "RANGE", "camera": "PATH", "width": "PX", "height": "PX"}
_OPTIONS = {"formats": "format"}
_KINDS: dict[Any, Any] = {int: int, float: float, str: str}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_settings`."""
    group = parser.add_argument_group("the pictures")
    for name in sorted(_SETTINGS, key=lambda name: (name not in _FIRST, _SETTINGS.index(name))):
        field = RenderRequest.model_fields[name]
        kind = _plain(field.annotation)
        arguments: dict[str, Any] = {
            "default": argparse.SUPPRESS,
            "help": _help(field.description or name, field.default),
        }
        if kind is bool:
            arguments["action"] = argparse.BooleanOptionalAction
        elif get_origin(kind) is list:
            choices = get_args(_plain(get_args(kind)[0]))
            arguments |= {"nargs": "*" if name == "formats" else "+", "dest": name} | (
                {"choices": choices} if choices else {"metavar": "NAME"}
            )
        elif get_origin(kind) is Literal:
            arguments["choices"] = get_args(kind)
        else:
            arguments |= {"type": _KINDS[kind], "metavar": _METAVARS.get(name, "TEXT" if kind is str else "N")}
        group.add_argument(f"--{_option(name)}", **arguments)


def read_settings(typed: argparse.Namespace) -> RenderSettings:
    """Return those settings that were typed.

    Args:
        typed: as `add_arguments` declares them.

    Raises:
        SettingsError: a value is out of its limits, or the frames are no range.
    """
    given: Any = {name: getattr(typed, name) for name in _SETTINGS if hasattr(typed, name)}
    try:
        RenderRequest.model_validate({"shot": "shot"} | given)
    except ValidationError as error:
        first = error.errors()[0]
        if not first["loc"]:  # of all of them together
            raise SettingsError(first["msg"]) from error
        name = str(first["loc"][0])
        raise SettingsError(f"--{_option(name)}: {first['msg']}, got {first['input']!r}") from error
    if given.get("frames") is not None:
        parse_frames(given["frames"])
    settings: RenderSettings = given
    return settings


def _option(name: str) -> str:
    """Return the name of the option of a setting."""
    return _OPTIONS.get(name, name).replace("_", "-")


def _plain(annotation: Any) -> Any:
    """Return the type of a field without null and without its limits."""
    if get_origin(annotation) in (Union, types.UnionType):
        (annotation,) = (part for part in get_args(annotation) if part is not types.NoneType)
    if get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    return annotation


def _help(described: str, default: Any) -> str:
    text = described.rstrip(".").replace("%", "%%")
    if default in (None, "", []):
        return text
    shown = (
        " ".join(default)
        if isinstance(default, list)
        else str(default).lower()
        if isinstance(default, bool)
        else default
    )
    return f"{text} (default: {shown})"
