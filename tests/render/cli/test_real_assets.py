"""Real assets, where they lie beside the checkout: each is recorded through a camera layer of ours, and read back.

What the pictures look like is for people; here is held what a wrong reading would break: that the subject is in the frame, in
its own colours, and sharper where it is in focus.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.cli.main import main

ASSETS = Path(__file__).parents[3].parent / "shared" / "assets"

CAMERA = """#usda 1.0
(
    subLayers = [@{asset}@]
    metersPerUnit = 1
    upAxis = "Y"
)
def Camera "main_cam"
{{
    float focalLength = 0.5
    float horizontalAperture = 0.36
    float verticalAperture = 0.2025
    float fStop = {f_stop}
    float focusDistance = {focus}
    float2 clippingRange = (0.01, 100)
    double3 xformOp:translate = {place}
    float3 xformOp:rotateXYZ = {turn}
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]
}}
def DistantLight "key"
{{
    float inputs:intensity = 3
    bool inputs:normalize = 1
    float3 xformOp:rotateXYZ = (-45, 25, 0)
    uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
}}
def DomeLight "fill"
{{
    float inputs:intensity = 0.3
}}
"""


def recorded(tmp_path: Path, asset: str, **camera: object) -> np.ndarray:
    """Scene-linear ``(h, w, 4)`` of one frame of the asset through the camera."""
    path = ASSETS / asset
    if not path.is_file():
        pytest.skip(f"{asset} is not beside the checkout")
    shot, picture = tmp_path / "shot.usda", tmp_path / "frame.exr"
    shot.write_text(CAMERA.format(asset=path.as_posix(), **camera))
    assert main(["record", str(shot), str(picture), "--imageWidth", "320", "--rays", "32"]) == 0
    return OpenImageIO.ImageBuf(str(picture)).get_pixels(OpenImageIO.FLOAT)


def detail(picture: np.ndarray) -> float:
    luminance = picture[..., :3].mean(-1)
    return float(np.abs(np.diff(luminance, axis=1)).mean() / luminance.mean())


def test_the_chess_set(tmp_path: Path) -> None:
    camera = {"place": "(0.0, 0.28, 0.5)", "turn": "(-28, 0, 0)", "focus": 0.55}
    sharp = recorded(tmp_path, "OpenChessSet/chess_set.usda", f_stop=0, **camera)
    assert sharp[-1, :, 3].min() == 1, "the board fills the foreground"
    assert 0.3 < sharp[..., 3].mean() < 1
    board = sharp[120:170, 60:260, :3].mean(-1)
    assert np.percentile(board, 95) > 3 * np.percentile(board, 5), "light and dark squares and pieces"
    blurred = recorded(tmp_path, "OpenChessSet/chess_set.usda", f_stop=1.4, **camera)
    assert detail(blurred) < 0.8 * detail(sharp)
    np.testing.assert_allclose(blurred[..., :3].mean(), sharp[..., :3].mean(), rtol=0.1)


def test_the_teapot(tmp_path: Path) -> None:
    picture = recorded(
        tmp_path, "Teapot/Teapot.usd", place="(0.0, 0.2, 0.9)", turn="(-6, 0, 0)", focus=0.65, f_stop=2.8
    )
    middle = picture[90, 160]
    assert middle[3] == 1
    assert middle[1] > 1.5 * middle[2], "the default variant is green"
    assert picture[5, 5, 3] == 0
    assert 0.1 < picture[..., 3].mean() < 0.9
