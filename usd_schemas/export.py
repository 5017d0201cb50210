"""Writes a shot for others: every LensCamera becomes a plain Camera that says explicitly what its type implied.

Hydra adapters and importers look cameras up by the exact type Camera, and the fallbacks of a type are lost to those who
do not have its plugin.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pxr import Sdf, Usd, UsdUtils

from usd_schemas.errors import SchemaError
from usd_schemas.registration import LENS_CAMERA, SINGLE_APPLY

SUFFIXES = (".usda", ".usdc", ".usd", ".usdz")


def export_portable(source: Usd.Stage | Sdf.Layer, path: str | Path) -> Path:
    """Write a stage, flattened, or a layer as it is, with each LensCamera retyped to Camera.

    Args:
        source: a stage, whose references and sublayers are flattened into one file (variants are resolved, and each
            LensCamera with its values is found wherever it came from); or a layer, of which only itself is written.
            It is not changed.
        path: ends in .usda, .usdc, .usd or .usdz; a .usdz takes the files with it that the shot names.

    Returns:
        The path. It is written beside and renamed, so that it is there whole or not at all.

    Raises:
        SchemaError: the suffix is none of these, or USD could not write the file.
    """
    target = Path(path)
    if target.suffix not in SUFFIXES:
        raise SchemaError(f"the file to export to must end in {', '.join(SUFFIXES)}, got {target.name!r}")
    if not target.parent.is_dir():
        raise SchemaError(f"the folder of {target} is not there")
    layer = portable_layer(source)
    if target.suffix != ".usdz":  # a package takes its files with it; any other file finds them from where it stands
        UsdUtils.ModifyAssetPaths(layer, lambda asset: _relative(asset, target.parent.resolve()))
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".export-") as folder:
        written = Path(folder) / target.name
        _write(layer, written)
        os.replace(written, target)
    return target


def portable_layer(source: Usd.Stage | Sdf.Layer) -> Sdf.Layer:
    """An anonymous layer with what `export_portable` writes."""
    if isinstance(source, Usd.Stage):
        layer = source.Flatten(addSourceFileComment=False)
    else:
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.TransferContent(source)
        # Paths that are relative to the source must go on meaning the same.
        UsdUtils.ModifyAssetPaths(layer, lambda asset: _anchored(source, asset))
    for spec in list(_lens_cameras(layer)):
        _retype(spec)
    _forget_fallback_type(layer)
    return layer


def _anchored(source: Sdf.Layer, asset: str) -> str:
    return str(source.ComputeAbsolutePath(asset)) if asset and not source.anonymous else asset


def _relative(asset: str, folder: Path) -> str:
    if not os.path.isabs(asset):
        return asset
    relative = os.path.relpath(asset, folder)
    return relative if relative.startswith("..") else f"./{relative}"


def _lens_cameras(layer: Sdf.Layer) -> Iterator[Sdf.PrimSpec]:
    """Every prim spec of the type, in variants too."""
    paths: list[Sdf.Path] = []
    layer.Traverse(Sdf.Path.absoluteRootPath, paths.append)
    for path in paths:
        prim_like = path.IsPrimPath() or path.IsPrimVariantSelectionPath()
        spec = layer.GetPrimAtPath(path) if prim_like else None
        if spec is not None and spec.typeName == LENS_CAMERA:
            yield spec


def _retype(spec: Sdf.PrimSpec) -> None:
    """Make a Camera of a LensCamera: apply the schemas, and write out the values that the type gave it."""
    spec.typeName = "Camera"
    _apply_schemas(spec)
    for name in SINGLE_APPLY:
        definition = Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(name)
        for property_name in definition.GetPropertyNames():
            attribute = definition.GetAttributeDefinition(property_name)
            fallback = attribute.GetFallbackValue() if attribute else None
            says_nothing = fallback is None or (hasattr(fallback, "__len__") and len(fallback) == 0)
            if not says_nothing and spec.attributes.get(property_name) is None:
                made = Sdf.AttributeSpec(spec, property_name, attribute.GetTypeName(), attribute.GetVariability())
                made.default = fallback


def _apply_schemas(spec: Sdf.PrimSpec) -> None:
    """Put the built-in schemas before the others that the spec applies."""
    authored = spec.GetInfo("apiSchemas") if spec.HasInfo("apiSchemas") else Sdf.TokenListOp()
    if authored.isExplicit:
        kept = [name for name in authored.explicitItems if name not in SINGLE_APPLY]
        spec.SetInfo("apiSchemas", Sdf.TokenListOp.CreateExplicit([*SINGLE_APPLY, *kept]))
        return
    kept = [name for name in authored.prependedItems if name not in SINGLE_APPLY]
    authored.prependedItems = [*SINGLE_APPLY, *kept]
    spec.SetInfo("apiSchemas", authored)


def _forget_fallback_type(layer: Sdf.Layer) -> None:
    """The layer has no LensCamera any more, so it need not say what one falls back to."""
    root = layer.pseudoRoot
    if root.HasInfo("fallbackPrimTypes"):
        left = {name: types for name, types in root.GetInfo("fallbackPrimTypes").items() if name != LENS_CAMERA}
        root.SetInfo("fallbackPrimTypes", left) if left else root.ClearInfo("fallbackPrimTypes")


def _write(layer: Sdf.Layer, path: Path) -> None:
    if path.suffix != ".usdz":
        written = layer.Export(str(path))
    else:
        inner = path.with_suffix(".usdc")
        written = layer.Export(str(inner)) and UsdUtils.CreateNewUsdzPackage(str(inner), str(path), inner.name)
    if not written or not path.is_file():
        raise SchemaError(f"USD could not write {path.name}")
