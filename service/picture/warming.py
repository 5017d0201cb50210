"""Function of the picture process that draws the demo shot, so that the driver keeps the shaders that all shots need."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from pxr import UsdUtils

from render.demo.shot import write_demo
from render.frame import FrameSettings
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest
from render.shot import Shot
from service.picture.state import PictureWorkerState, picture_function

SETTINGS = FrameSettings(width=320, height=180, rays=16)


@picture_function
def draw_demo(state: PictureWorkerState) -> None:
    """Draw the demo shot as a file and as live pictures. Raises `GraphicsError`: nothing can be drawn on this machine."""
    silenced = UsdUtils.CoalescingDiagnosticDelegate()  # USD warns that a sandbox lets it set no permissions
    with TemporaryDirectory() as folder:
        shot = Shot.open(write_demo(Path(folder)), confined_to=Path(folder))
        silenced.TakeUncoalescedDiagnostics()
        make_picture(state.renderer, shot, None, 1.0, SETTINGS)
        for _ in state.progressive(shot).pictures(PreviewRequest(None, 1.0, SETTINGS)):
            pass
