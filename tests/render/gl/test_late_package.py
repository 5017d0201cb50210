"""Packages that run late: their submodules load without them, and they load when they are used."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest

from render.gl.late_package import import_late


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A package with a submodule, neither of them loaded."""
    folder = tmp_path / "slow_to_load"
    folder.mkdir()
    (folder / "__init__.py").write_text("from slow_to_load import part\nloaded = part.number + 1\n")
    (folder / "part.py").write_text("number = 41\n")
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("slow_to_load", "slow_to_load.part"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return "slow_to_load"


def test_a_submodule_loads_without_its_package(package: str) -> None:
    import_late(package)
    import slow_to_load.part  # type: ignore[import-not-found]

    assert slow_to_load.part.number == 41
    assert "loaded" not in vars(slow_to_load)


def test_a_package_loads_when_a_name_is_used(package: str) -> None:
    import_late(package)
    import slow_to_load

    assert slow_to_load.loaded == 42
    assert not hasattr(slow_to_load, "missing")


def test_threads_that_use_a_package_at_once_all_find_its_names(package: str) -> None:
    import_late(package)
    import slow_to_load

    together = Barrier(4)

    def use(_: int) -> int:
        together.wait()
        number: int = slow_to_load.loaded
        return number

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(use, range(4))) == [42] * 4


def test_a_package_that_is_not_installed_is_an_import_error() -> None:
    with pytest.raises(ImportError, match="no_such_package"):
        import_late("no_such_package")


def test_packages_that_pyrender_imports_work_when_they_are_used() -> None:
    code = (
        "import render.gl.compat, trimesh, networkx, pyrender\n"
        "assert trimesh.creation.box().volume == 1\n"
        "assert list(networkx.DiGraph([(1, 2)])) == [1, 2]\n"
        "import pyrender.scene as scene\n"
        "graph, node, child = pyrender.Scene(), pyrender.Node(matrix=None), pyrender.Node()\n"
        "graph.add_node(node); graph.add_node(child, node); graph.set_pose(node, 2 * graph.get_pose(node))\n"
        "assert graph.get_pose(child)[0, 0] == 2\n"
        "graph.remove_node(node); assert not graph.nodes\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
