"""The client is a wheel of its own, which needs httpx alone."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

from service.client.connecting import VERSION

CLIENT = Path(__file__).parents[3] / "service" / "client"
PROGRAM = """
import asyncio, sys
from pullfocus_client import AsyncClient, Client, ConnectionFailedError, Retries
loaded = {name.partition(".")[0] for name in sys.modules}
assert not loaded & {"service", "render", "usd_schemas", "pydantic", "pxr", "numpy"}, loaded
try:
    Client("http://127.0.0.1:1", retries=Retries(tries=1)).shots()
except ConnectionFailedError:
    print("imported")
"""


def test_the_wheel_is_built_and_imported_by_itself(tmp_path):
    source = tmp_path / "source"
    shutil.copytree(CLIENT, source, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
    subprocess.run([*build, "--wheel-dir", str(tmp_path), str(source)], check=True, cwd=tmp_path)
    (wheel,) = tmp_path.glob("pullfocus_client-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "installed")
        metadata = next(name for name in archive.namelist() if name.endswith("METADATA"))
        needs = [line for line in archive.read(metadata).decode().splitlines() if line.startswith("Requires-Dist")]
    installed = {path.name for path in (tmp_path / "installed" / "pullfocus_client").iterdir()}
    assert installed == {path.name for path in CLIENT.iterdir() if path.suffix in (".py", ".typed")}
    assert needs == ["Requires-Dist: httpx>=0.27"]
    path = f"import sys; sys.path.insert(0, {str(tmp_path / 'installed')!r})\n"
    ran = subprocess.run([sys.executable, "-I", "-c", path + PROGRAM], capture_output=True, text=True, cwd=tmp_path)
    assert ran.stdout == "imported\n", ran.stderr


def test_the_version_is_that_of_the_wheel():
    assert tomllib.loads((CLIENT / "pyproject.toml").read_text())["project"]["version"] == VERSION
