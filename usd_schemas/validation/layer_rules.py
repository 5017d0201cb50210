"""Rules for how the schemas are used in layers: where they are applied, how they are keyed, what others will see."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Sdf, Usd, UsdGeom

from usd_schemas.registration import FOCUS_POINT, LENS_CAMERA, SINGLE_APPLY
from usd_schemas.validation.rule import Fault, Fix, Rule


def _ours(prim: Usd.Prim) -> list[str]:
    """Our schemas that are authored on a prim, with instance names."""
    authored = prim.GetPrimTypeInfo().GetAppliedAPISchemas()
    return [name for name in authored if name in SINGLE_APPLY or name.split(":")[0] == FOCUS_POINT]


def on_cameras(prim: Usd.Prim) -> Iterator[Fault]:
    """The schemas are applied to cameras alone."""
    if not prim.IsA(UsdGeom.Camera):
        for name in _ours(prim):
            kind = prim.GetTypeName() or "none"
            yield Fault(prim.GetPath(), f"{name} must be applied to a Camera, got {prim.GetPath()} of type {kind}")


def _remove_schemas(stage: Usd.Stage, path: Sdf.Path) -> None:
    prim = stage.GetPrimAtPath(path)
    for name in _ours(prim):
        prim.RemoveAPI(*name.split(":", 1))


def hidden_splines(prim: Usd.Prim) -> Iterator[Fault]:
    """No attribute has both a spline and time samples in one layer: the samples would hide the spline."""
    for attribute in prim.GetAuthoredAttributes():
        for spec in attribute.GetPropertyStack(Usd.TimeCode.Default()):
            if spec.HasInfo("spline") and spec.HasInfo("timeSamples"):
                layer = spec.layer.identifier
                yield Fault(
                    attribute.GetPath(),
                    f"{attribute.GetName()} must have a spline or time samples, got both in {layer}: the spline is not seen",
                )


def _edited_spec(stage: Usd.Stage, path: Sdf.Path) -> Sdf.AttributeSpec | None:
    return stage.GetEditTarget().GetAttributeSpecForScenePath(path)


def _spline_is_hidden(stage: Usd.Stage, path: Sdf.Path) -> bool:
    spec = _edited_spec(stage, path)
    return spec is not None and spec.HasInfo("spline") and spec.HasInfo("timeSamples")


def _remove_spline(stage: Usd.Stage, path: Sdf.Path) -> None:
    spec = _edited_spec(stage, path)
    if spec is not None:
        spec.ClearInfo("spline")


def fallback_type(stage: Usd.Stage) -> Iterator[Fault]:
    """A stage with a LensCamera says that others may take it for a Camera."""
    noted = stage.GetMetadata("fallbackPrimTypes") or {}
    if LENS_CAMERA in noted:
        return
    for prim in stage.Traverse():
        if prim.GetTypeName() == LENS_CAMERA:
            yield Fault(
                Sdf.Path.absoluteRootPath,
                f"{prim.GetPath()} is a {LENS_CAMERA}, which tools without the plugin take for nothing: fallbackPrimTypes "
                "must say Camera, or the stage be exported with plain Cameras",
            )
            return


def _edits_root(stage: Usd.Stage, path: Sdf.Path) -> bool:
    return bool(stage.GetEditTarget().GetLayer() == stage.GetRootLayer())


def _write_fallbacks(stage: Usd.Stage, path: Sdf.Path) -> None:
    stage.WriteFallbackPrimTypes()


LAYER_RULES = (
    Rule(
        "SchemasOnCameras",
        on_cameras.__doc__ or "",
        "error",
        "prim",
        on_cameras,
        Fix("RemoveSchemas", "Take the schemas off; the values stay.", lambda stage, path: True, _remove_schemas),
    ),
    Rule(
        "HiddenSplines",
        hidden_splines.__doc__ or "",
        "error",
        "camera",
        hidden_splines,
        Fix("RemoveHiddenSpline", "Remove the spline, which nobody sees.", _spline_is_hidden, _remove_spline),
    ),
    Rule(
        "FallbackType",
        fallback_type.__doc__ or "",
        "warning",
        "stage",
        fallback_type,
        Fix(
            "WriteFallbackTypes", "Note on the root layer that a LensCamera is a Camera.", _edits_root, _write_fallbacks
        ),
    ),
)
