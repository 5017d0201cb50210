"""The reference of the service's settings, from the docstring and the defaults of its `Settings`."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import Any

from docs._site.markdown import table
from service.http.configuration import setting_types
from service.http.settings import Settings

_HEAD = """# Settings of the service

`pullfocus serve --config FILE` reads them from a TOML file. A section may group them: `[limits]`, for example.

"""
_ATTRIBUTE = re.compile(r"^ {8}(\w+): (.*(?:\n {12}.*)*)", re.MULTILINE)


def page() -> str:
    """Every setting with its default."""
    meanings = dict(_ATTRIBUTE.findall(Settings.__doc__ or ""))
    defaults = {field.name: getattr(Settings(), field.name) for field in fields(Settings)}
    return _HEAD + table(
        ("setting", "meaning", "default"),
        ([f"`{name}`", " ".join(meanings[name].split()), _toml(defaults[name])] for name in setting_types()),
    )


def _toml(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return f"`{value}`".lower()
    if isinstance(value, int | float):
        return f"`{value}`"
    if isinstance(value, tuple):
        return "`[" + ", ".join(f'"{item}"' for item in value) + "]`"
    return f"`{value}`".replace(str(Path.home()), "~")
