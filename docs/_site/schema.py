"""The reference of the camera schemas, from usd_schemas/schema.usda; its introduction is usd_schemas/README.md."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from pxr import Sdf

from docs._site.markdown import anchor, plain


def page(root: Path) -> str:
    """The folder's README, and below it every property of every schema."""
    text = (root / "usd_schemas/README.md").read_text(encoding="utf-8").rstrip() + "\n\n"
    layer = Sdf.Layer.OpenAsAnonymous(str(root / "usd_schemas/schema.usda"))
    for prim in layer.rootPrims:
        if prim.specifier == Sdf.SpecifierClass:
            text += _schema(prim)
    return text


def _schema(prim: Any) -> str:
    text = f"## {prim.name} {{ #{anchor(prim.name)} }}\n\n{_documentation(prim)}\n\n"
    groups: dict[str, list[Any]] = {}
    for prop in prim.properties:
        groups.setdefault(prop.GetInfo("displayGroup") or prim.name, []).append(prop)
    for name, properties in groups.items():
        if len(groups) > 1:
            text += f"### {name} {{ #{anchor(prim.name + ' ' + name)} }}\n\n"
        text += "".join(_property(prim, prop) for prop in properties)
    return text


def _property(prim: Any, prop: Any) -> str:
    facts = [f"`{_type(prop)}`"]
    if (tokens := prop.GetInfo("allowedTokens")) is not None and len(tokens):
        facts.append("one of " + ", ".join(f"`{token}`" for token in tokens))
    if isinstance(prop, Sdf.AttributeSpec) and prop.default not in (None, ""):
        facts.append(f"default `{_number(prop.default)}`")
    facts += _limits(prop)
    text = f"#### `{prop.name}` {{ #{anchor(prim.name + ' ' + prop.name)} }}\n\n"
    return text + "; ".join(facts) + "\n{ .property-facts }\n\n" + _documentation(prop) + "\n\n"


def _type(prop: Any) -> str:
    if isinstance(prop, Sdf.RelationshipSpec):
        return "rel"
    uniform = "uniform " if prop.variability == Sdf.VariabilityUniform else ""
    return f"{uniform}{prop.typeName}"


def _number(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _limits(prop: Any) -> list[str]:
    limits = prop.GetInfo("limits") or {}
    texts = []
    for kind, name in (("hard", "range"), ("soft", "slider")):
        low, high = (limits.get(kind, {}).get(end) for end in ("minimum", "maximum"))
        if low is not None or high is not None:
            ends = [f"from {_number(low)}"] if low is not None else []
            ends += [f"to {_number(high)}"] if high is not None else []
            texts.append(f"{name} {' '.join(ends)}")
    return texts


def _documentation(spec: Any) -> str:
    """The documentation as Markdown: indented lines flush, an empty line before a list."""
    lines = [line.strip() for line in spec.documentation.strip().splitlines()]
    out: list[str] = []
    for line in lines:
        starts_list = line.startswith("- ") and out and out[-1] and not out[-1].startswith("- ")
        ends_list = line.startswith("Unit:") and out and out[-1]
        out += [""] if starts_list or ends_list else []
        out.append(plain(line))
    return "\n".join(out)
