"""The plugin in processes of its own: found without our Python, and refused loudly where it cannot work."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from usd_schemas import PLUGIN_FOLDER


def run_python(code: str, *, path: Path | None = None, plugins: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run code in a fresh interpreter, with our Python only where `path` says it is."""
    environment = {
        name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PXR_PLUGINPATH_NAME")
    }
    if path:
        environment["PYTHONPATH"] = str(path)
    if plugins:
        environment["PXR_PLUGINPATH_NAME"] = str(plugins)
    return subprocess.run(
        [sys.executable, "-c", code],
        env=environment,
        cwd=os.sep,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def copy_package(folder: Path) -> Path:
    """A copy of the package that can be broken."""
    return Path(shutil.copytree(PLUGIN_FOLDER, folder / "usd_schemas", ignore=shutil.ignore_patterns("__pycache__")))


def test_a_tool_without_our_python_knows_the_schemas(tmp_path: Path) -> None:
    plugin = tmp_path / "plugin"
    plugin.mkdir()
    for name in ("plugInfo.json", "generatedSchema.usda"):
        shutil.copy(PLUGIN_FOLDER / name, plugin)
    done = run_python(
        "from pxr import Usd, UsdGeom\n"
        "stage = Usd.Stage.CreateInMemory()\n"
        "lens = stage.DefinePrim('/lens', 'LensCamera')\n"
        "camera = UsdGeom.Camera.Define(stage, '/camera').GetPrim()\n"
        "camera.ApplyAPI('FocusPointAPI', 'hero')\n"
        "weight = camera.GetAttribute('focusPoint:hero:weight')\n"
        "print(lens.IsA(UsdGeom.Camera), lens.GetAttribute('lens:model').Get(), weight.Get())\n"
        "print(weight.GetDocumentation().splitlines()[-1], weight.GetDisplayGroup())\n",
        plugins=plugin,
    )
    assert done.stdout.splitlines() == ["True thin 1.0", "Unit: none, a ratio. Focus Point"], done.stderr


def test_import_after_the_first_schema_query_is_a_helpful_error() -> None:
    done = run_python(
        "from pxr import Usd\nstage = Usd.Stage.CreateInMemory()\nstage.DefinePrim('/a', 'Camera').IsA('Camera')\n"
        "import usd_schemas\n",
        path=PLUGIN_FOLDER.parent,
    )
    assert done.returncode == 1
    assert "SchemaError: USD does not know LensAPI" in done.stderr
    assert "before any stage is opened" in done.stderr


def test_import_works_where_the_environment_names_the_same_plugin() -> None:
    done = run_python("import usd_schemas", path=PLUGIN_FOLDER.parent, plugins=PLUGIN_FOLDER)
    assert done.returncode == 0, done.stderr


def test_settings_load_without_usd_which_then_finds_the_plugin() -> None:
    done = run_python(
        "import sys, usd_schemas.settings.schemas\n"
        "print(any(name in sys.modules for name in ('pxr', 'numpy')))\n"
        "from pxr import Usd\n"
        "stage = Usd.Stage.CreateInMemory()\n"
        "print(stage.DefinePrim('/a', 'LensCamera').HasAPI('FilmAPI'))\n",
        path=PLUGIN_FOLDER.parent,
    )
    assert done.stdout.split() == ["False", "True"], done.stderr


def test_another_version_that_usd_took_first_is_an_error(tmp_path: Path) -> None:
    other = copy_package(tmp_path)
    generated = other / "generatedSchema.usda"
    generated.write_text(generated.read_text().replace("int aperture:blades = 0", "int aperture:blades = 9"))
    done = run_python(
        "from pxr import Plug\nPlug.Registry().GetAllPlugins()\nimport usd_schemas",
        path=PLUGIN_FOLDER.parent,
        plugins=other,
    )
    assert done.returncode == 1
    assert "SchemaError: two versions of the USD plugin pullfocus" in done.stderr
    assert str(other) in done.stderr


def test_a_missing_generated_file_is_named_and_can_be_generated(tmp_path: Path) -> None:
    package = copy_package(tmp_path)
    (package / "generatedSchema.usda").unlink()
    done = run_python("import usd_schemas\nusd_schemas.LensCamera", path=tmp_path)
    assert done.returncode == 1
    assert "lacks generatedSchema.usda" in done.stderr
    made = subprocess.run([sys.executable, package / "generate.py"], capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    assert (package / "generatedSchema.usda").read_bytes() == (PLUGIN_FOLDER / "generatedSchema.usda").read_bytes()


@pytest.mark.parametrize("field", ["schemaKind", "bases"])
def test_plugin_info_that_usd_drops_in_silence_is_an_error(tmp_path: Path, field: str) -> None:
    package = copy_package(tmp_path)
    info = package / "plugInfo.json"
    info.write_text(info.read_text().replace(f'"{field}"', '"forgotten"'))
    done = run_python("import usd_schemas\nusd_schemas.LensCamera", path=tmp_path)
    assert done.returncode == 1
    assert "SchemaError" in done.stderr
    assert "LensAPI" in done.stderr


def test_the_readme_runs() -> None:
    text = (PLUGIN_FOLDER / "README.md").read_text(encoding="utf-8")
    code = text.split("```python\n")[1].split("```")[0]
    done = run_python(code, path=PLUGIN_FOLDER.parent)
    assert done.returncode == 0, done.stderr
    assert 0.4 < float(done.stdout) < 0.6
