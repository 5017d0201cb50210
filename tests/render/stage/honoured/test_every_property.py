"""Every property of every schema that USD knows is honoured, neutral for a stated reason, or named."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from pxr import Gf, Plug, Sdf, Sdr, Tf, Usd, UsdShade

import usd_schemas
from render.stage import Finding, StageReader, find_not_honoured
from render.stage.honoured.rules import IGNORED_SCHEMAS, NAMED_SCHEMAS, NEUTRAL_PLUGINS, NODE_RULES, RULES, Rules
from render.stage.honoured.verdicts import judge
from tests.render.kits.stages import new_stage

REGISTRY = Usd.SchemaRegistry()
CONCRETE = Usd.SchemaKind.ConcreteTyped
APPLIED = (Usd.SchemaKind.SingleApplyAPI, Usd.SchemaKind.MultipleApplyAPI)
HOSTS = {
    "MeshLightAPI": "Mesh",
    "VolumeLightAPI": "Volume",
    "PhysicsDriveAPI": "PhysicsRevoluteJoint",
    "PhysicsLimitAPI": "PhysicsRevoluteJoint",
    "usdLux": "SphereLight",
    "pullfocus": "Camera",
    "usdSkel": "Mesh",
    "BackPlateAPI": "Camera",
}
"""Types of the prims that get an API schema, or those of a plugin; Xform for others."""
HIDING = {"visibility", "purpose"}
"""Properties that hide a prim, so that nothing of it is read."""
OTHER_VALUES = {"xformOpOrder": ["!resetXformStack!"]}
ACCESSORS = {
    "info:id": "GetIdAttr",
    "primvars:displayColor": "displayColor",
    "primvars:displayOpacity": "displayOpacity",
    "xformOpOrder": "XformCache",
    "extent": "BBoxCache",
    "familyName": "GetMaterialBindSubsets",
    "exposure": "ComputeLinearExposureScale",
    "outputs:surface": "ComputeSurfaceSource",
    "joints": "GetJointOrder",
    "bindTransforms": "ComputeSkinningTransforms",
    "restTransforms": "ComputeSkinningTransforms",
    "blendShapeWeights": "ComputeBlendShapeWeights",
    "blendShapes": "GetBlendShapeMapper",
    "rotations": "ComputeSkinningTransforms",
    "translations": "ComputeSkinningTransforms",
    "offsets": "ComputeSubShapePointOffsets",
    "normalOffsets": "GetNormalOffsetsAttr",
    "pointIndices": "ComputeBlendShapePointIndices",
    "skel:": "ComputeSkelBindings",
    "collection": "ComputeMembershipQuery",
    "colorSpace:name": "ComputeColorSpaceName",
    "colorSpaceDefinition": "ComputeColorSpace",
    "primvars:skel:geomBindTransform": "GetGeomBindTransform",
    "primvars:skel:jointIndices": "ComputeVaryingJointInfluences",
    "primvars:skel:jointWeights": "ComputeVaryingJointInfluences",
    "primvars:skel:skinningMethod": "GetSkinningMethod",
    "velocities": "GetVelocitiesAttr",
    "accelerations": "ComputePointsAtTime",
    "model:drawMode": "ComputeModelDrawMode",
    "lod:default:index": "GetLodDefaultIndexAttr",
    "lod:heuristics": "GetLodHeuristicsRel",
    "lod:override": "ComputeLODOverride",
    "lod:domain": "GetLodDomainAttr",
    "center": "CreateDistanceHeuristicQuery",
    "boundingVolume": "CreateDistanceHeuristicQuery",
    "thresholds": "CreateDistanceHeuristicQuery",
    "blendThresholds": "CreateDistanceHeuristicQuery",
    "projectionMethod": "CreateScreenSizeHeuristicQuery",
    "backPlate:alpha:image": "GetAlphaImageAttr",
    "backPlate:depth:cameraSpaceOffset": "GetDepthCameraSpaceOffsetAttr",
    "backPlate:depth:image": "GetDepthImageAttr",
    "backPlate:depth:minOffset": "GetDepthMinOffsetAttr",
    "backPlate:depth:normalizingFactor": "GetDepthNormalizingFactorAttr",
    "backPlate:image": "GetImageAttr",
    "backPlate:luma:offset": "GetLumaOffsetAttr",
    "backPlate:luma:power": "GetLumaPowerAttr",
    "backPlate:luma:slope": "GetLumaSlopeAttr",
    "backPlate:plateVisibility": "GetPlateVisibilityAttr",
    "backPlate:rotateXYZ:tweak": "GetRotateXYZTweakAttr",
    "backPlate:scale:tweak": "GetScaleTweakAttr",
    "backPlate:translate:tweak": "GetTranslateTweakAttr",
}
"""Functions of USD that read a property for us."""


def _schemas() -> Iterator[str]:
    for schema in Tf.Type.FindByName("UsdSchemaBase").GetAllDerivedTypes():
        if REGISTRY.GetSchemaKind(schema) in (CONCRETE, *APPLIED):
            yield REGISTRY.GetSchemaTypeName(schema)


SCHEMAS = sorted(_schemas())


def _is_applied(schema: str) -> bool:
    return REGISTRY.GetSchemaKind(REGISTRY.GetTypeFromSchemaTypeName(schema)) in APPLIED


def _host(schema: str) -> str:
    """Type of a prim for a schema."""
    if not _is_applied(schema):
        return schema
    plugin = Plug.Registry().GetPluginForType(REGISTRY.GetTypeFromSchemaTypeName(schema)).name
    return HOSTS.get(schema) or HOSTS.get(plugin, "Xform")


def _instance(schema: str) -> str:
    return f"{schema}:one" if REGISTRY.IsMultipleApplyAPISchema(schema) else schema


def _properties(schema: str) -> list[str]:
    """All properties of a schema, those of one instance where it may be applied several times."""
    if not _is_applied(schema):
        return list(REGISTRY.FindConcretePrimDefinition(schema).GetPropertyNames())
    names = REGISTRY.FindAppliedAPIPrimDefinition(schema).GetPropertyNames()
    if not REGISTRY.IsMultipleApplyAPISchema(schema):
        return list(names)
    return [REGISTRY.MakeMultipleApplyNameInstance(name, "one") for name in names]


def _prim(stage: Usd.Stage, path: str, schema: str) -> Usd.Prim:
    prim = stage.DefinePrim(path, _host(schema))
    if _is_applied(schema):
        prim.AddAppliedSchema(_instance(schema))
    return prim


def _other_value(kind: Sdf.ValueTypeName, fallback: object, tokens: list[str]) -> object:
    """A value that is not the fallback."""
    if kind.isArray:
        element = _other_value(kind.scalarType, None, tokens)
        return type(kind.defaultValue)([element])
    zero = kind.defaultValue
    if isinstance(zero, bool):
        return not fallback
    if isinstance(zero, int | float):
        return type(zero)((fallback or 0) + 1) if math.isfinite(fallback or 0) else type(zero)(1)
    if isinstance(zero, str):
        return next((token for token in tokens if token not in (fallback, "")), "other")
    if isinstance(zero, Sdf.AssetPath):
        return Sdf.AssetPath("other.png")
    if isinstance(zero, Sdf.PathExpression):
        return Sdf.PathExpression("/other")
    if isinstance(zero, Sdf.TimeCode):
        return Sdf.TimeCode(7)
    if isinstance(zero, Gf.Quatf | Gf.Quath | Gf.Quatd):
        return type(zero)(0.5, 0.5, 0.5, 0.5)
    if isinstance(zero, Gf.Matrix4d | Gf.Matrix3d | Gf.Matrix2d):
        return type(zero)(3.0)
    return type(zero)(*(7 + i for i in range(len(zero))))


def _author(prim: Usd.Prim, name: str) -> bool:
    """Author a property with a value of its type other than the fallback; false where it cannot hold any."""
    definition = prim.GetPrimDefinition()
    if definition.GetSpecType(name) == Sdf.SpecTypeRelationship:
        return bool(prim.GetRelationship(name).AddTarget("/other"))
    attribute = prim.GetAttribute(name)
    if attribute.GetTypeName() in (Sdf.ValueTypeNames.Opaque, Sdf.ValueTypeNames.Group):
        return False
    if name.startswith("outputs:"):
        return bool(attribute.AddConnection("/other.outputs:out"))
    fallback = definition.GetAttributeFallbackValue(name)
    tokens = definition.GetPropertyMetadata(name, "allowedTokens") or []
    value = OTHER_VALUES.get(name) or _other_value(attribute.GetTypeName(), fallback, list(tokens))
    assert value != fallback, name
    return bool(attribute.Set(value))


def _findings(stage: Usd.Stage) -> list[Finding]:
    reader = StageReader(stage)
    reader.read(0.0)
    return [*reader.findings, *find_not_honoured(stage)]


@pytest.mark.parametrize("schema", SCHEMAS)
def test_each_property_is_honoured_neutral_or_named(schema: str) -> None:
    stage = new_stage()
    other = UsdShade.Shader.Define(stage, "/other")
    other.CreateIdAttr("UsdUVTexture")
    other.CreateOutput("out", Sdf.ValueTypeNames.Token)
    prims = {name: _prim(stage, f"/p{number}", schema) for number, name in enumerate(_properties(schema))}
    authored = {name: prim for name, prim in prims.items() if _author(prim, name)}
    found = _findings(stage)
    at = {(finding.code, finding.path) for finding in found}
    wholes = [finding for finding in found if finding.code == "not_honoured" and "." not in finding.path]
    for name, prim in authored.items():
        path, verdict = str(prim.GetPath()), judge(prim)
        ruling = verdict.rulings.get(name)
        assert not verdict.unknown
        if ruling is None:
            by_reader = any((code, path) in at for code in NAMED_SCHEMAS.values())
            by_walk = any(one.message.startswith(f"{what} of /p0") for one in wholes for what in verdict.schemas)
            assert by_reader or by_walk or name in HIDING, f"{name} of {schema} is dropped in silence"
            assert not (by_reader and by_walk), f"{schema} is named twice"
        elif ruling.status == "ignored":
            assert ("not_honoured", f"{path}.{name}") in at, f"{name} of {schema} is not named"
        elif ruling.status == "named":
            assert (ruling.text, path) in at, f"{name} of {schema} is not named"
        else:
            assert ("not_honoured", f"{path}.{name}") not in at
            assert ruling.status == "honoured" or ruling.text, f"{name} of {schema} is neutral without a reason"


@pytest.mark.parametrize("schema", SCHEMAS)
def test_a_property_with_the_value_of_its_schema_is_not_named(schema: str) -> None:
    stage = new_stage()
    prim = _prim(stage, "/p", schema)
    for name in _properties(schema):
        fallback = prim.GetPrimDefinition().GetAttributeFallbackValue(name)
        if fallback is not None:
            prim.GetAttribute(name).Set(fallback)
    assert not [finding for finding in find_not_honoured(stage) if "." in finding.path]


def _declared(schema: str) -> set[str]:
    """Names that rules of a schema may mention: its properties, those of types that derive from it, and of APIs on those."""
    name = REGISTRY.GetTypeNameAndInstance(schema)[0]
    kind = REGISTRY.GetTypeFromSchemaTypeName(name)
    assert kind, f"USD knows no schema {name}: its rules are dead"
    if _is_applied(name):
        names = REGISTRY.FindAppliedAPIPrimDefinition(name).GetPropertyNames()
        return {str(one).replace(":__INSTANCE_NAME__", "") for one in names}
    concrete = [
        REGISTRY.FindConcretePrimDefinition(one) for one in SCHEMAS if not _is_applied(one) and _is_a(one, kind)
    ]
    lights = [REGISTRY.FindAppliedAPIPrimDefinition(one) for one in ("ShadowAPI", "ShapingAPI")]
    return {str(one) for definition in (*concrete, *lights) for one in definition.GetPropertyNames()}


def _is_a(schema: str, kind: Tf.Type) -> bool:
    return bool(REGISTRY.GetTypeFromSchemaTypeName(schema).IsA(kind))


def _mentioned(rules: Rules) -> list[str]:
    texts = (rules.honoured, *rules.neutral, *rules.ignored, *rules.named)
    return [name for text in texts for name in text.split() if name != "*"]


@pytest.mark.parametrize("schema", [*RULES, *IGNORED_SCHEMAS, *NAMED_SCHEMAS])
def test_no_rule_is_about_what_usd_does_not_know(schema: str) -> None:
    mentioned = _mentioned(RULES.get(schema, Rules()))
    assert len(mentioned) == len(set(mentioned)), "two rules for one property"
    assert set(mentioned) <= _declared(schema)


def test_no_rule_is_about_a_node_or_plugin_that_is_not_there() -> None:
    assert all(Plug.Registry().GetPluginWithName(name) for name in NEUTRAL_PLUGINS)
    for kind, rules in NODE_RULES.items():
        node = Sdr.Registry().GetShaderNodeByIdentifier(kind)
        assert set(_mentioned(rules)) <= set(node.GetShaderInputNames())


def _source() -> str:
    """All code that reads stages, without the rules themselves."""
    root = Path(usd_schemas.__file__).parents[1]
    files = [*(root / "render").rglob("*.py"), *(root / "usd_schemas").rglob("*.py")]
    return "\n".join(file.read_text() for file in files if "honoured" not in file.parts)


def _has_word(text: str, word: str) -> bool:
    """Whether a text has a word, which is no part of a longer one."""
    return any(
        re.compile(rf"\b{re.escape(word)}\b").match(text, at.start()) for at in re.finditer(re.escape(word), text)
    )


def test_what_is_honoured_is_read_somewhere() -> None:
    """The name of the property, or of USD's function that gets it, is in the code."""
    source = _source()
    unread = []
    for schema in RULES:
        for name in _honoured(schema):
            bare = name.removeprefix("inputs:")
            getter = "Get" + re.sub(r"(^|:)(.)", lambda found: found[2].upper(), bare.removeprefix("primvars:"))
            spellings = {name, bare.split(":")[-1] if schema in PULLFOCUS else name, f"{getter}Attr", f"{getter}Rel"}
            spellings.add(ACCESSORS.get(name) or next((v for k, v in ACCESSORS.items() if name.startswith(k)), name))
            if not any(_has_word(source, one) for one in spellings):
                unread.append((schema, name))
    assert not unread


PULLFOCUS = {"ApertureAPI", "FilmAPI", "FocusAPI", "FocusPointAPI", "LensAPI", "TiltShiftAPI"}


def _honoured(schema: str) -> list[str]:
    rules = RULES[schema]
    names = _declared(schema) if "*" in rules.honoured else rules.honoured.split()
    return sorted(name for name in names if getattr(rules.ruling(name), "status", "") == "honoured")
