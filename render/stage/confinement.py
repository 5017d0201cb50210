"""Everything that a stage refers to must lie in one folder: checked before anything is composed or any pixel is read."""

from __future__ import annotations

import os
import re
from pathlib import Path

from pxr import Ar, Sdf, Tf, UsdUtils

from render.errors import StageError
from render.stage.composition_size import CompositionSize
from render.stage.layer_files import check_layer_content, check_layer_file

_LAYER_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
_SCHEME = re.compile(r"^[A-Za-z][A-Za-z0-9+.-]+:")


def check_confined(file: Path, folder: Path) -> None:
    """Follow every reference of a stage's files, used or not: sublayers, references, payloads, clips and textures.

    Args:
        file: the root layer.
        folder: what nothing may leave. Symbolic links and ``..`` are followed first.

    Raises:
        StageError: code ``outside_reference``, names the path and who refers to it; ``stage_unreadable``, a layer would take its
            parser gigabytes; ``too_many_prims`` or ``too_many_clips``, the layers would take as much to be composed.
    """
    if not is_inside(str(file), folder):
        raise _outside(str(file), str(file), folder)
    waiting, seen = [str(file)], set[str]()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        _check_file(name)
        layer = _layer(name)
        for asset in _references(name) if layer else ():
            target = _target(layer, asset)
            if target is None or not is_inside(target, folder):
                raise _outside(asset, name, folder)
            waiting.append(target)
    root = _layer(str(file))
    if root is not None:
        CompositionSize(lambda layer, asset: _layer(_target(layer, asset) or "")).check(root)


def is_inside(path: str, folder: Path) -> bool:
    """Whether an asset path leads to a place in a folder. A path in a package counts as the package."""
    while Ar.IsPackageRelativePath(path):
        path = Ar.SplitPackageRelativePathOuter(path)[0]
    if _SCHEME.match(path):
        return False
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))


def _check_file(name: str) -> None:
    """Judge a layer, or all layers of a package, before USD parses them."""
    if Ar.IsPackageRelativePath(name):
        return  # judged with its package
    if Path(name).suffix.lower() != ".usdz":
        check_layer_file(name)
        return
    try:
        package = Sdf.ZipFile.Open(name)
        names = package.GetFileNames() if package else []
    except Tf.ErrorException:
        return
    for inner in names:
        if Path(inner).suffix.lower() in _LAYER_SUFFIXES:
            check_layer_content(memoryview(package.GetFile(inner)), f"{Path(name).name}[{inner}]")


def _layer(name: str) -> Sdf.Layer | None:
    """Layer of a name, or None for a texture or a missing or damaged layer, which opening the stage will report."""
    try:
        return Sdf.Layer.FindOrOpen(name) if name else None
    except (Tf.ErrorException, RuntimeError, UnicodeDecodeError):
        return None


def _references(name: str) -> list[str]:
    """Asset paths in a layer; none where it is damaged, which opening the stage will report.

    Raises:
        StageError: one is no text.
    """
    try:
        sublayers, references, payloads = UsdUtils.ExtractExternalReferences(name)
    except UnicodeDecodeError as error:
        file = Path(name).name
        raise StageError(
            f"{file} is damaged: it names a file in bytes that are no UTF-8 text", code="stage_unreadable", path=file
        ) from error
    except Tf.ErrorException as error:
        file = Path(name).name
        raise StageError(
            f"{file} is damaged: the files that it names cannot be read", code="stage_unreadable", path=file
        ) from error
    return [*sublayers, *references, *payloads]


def _target(layer: Sdf.Layer, asset: str) -> str | None:
    """Target of an asset path in a layer; None for an expression, which cannot be resolved here."""
    path = Sdf.Layer.SplitIdentifier(asset)[0]
    if path.startswith("`"):
        return None
    absolute = str(layer.ComputeAbsolutePath(path))
    resolved = str(Ar.GetResolver().Resolve(absolute) or absolute)
    return resolved if os.path.isabs(resolved) or _SCHEME.match(resolved) else str(_folder_of(layer) / resolved)


def _folder_of(layer: Sdf.Layer) -> Path:
    path = layer.realPath or layer.identifier
    while Ar.IsPackageRelativePath(path):
        path = Ar.SplitPackageRelativePathOuter(path)[0]
    return Path(path).parent


def _outside(asset: str, referrer: str, folder: Path) -> StageError:
    return StageError(
        f"{Path(referrer).name} refers to {asset}, which lies outside what was given ({folder.name}/)",
        code="outside_reference",
        path=asset,
    )
