"""Files that a stage is made of, so that a push sends these and nothing else of its folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pxr import Ar, Tf, UsdUtils

from render.errors import StageError
from render.stage import quiet_diagnostics


@dataclass(frozen=True)
class StageFiles:
    """Files of a stage.

    Attributes:
        inside: those in the folder of its root layer or below it, relative to that folder.
        outside: others.
    """

    inside: Sequence[Path]
    outside: Sequence[Path]


def find_stage_files(root: Path) -> StageFiles:
    """Find the layers, textures and other assets that a stage refers to, used or not. What is missing is left out.

    Args:
        root: its root layer.

    Raises:
        StageError: a file cannot be read.
    """
    folder = root.resolve().parent
    try:
        with quiet_diagnostics():
            layers, assets, _ = UsdUtils.ComputeAllDependencies(str(root.resolve()))
    except Tf.ErrorException as error:
        detail = f"{root} is no stage, or a file that it refers to is damaged; `pullfocus inspect {root}` says more"
        raise StageError(detail, path=str(root)) from error
    names = {_file_on_disk(name) for name in (*(layer.realPath for layer in layers), *assets) if name}
    names.add(str(root.resolve()))
    paths = sorted(Path(name).resolve() for name in names)
    inside = [path.relative_to(folder) for path in paths if path.is_relative_to(folder) and path.is_file()]
    return StageFiles(inside, [path for path in paths if not path.is_relative_to(folder)])


def _file_on_disk(name: str) -> str:
    """Return the file of a layer, which may be in a package: ``shot.usdz[layer.usda]``."""
    while Ar.IsPackageRelativePath(name):
        name = Ar.SplitPackageRelativePathOuter(name)[0]
    return name
