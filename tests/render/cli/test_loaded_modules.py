"""Modules that `pullfocus record` loads: what it does not need would be waited for at every start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.render.kits.cli_shots import CAMERA, SQUARE, write_shot

pytestmark = pytest.mark.gl

NOT_NEEDED = (
    "fastapi",
    "freetype.raw",
    "imageio",
    "jinja2",
    "matplotlib",
    "networkx.classes",
    "opentimelineio",
    "PIL.ImageMode",
    "pydantic",
    "pyglet",
    "render.cli.demo",
    "render.cli.inspect",
    "render.demo",
    "render.drawing",
    "render.focus.files",
    "render.lab",
    "scipy",
    "service",
    "tkinter",
    "trimesh.base",
    "trimesh.util",
    "uvicorn",
)
"""Modules of packages that run late stand for their package."""


def test_record_loads_no_module_that_it_does_not_need(tmp_path: Path) -> None:
    shot = write_shot(tmp_path / "shot.usda", SQUARE, CAMERA)
    code = (
        "import sys\n"
        "from render.cli.main import main\n"
        f"assert main(['record', {str(shot)!r}, {str(tmp_path / 'picture.png')!r}, '-w', '32', '--rays', '4']) == 0\n"
        f"print(*(name for name in {NOT_NEEDED} if name in sys.modules))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []
