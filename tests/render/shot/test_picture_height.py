"""Pictures are as high as usdrecord's: the width over the camera's aspect ratio in single precision, without its fraction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf

from render.errors import CameraError
from render.shot import Shot
from render.shot.picture_height import picture_height
from tests.render.kits.cli_shots import write_shot

GATES = [
    (36.0, 20.25),
    (20.955, 15.2908),
    (24.892, 18.669),
    (21.946, 16.002),
    (24.89, 10.42),
    (10.0, 4000.0),
    (4000.0, 0.5),
]


def shot_through(path: Path, gate: tuple[float, float]) -> Shot:
    camera = f'def Camera "camera" {{\nfloat horizontalAperture = {gate[0]}\nfloat verticalAperture = {gate[1]}\n}}\n'
    return Shot.open(write_shot(path / "shot.usda", camera))


@pytest.mark.parametrize("gate", GATES, ids=str)
def test_heights_are_those_of_usdrecord(tmp_path: Path, gate: tuple[float, float]) -> None:
    """The aspect ratio is that of usd-core's own camera."""
    shot = shot_through(tmp_path, gate)
    own = Gf.Camera()
    own.horizontalAperture, own.verticalAperture = gate
    for width in (960, 500, 7):
        expected = max(1, int(np.float32(width) / np.float32(own.aspectRatio)))
        assert picture_height(shot, "/World/camera", 1.0, width) == expected
    if gate == (20.955, 15.2908):
        assert picture_height(shot, "/World/camera", 1.0, 960) == 700  # 700.5, which rounds to 701


def test_a_gate_without_size_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="positive number"):
        picture_height(shot_through(tmp_path, (36.0, 0.0)), "/World/camera", 1.0, 960)
