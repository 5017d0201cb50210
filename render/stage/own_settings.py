"""Settings of ours on a prim: attributes ``pullfocus:NAME`` of a RenderSettings or RenderProduct prim.

A name is that of a field of `render.model.frame_settings.FrameSettings` in camel case, such as ``pullfocus:motionBy``. Values
are those at the default time. What is no such name, or has another type, is a finding and counts for nothing.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from pxr import Usd

from render.model.frame_settings import FrameSettings
from render.near_names import hint
from render.stage.findings import FindingLog
from render.stage.values import format_value

NAMESPACE = "pullfocus:"
_FROM_ELSEWHERE = ("width", "height", "aovs")
"""Fields that resolution and orderedVars of UsdRender give."""


def own_names() -> dict[str, str]:
    """Fields of `FrameSettings` by the names of their attributes, without the namespace."""
    names = [field.name for field in fields(FrameSettings) if field.name not in _FROM_ELSEWHERE]
    return {_camel_case(name): name for name in names}


def read_own_settings(prim: Usd.Prim, log: FindingLog) -> dict[str, Any]:
    """Values of fields of `FrameSettings` that a prim authors.

    Args:
        prim: any prim.
        log: notes names that are not known, and values of another type.
    """
    known = own_names()
    found: dict[str, Any] = {}
    for attribute in prim.GetAuthoredAttributes():
        name = attribute.GetName()
        if not name.startswith(NAMESPACE):
            continue
        short, path = name.removeprefix(NAMESPACE), attribute.GetPath()
        if short not in known:
            log.add("unknown_setting", path, f"{path} is not used: {hint(short, list(known))}")
            continue
        field, value = known[short], attribute.Get()
        kind = type(getattr(FrameSettings, field))
        if kind is float and type(value) is int:
            value = float(value)
        if type(value) is not kind:
            message = f"{path} is not used: it must be {_KINDS[kind]}, got {format_value(value)}"
            log.add("bad_setting", path, message)
            continue
        found[field] = value
    return found


_KINDS = {int: "a whole number", float: "a number", bool: "true or false", str: "a token or string"}


def _camel_case(name: str) -> str:
    first, *others = name.split("_")
    return first + "".join(word.capitalize() for word in others)
