"""Modules that `pullfocus record` loads: what it does not need would be waited for at every start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, write_shot

pytestmark = pytest.mark.gl

NOT_NEEDED = (
    "av",
    "email",
    "fastapi",
    "freetype.raw",
    "imageio",
    "importlib.metadata",
    "jinja2",
    "MaterialX",
    "matplotlib",
    "networkx.classes",
    "numpy.ma",
    "OpenGL.raw.GL.ARB.sampler_objects",
    "OpenGL.raw.GL.ARB.tessellation_shader",
    "opentimelineio",
    "PIL.ImageMode",
    "pydantic",
    "pxr.UsdValidation",
    "pyglet",
    "render.cli.demo",
    "render.cli.inspect",
    "render.cli.recording.progressive",
    "render.demo",
    "render.drawing",
    "render.focus.files",
    "render.lab",
    "render.layers.splats",
    "render.optics.flare",
    "render.output.movie",
    "render.optics.lens_files.zemax",
    "render.pictures.long_exposure",
    "render.postblur",
    "render.stage.assembly.splats",
    "render.trace.splats",
    "rich",
    "scipy",
    "service",
    "tkinter",
    "trimesh.base",
    "trimesh.util",
    "usd_schemas.validation",
    "uvicorn",
    "xml.etree.ElementPath",
)
"""Modules of packages that run late stand for their package."""


NOT_BEFORE_THE_FIRST_PIXEL = ("OpenImageIO.OpenImageIO",)


def test_record_loads_no_module_that_it_does_not_need(tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)
    code = (
        "import sys\n"
        "from render.cli.console import FrameProgress\n"
        "from render.cli.main import main\n"
        "loaded = []\n"
        "FrameProgress.update = lambda self, share: loaded.extend(sys.modules)\n"
        f"main(['record', {str(shot)!r}, {str(tmp_path / 'picture.png')!r}, '-w', '32', '--rays', '4'])\n"
        f"assert 'render.frame' in loaded\n"
        f"print(*(name for name in {NOT_NEEDED + NOT_BEFORE_THE_FIRST_PIXEL} if name in loaded))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []
