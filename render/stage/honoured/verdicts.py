"""Verdicts on prims: which of their schemas and properties are not honoured, by the rules and USD's schema registry."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from pxr import Plug, Usd

from render.stage.honoured.rules import FILTER_TYPES, IGNORED_SCHEMAS, NAMED_SCHEMAS, NEUTRAL_PLUGINS, RULES, Ruling
from render.stage.values import schema_type

_INSTANCE = f":{Usd.SchemaRegistry.MakeMultipleApplyNameTemplate('', '')}"


@dataclass
class Verdict:
    """Verdict on all prims of one type with the same applied schemas.

    Attributes:
        unknown: type and schemas that USD does not know.
        schemas: type and schemas that are not honoured as a whole, each with what is drawn instead, or an empty string.
        rulings: on each property that the other schemas declare.
    """

    unknown: list[str] = field(default_factory=list)
    schemas: dict[str, str] = field(default_factory=dict)
    rulings: dict[str, Ruling] = field(default_factory=dict)

    @cached_property
    def ignored(self) -> dict[str, str]:
        """Properties that are not honoured and that no other finding names, each with what is drawn instead, if known."""
        return {name: ruling.text for name, ruling in self.rulings.items() if ruling.status == "ignored"}


def judge(prim: Usd.Prim) -> Verdict:
    """Judge a prim by its type and its applied schemas, whatever is authored on it.

    Args:
        prim: any prim.
    """
    info, definition, kind = prim.GetPrimTypeInfo(), prim.GetPrimDefinition(), schema_type(prim)
    applied, authored = definition.GetAppliedAPISchemas(), info.GetAppliedAPISchemas()
    verdict = Verdict([f"schema {schema}" for schema in authored if schema not in applied])
    if info.GetTypeName() and not kind and info.GetTypeName() not in FILTER_TYPES:
        verdict.unknown.append(f"type {info.GetTypeName()}")
    bases = _bases(kind)
    if kind and not _is_ruled(kind):
        if not NAMED_SCHEMAS.keys() & set(bases):
            verdict.schemas[f"type {kind}"] = IGNORED_SCHEMAS.get(kind, "")
        return verdict  # the prim is named, with all that is on it
    judged = list(applied)
    for schema in applied:
        name = _name(schema)
        if schema in authored and not _is_ruled(name, schema):
            whole = _definition(name).GetAppliedAPISchemas()
            judged = [other for other in judged if other not in (schema, *whole)]
            if name not in NAMED_SCHEMAS:
                verdict.schemas[f"schema {schema}"] = IGNORED_SCHEMAS.get(name, "")
    owners = _owners(applied)
    for name in definition.GetPropertyNames():
        owner, bare_name = owners.get(name, (kind, name))
        if owner == kind or owner in judged:
            verdict.rulings[name] = _rule(bare_name, (*bases, owner, _name(owner)))
    return verdict


def _rule(name: str, schemas: Sequence[str]) -> Ruling:
    """The first ruling on a property, by the schemas that may have one; the last declares it."""
    reason = neutral_reason(schemas[-1])
    if reason:
        return Ruling("neutral", reason)
    rulings = (RULES[schema].ruling(name) for schema in schemas if schema in RULES)
    return next((ruling for ruling in rulings if ruling is not None), Ruling("ignored"))


def _is_ruled(*schemas: str) -> bool:
    return any(schema in RULES for schema in schemas) or bool(neutral_reason(schemas[0]))


def neutral_reason(schema: str) -> str:
    """Reason why a schema has no effect on any picture; empty where it may have one."""
    plugin = Plug.Registry().GetPluginForType(Usd.SchemaRegistry.GetTypeFromSchemaTypeName(schema))
    return NEUTRAL_PLUGINS.get(plugin.name, "") if plugin else ""


def _bases(kind: str) -> tuple[str, ...]:
    """A type and the types that it derives from, nearest first."""
    types = Usd.SchemaRegistry.GetTypeFromSchemaTypeName(kind).GetAllAncestorTypes() if kind else ()
    return tuple(Usd.SchemaRegistry.GetSchemaTypeName(base) for base in types)


def _name(schema: str) -> str:
    """Name of an applied schema without its instance's."""
    return str(Usd.SchemaRegistry.GetTypeNameAndInstance(schema)[0])


def _definition(name: str) -> Usd.PrimDefinition:
    return Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(name)


def _owners(applied: Iterable[str]) -> dict[str, tuple[str, str]]:
    """The applied schema that declares each property, and the property's name without the instance's; the last one wins, since
    schemas come before those that they include."""
    owners = {}
    for schema in applied:
        name, instance = Usd.SchemaRegistry.GetTypeNameAndInstance(schema)
        for property_name in _definition(name).GetPropertyNames():
            actual = (
                Usd.SchemaRegistry.MakeMultipleApplyNameInstance(property_name, instance) if instance else property_name
            )
            owners[actual] = (schema, property_name.replace(_INSTANCE, ""))
    return owners
