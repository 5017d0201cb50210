"""Writes the demo shot: one root layer over a layer for each department, and textures beside them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pxr import Kind, Sdf, Usd, UsdGeom

from render.demo.author import FIRST_FRAME, FRAMES_PER_SECOND, LAST_FRAME, UNITS_PER_METRE, editing
from render.demo.camera import RENDER_SETTINGS, write_camera
from render.demo.dome import write_dome
from render.demo.focus import write_focus
from render.demo.glints import write_glints
from render.demo.lighting import write_lights
from render.demo.looks import write_looks
from render.demo.performance import write_cast, write_motion
from render.demo.set import write_set
from render.demo.textures import write_textures
from render.errors import OutputError

ROOT_NAME = "night_street.usda"

# Weakest first: the order in which they are authored. Sublayers are listed strongest first.
DEPARTMENTS: dict[str, Callable[[Usd.Stage], None]] = {
    "looks.usda": write_looks,
    "set.usdc": write_set,
    "cast.usdc": write_cast,
    "animation.usda": write_motion,
    "lighting.usda": write_lights,
    "camera.usda": write_camera,
    "focus.usda": write_focus,
}


def write_demo(directory: Path) -> Path:
    """Writes the demo shot: a rainy night street, two robots, 96 frames at 24 frames per second.

    The same files come out byte for byte every time; files of the same names are replaced.

    Args:
        directory: folder, created if it does not exist.

    Returns:
        Path of the root layer.

    Raises:
        OutputError: if something cannot be written there.
    """
    directory = Path(directory)
    try:
        (directory / "textures").mkdir(parents=True, exist_ok=True)
    except (FileExistsError, NotADirectoryError) as error:
        raise OutputError(
            f"{directory} is to be a directory, but it or what holds it is a file", path=str(directory)
        ) from error
    except OSError as error:
        raise OutputError(f"{directory} cannot be made a directory: {error.strerror}", path=str(directory)) from error
    write_textures(directory / "textures")
    write_dome(directory / "textures" / "night_dome.exr")
    write_glints(directory / "textures" / "glints.jpg")
    root = _layer(directory / ROOT_NAME)
    layers = {name: _layer(directory / name) for name in DEPARTMENTS}
    root.subLayerPaths = [f"./{name}" for name in reversed(DEPARTMENTS)]
    stage = Usd.Stage.Open(root)
    with editing(stage, root):
        _write_frame_of_the_shot(stage)
    for name, write in DEPARTMENTS.items():
        with editing(stage, layers[name]):
            write(stage)
    for layer in (root, *layers.values()):
        if not layer.Save():
            raise OutputError(f"{layer.realPath} could not be written", path=layer.realPath)
    return directory / ROOT_NAME


def _layer(path: Path) -> Sdf.Layer:
    """An empty layer at that path, whatever was there."""
    known = Sdf.Layer.Find(str(path))
    if known:
        known.Clear()
        return known
    path.unlink(missing_ok=True)
    layer = Sdf.Layer.CreateNew(str(path))
    if layer is None:
        raise OutputError(f"{path} could not be opened for writing", path=str(path))
    return layer


def _write_frame_of_the_shot(stage: Usd.Stage) -> None:
    """Units, frame range, and the root prim."""
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1 / UNITS_PER_METRE)
    stage.SetStartTimeCode(FIRST_FRAME)
    stage.SetEndTimeCode(LAST_FRAME)
    stage.SetTimeCodesPerSecond(FRAMES_PER_SECOND)
    stage.SetFramesPerSecond(FRAMES_PER_SECOND)
    world = UsdGeom.Xform.Define(stage, "/World").GetPrim()
    Usd.ModelAPI(world).SetKind(Kind.Tokens.group)
    stage.SetDefaultPrim(world)
    stage.SetMetadata("renderSettingsPrimPath", RENDER_SETTINGS)
    stage.GetRootLayer().documentation = (
        "Pullfocus demo: a rainy night street. Pip, near, hears a bell and looks round to Mara, far; the focus follows."
    )
