"""Writes schema.usda, which usdGenSchema reads, from the declarations of `usd_schemas.settings`."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import Any

from usd_schemas.settings.schemas import SCHEMAS, Schema
from usd_schemas.settings.setting import Asset, Limits, Setting

WIDTH = 120
_HEAD = '''#usda 1.0
(
    """The camera, lens, aperture, film and focus schemas of Pullfocus.

    Generated from the declarations in usd_schemas/settings by `python -m usd_schemas.generate` (`make schema`): do not edit.
    usdGenSchema makes generatedSchema.usda and plugInfo.json of it. All three are checked in; a test holds them current.

    Rules that hold throughout:
    - The schemas are an interchange contract: they say what the shot asks of a camera. Which of it a renderer honours is
      for that renderer to state; Pullfocus names what it does not honour in `pullfocus inspect`.
    - What UsdGeomCamera already says is not said again: focalLength, apertures and their offsets, focusDistance, fStop,
      shutter:*, exposure:*. Hydra's own camera names are used where it has them: lensDistortion:*, splitDiopter:*.
    - Lens and film lengths are absolute millimetres, whatever metersPerUnit says, so that a lens can be referenced into
      any stage. Positions in the scene are scene units, as everywhere in USD. Angles are degrees.
    - What is not `uniform` may be animated. A `double` may hold a native spline; the rest hold time samples.
    - Each property's documentation ends with its unit. Hard limits are what makes sense; soft limits are what a slider
      should span."""
    subLayers = [
        @usdGeom/schema.usda@
    ]
)

over "GLOBAL" (
    customData = {
        string libraryName = "pullfocus"
        string libraryPath = "."
        string libraryPrefix = "Pullfocus"
        bool skipCodeGeneration = true
    }
)
{
}
'''
"""Rules of the schemas, in words, and what usdGenSchema is to make of them."""


def schema_source() -> str:
    """The text of schema.usda."""
    parts = [_HEAD.rstrip(), *map(_schema, SCHEMAS), _lens_camera()]
    return "\n\n".join(parts) + "\n"


def _schema(schema: Schema) -> str:
    kind = "multipleApply" if schema.prefix else "singleApply"
    prefix = f'        token propertyNamespacePrefix = "{schema.prefix}"\n' if schema.prefix else ""
    properties = "\n".join(line for setting in schema.settings for line in _property(setting))
    return (
        f'class "{schema.name}" (\n'
        "    inherits = </APISchemaBase>\n"
        "    customData = {\n"
        f'        token apiSchemaType = "{kind}"\n'
        f"{prefix}"
        '        token[] apiSchemaCanOnlyApplyTo = ["Camera"]\n'
        "    }\n"
        f"{_doc(schema.doc, '', 4)}\n"
        ")\n"
        "{\n"
        f"{properties}\n"
        "}"
    )


def _property(setting: Setting) -> Iterator[str]:
    uniform = "" if setting.keyable else "uniform "
    value = f" = {_value(setting.default)}" if setting.default != Asset() else ""
    yield (
        f"    rel {setting.usd} ("
        if setting.relationship
        else f"    {uniform}{setting.usd_type} {setting.usd}{value} ("
    )
    if setting.choices:
        yield f"        allowedTokens = {_value(list(setting.choices))}"
    yield f'        displayGroup = "{setting.group}"'
    yield f'        displayName = "{setting.label}"'
    yield _doc(setting.doc, f"Unit: {setting.unit}.", 8)
    yield from _limits(setting)
    yield "    )"


def _limits(setting: Setting) -> Iterator[str]:
    if setting.hard == setting.soft == (None, None):
        return
    number = "int" if setting.usd_type == "int" else "double"
    yield "        limits = {"
    for name, limits in (("hard", setting.hard), ("soft", setting.soft)):
        if limits != (None, None):
            yield f"            dictionary {name} = {{"
            yield from _ends(number, limits)
            yield "            }"
    yield "        }"


def _ends(number: str, limits: Limits) -> Iterator[str]:
    for name, end in zip(("minimum", "maximum"), limits, strict=True):
        if end is not None:
            yield f"                {number} {name} = {_value(end)}"


def _value(value: Any) -> str:
    """A value as usda writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list) or value == ():
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, tuple):
        return f"({', '.join(map(_value, value))})"
    return f"{value:g}" if value == int(value) else repr(value)


def _doc(text: str, unit: str, indent: int) -> str:
    """Documentation, wrapped; a list's entries begin their lines."""
    lines: list[str] = []
    for paragraph in [*text.split("\n"), *([unit] if unit else [])]:
        is_entry = paragraph.startswith("- ")
        first = " " * indent if lines else " " * indent + 'doc = """'
        later = " " * (indent + 2 if is_entry else indent)
        lines += textwrap.wrap(
            paragraph,
            WIDTH,
            initial_indent=first,
            subsequent_indent=later,
            break_long_words=False,
            break_on_hyphens=False,
        )
    return "\n".join(lines) + '"""'


def _lens_camera() -> str:
    names = ", ".join(f'"{schema.name}"' for schema in SCHEMAS if not schema.prefix)
    doc = _doc(
        "A Camera with the lens, aperture, tilt-shift, film and focus schemas built in, for those who control their pipeline. "
        "Hydra and most importers look for the exact type Camera: for interchange use a Camera with the schemas applied, which "
        "`usd_schemas.export_portable` makes of this one.",
        "",
        4,
    )
    return (
        'class LensCamera "LensCamera" (\n'
        "    inherits = </Camera>\n"
        f"    prepend apiSchemas = [{names}]\n"
        "    customData = {\n"
        '        token[] fallbackTypes = ["Camera"]\n'
        "    }\n"
        f"{doc}\n"
        ")\n"
        "{\n"
        "}"
    )
