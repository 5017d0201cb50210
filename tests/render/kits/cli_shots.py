"""Small shots for the tests of the command line, and the command itself, run in this process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from render.cli.main import main

HEADER = """#usda 1.0
(
    defaultPrim = "World"
    endTimeCode = 12
    framesPerSecond = 24
    metersPerUnit = 1
    startTimeCode = 1
    timeCodesPerSecond = 24
    upAxis = "Y"
)
"""

SQUARE = """
    def Mesh "Square"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        color3f[] primvars:displayColor = [(0.8, 0.2, 0.1)] (interpolation = "constant")
    }
"""

CAMERA = """
    def Camera "main_cam"
    {
        float focalLength = 0.5
        float horizontalAperture = 0.36
        float verticalAperture = 0.24
        float focusDistance = 5
        float fStop = 2
        float2 clippingRange = (0.1, 100)
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
"""


def write_shot(path: Path, *prims: str) -> Path:
    """Write a stage whose world holds these prims."""
    path.write_text(f'{HEADER}def Xform "World"\n{{{"".join(prims)}}}\n')
    return path


@dataclass(frozen=True)
class Ended:
    """Exit status and output of a command."""

    status: int
    out: str
    err: str


class Command:
    """The `pullfocus` command."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: object) -> Ended:
        self._capsys.readouterr()
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as ended:  # argparse leaves so
            status = int(ended.code or 0)
        captured = self._capsys.readouterr()
        return Ended(status, captured.out, captured.err)


def small(*arguments: object) -> Sequence[object]:
    """Arguments that make a picture small and quick."""
    return ("--imageWidth", 48, "--rays", 4, "--supersample", 1, *arguments)
