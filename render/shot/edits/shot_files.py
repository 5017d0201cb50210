"""Files that a shot uses, which no result may overwrite."""

from __future__ import annotations

from pathlib import Path

from pxr import Ar, Tf, Usd, UsdUtils

from render.errors import SettingsError
from render.stage import quiet_diagnostics


def check_not_own(stage: Usd.Stage, path: Path) -> None:
    """Refuse to write over a file that a stage uses: one of its layers, or a texture or other asset of theirs.

    Args:
        stage: the shot.
        path: of the file to be written; links are followed.

    Raises:
        SettingsError: the shot is made of that file; code ``own_file``.
    """
    if not path.is_file():  # the common case, and cheap
        return
    if any(own.exists() and own.samefile(path) for own in _own_files(stage)):
        raise SettingsError(
            f"the shot itself is made of {path}: write to another file", code="own_file", path=str(path)
        )


def _own_files(stage: Usd.Stage) -> set[Path]:
    used = {layer.realPath for layer in stage.GetUsedLayers()}
    try:
        with quiet_diagnostics():
            layers, assets, _ = UsdUtils.ComputeAllDependencies(stage.GetRootLayer().identifier)
        used |= {layer.realPath for layer in layers} | set(assets)
    except Tf.ErrorException:  # a file that the stage does not use is damaged; the layers in use are known
        pass
    return {Path(_outermost(name)) for name in used if name}


def _outermost(name: str) -> str:
    """The file on disk: a layer in a package is named ``shot.usdz[layer.usda]``."""
    return Ar.SplitPackageRelativePathOuter(name)[0] if Ar.IsPackageRelativePath(name) else name
