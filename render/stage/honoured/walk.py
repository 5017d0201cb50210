"""Walk over a stage that names each authored property that is not honoured."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Sdr, Tf, Usd, UsdShade

from render.stage.findings import Finding
from render.stage.honoured.rules import NODE_RULES
from render.stage.honoured.verdicts import Verdict, judge
from render.stage.opening import quiet_diagnostics
from render.stage.values import schema_type

# Prototypes of point instancers may be `over`s, which are not defined.
_LOADED = Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract
_PREVIEW_SURFACE = "UsdPreviewSurface"


def find_not_honoured(stage: Usd.Stage) -> list[Finding]:
    """Find each schema, and each property of a schema, that prims of a stage have and that is not honoured.

    A property counts where it is authored with another value than its fallback, with time samples, connections or
    targets. Prims with the same one make one finding together, at the first of them. Instances count once.

    Args:
        stage: the stage.
    """
    walk = _Walk()
    with quiet_diagnostics():
        for prim, path in _prims(stage):
            walk.visit(prim, path)
    return walk.findings()


class _Walk:
    def __init__(self) -> None:
        self._verdicts: dict[tuple[str, ...], Verdict] = {}
        self._nodes = {kind: _ignored_inputs(kind) for kind in NODE_RULES}
        self._found: dict[tuple[str, str, str], tuple[str, str, int]] = {}

    def visit(self, prim: Usd.Prim, path: str) -> None:
        """Note what is not honoured on a prim.

        Args:
            prim: any prim.
            path: that it has for the user.
        """
        info = prim.GetPrimTypeInfo()
        kind = info.GetSchemaTypeName()
        key = (info.GetTypeName(), kind, *info.GetAppliedAPISchemas())
        if key not in self._verdicts:
            self._verdicts[key] = judge(prim)
        verdict = self._verdicts[key]
        for schema in verdict.unknown:
            self._note("unknown_schema", schema, "", path, path)
        for schema, instead in verdict.schemas.items():
            self._note("not_honoured", schema, instead, path, path)
        ignored = {**verdict.ignored, **self._nodes.get(_node(prim), {})} if kind == "Shader" else verdict.ignored
        if not ignored:
            return
        for name in prim.GetAuthoredPropertyNames():
            if name in ignored and _is_in_use(prim, name):
                self._note("not_honoured", name, ignored[name], path, f"{path}.{name}")

    def findings(self) -> list[Finding]:
        """All that was noted, each property or schema once."""
        return [
            Finding(code, at, _sentence(code, what, instead, path, count), count)
            for (code, what, instead), (path, at, count) in self._found.items()
        ]

    def _note(self, code: str, what: str, instead: str, path: str, at: str) -> None:
        first, first_at, count = self._found.get((code, what, instead), (path, at, 0))
        self._found[code, what, instead] = (first, first_at, count + 1)


def _sentence(code: str, what: str, instead: str, path: str, count: int) -> str:
    others = f" and {count - 1:,} other prim{'s' if count > 2 else ''}" if count > 1 else ""
    fault = "known" if code == "unknown_schema" else "honoured"
    return f"{what} of {path}{others} is not {fault}{': ' if instead else ''}{instead}"


def _prims(stage: Usd.Stage) -> Iterator[tuple[Usd.Prim, str]]:
    """Each prim of a stage, and of its prototypes once, with its path for users: prototypes have that of their first instance."""
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), _LOADED):
        yield prim, str(prim.GetPath())
    for prototype in stage.GetPrototypes():
        root = _path_of_instance(prototype)
        for prim in Usd.PrimRange(prototype, _LOADED):
            yield prim, root + str(prim.GetPath()).removeprefix(str(prototype.GetPath()))


def _path_of_instance(prototype: Usd.Prim) -> str:
    """Path of the first instance of a prototype, by way of those that it is nested in."""
    instance = prototype.GetInstances()[0]
    if not instance.IsInPrototype():
        return str(instance.GetPath())
    outer = instance.GetPath().GetPrefixes()[0]
    return _path_of_instance(instance.GetStage().GetPrimAtPath(outer)) + str(instance.GetPath()).removeprefix(
        str(outer)
    )


def _is_in_use(prim: Usd.Prim, name: str) -> bool:
    """Whether a property is authored so that it could have an effect; one whose value is damaged could."""
    try:
        return _says_something(prim, name)
    except Tf.ErrorException:
        return True


def _says_something(prim: Usd.Prim, name: str) -> bool:
    attribute = prim.GetAttribute(name)
    if not attribute:
        relationship = prim.GetRelationship(name)
        return bool(relationship and relationship.GetTargets())
    if attribute.HasAuthoredConnections():
        return name != "outputs:displacement" or not _is_preview_surface(attribute)
    if not attribute.HasAuthoredValue():
        return False
    if attribute.ValueMightBeTimeVarying():
        return True
    return not _is_neutral(attribute.Get(Usd.TimeCode.EarliestTime()), _fallback(prim, name))


def _is_preview_surface(output: Usd.Attribute) -> bool:
    """Whether a material's output is connected to UsdPreviewSurface, whose input `displacement` is named instead."""
    shaders = [UsdShade.Shader(source.source.GetPrim()) for source in UsdShade.Output(output).GetConnectedSources()[0]]
    return all(shader and shader.GetIdAttr().Get() == _PREVIEW_SURFACE for shader in shaders)


def _is_neutral(value: object, fallback: object) -> bool:
    """Whether a value is the schema's own, or is empty where the schema has none."""
    if fallback is None:
        return value is None or (hasattr(value, "__len__") and not len(value))
    return value is None or (type(value) is type(fallback) and bool(value == fallback))


def _fallback(prim: Usd.Prim, name: str) -> object:
    if name.startswith("inputs:") and schema_type(prim) == "Shader":
        definition = Sdr.Registry().GetShaderNodeByIdentifier(_node(prim)).GetShaderInput(name.removeprefix("inputs:"))
        return definition.GetDefaultValueAsSdfType()
    return prim.GetPrimDefinition().GetAttributeFallbackValue(name)


def _node(prim: Usd.Prim) -> str:
    return str(UsdShade.Shader(prim).GetIdAttr().Get() or "")


def _ignored_inputs(kind: str) -> dict[str, str]:
    """Inputs of a shader node that are not honoured, as properties, with what is drawn instead."""
    node = Sdr.Registry().GetShaderNodeByIdentifier(kind)
    rulings = {name: NODE_RULES[kind].ruling(name) for name in node.GetShaderInputNames()}
    return {f"inputs:{name}": ruling.text for name, ruling in rulings.items() if ruling and ruling.status == "ignored"}
