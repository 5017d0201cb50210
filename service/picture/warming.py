"""Functions of the picture process that draw the demo shot, so that the driver keeps the shaders that all shots need."""

from __future__ import annotations

from pathlib import Path

from pxr import UsdUtils

from render.demo.shot import write_demo
from render.frame import FrameSettings
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest
from render.shot import Shot
from service.picture.state import PictureWorkerState, picture_function

SETTINGS = FrameSettings(width=320, height=180, rays=16)


@picture_function
def write_shot(state: PictureWorkerState, folder: Path) -> str:
    """Write the demo shot to a folder. Returns the name of its root layer. Raises `OutputError`."""
    silenced = UsdUtils.CoalescingDiagnosticDelegate()  # USD warns that a sandbox lets it set no permissions
    root = write_demo(folder)
    silenced.TakeUncoalescedDiagnostics()
    return root.name


@picture_function
def draw(state: PictureWorkerState, root: Path) -> None:
    """Draw a shot as live pictures and as a file. Raises `GraphicsError`: nothing can be drawn on this machine."""
    shot = Shot.open(root, confined_to=root.parent)
    for _ in state.progressive(shot).pictures(PreviewRequest(None, 1.0, SETTINGS)):
        pass
    make_picture(state.renderer, shot, None, 1.0, SETTINGS)
