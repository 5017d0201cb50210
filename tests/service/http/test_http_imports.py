"""The HTTP process loads neither USD nor GL: a file or a driver can only crash a process that loads it."""

from __future__ import annotations

import subprocess
import sys

import pytest

HEAVY = ("pxr", "OpenGL", "moderngl", "pyrender", "OpenImageIO", "PyOpenColorIO", "matplotlib")


def heavy_modules_after(code: str) -> set[str]:
    """Names of heavy modules that a fresh process has loaded after running some code."""
    report = f"import sys; print(*[name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", f"{code}\n{report}"], capture_output=True, text=True, check=True)
    return set(done.stderr.split())


@pytest.mark.parametrize("module", ["service.http.app", "service.http.openapi", "service.picture.requests"])
def test_modules_of_the_http_process_are_light(module):
    assert heavy_modules_after(f"import {module}") == set()


def test_the_serve_command_loads_neither_usd_nor_gl():
    run = "from render.cli.main import main\ntry: main(['serve', '--help'])\nexcept SystemExit: pass"
    assert heavy_modules_after(run) == set()


@pytest.mark.parametrize("module", ["service.stage.shots", "service.picture.frames"])
def test_modules_of_the_workers_are_not_light(module):
    assert "pxr" in heavy_modules_after(f"import {module}")


def test_the_stage_process_loads_no_gl():
    loaded = heavy_modules_after(
        "from importlib import import_module\n"
        "from pathlib import Path\n"
        "import service.stage\n"
        "for file in Path(service.stage.__path__[0]).glob('*.py'): import_module(f'service.stage.{file.stem}')"
    )
    assert loaded & {"OpenGL", "moderngl", "pyrender"} == set()
