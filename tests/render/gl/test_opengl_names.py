"""Names of OpenGL that this package and pyrender use are there, though most of PyOpenGL's modules are never run."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

import pytest

import render
from render.gl.compat import GL, pyrender

pytestmark = pytest.mark.gl

_A_NAME = re.compile(r"gl[A-Z]|GL_")


def test_every_opengl_name_of_this_package_is_there() -> None:
    used = set()
    for file in Path(render.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "GL":
                used.add(node.attr)
    assert {"glClearTexImage", "glTexStorage2D", "GL_ANY_SAMPLES_PASSED"} <= used
    assert {name for name in used if name not in vars(GL)} == set()


@pytest.mark.parametrize("name", ["light", "primitive", "renderer", "shader_program", "texture"])
def test_every_opengl_name_of_pyrender_is_there(name: str) -> None:
    module = sys.modules[f"{pyrender.__name__}.{name}"]
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    used = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and _A_NAME.match(node.id)}
    assert used
    assert used - set(vars(module)) == set()
