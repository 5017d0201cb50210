"""Settings of ours on a prim: attributes ``pullfocus:NAME`` of a RenderSettings or RenderProduct prim.

A name is that of a field of `render.model.frame_settings.FrameSettings` in camel case, such as ``pullfocus:motionBy``. Values
are those at the default time. What is no such name, has another type or is out of range, is a finding and counts for nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, fields
from typing import Any

from pxr import Usd

from render.errors import SettingsError
from render.model.frame_settings import FrameSettings
from render.near_names import hint
from render.stage.findings import FindingLog
from render.stage.values import format_value

NAMESPACE = "pullfocus:"
_FROM_ELSEWHERE = ("width", "height", "aovs", "deep")
"""Fields that resolution, orderedVars and productType of UsdRender give."""


def own_fields() -> dict[str, Field[Any]]:
    """Fields of `FrameSettings` by the names of their attributes, without the namespace."""
    return {_camel_case(field.name): field for field in fields(FrameSettings) if field.name not in _FROM_ELSEWHERE}


def read_own_settings(prim: Usd.Prim, log: FindingLog) -> dict[str, Any]:
    """Values of fields of `FrameSettings` that a prim authors.

    Args:
        prim: any prim.
        log: notes names that are not known, and values of another type.
    """
    known = own_fields()
    found: dict[str, Any] = {}
    for attribute in prim.GetAuthoredAttributes():
        name = attribute.GetName()
        if not name.startswith(NAMESPACE):
            continue
        short, path = name.removeprefix(NAMESPACE), attribute.GetPath()
        if short not in known:
            log.add("unknown_setting", path, f"{path} is not used: {hint(short, list(known))}")
            continue
        value, (kind, words) = attribute.Get(), _KINDS[str(known[short].type)]
        if value is None:  # blocked
            continue
        if kind is float and type(value) is int:
            value = float(value)
        if type(value) is not kind:
            log.add("bad_setting", path, f"{path} is not used: it must be {words}, got {format_value(value)}")
            continue
        trial: dict[str, Any] = {known[short].name: value}
        try:
            FrameSettings(**trial)
        except SettingsError as error:
            log.add("bad_setting", path, f"{path} is not used: {error.detail}")
            continue
        found |= trial
    return found


def put_over(under: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """Settings of one source over those of another. A number of rays takes the place of a wanted noise."""
    settings = {**under, **over}
    if "rays" in over and "noise" not in over:
        settings.pop("noise", None)
    return settings


_KINDS = {
    "int": (int, "a whole number"),
    "float": (float, "a number"),
    "bool": (bool, "true or false"),
    "str": (str, "a token or string"),
}


def _camel_case(name: str) -> str:
    first, *others = name.split("_")
    return first + "".join(word.capitalize() for word in others)
