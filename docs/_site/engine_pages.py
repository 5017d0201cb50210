"""The engines' manual pages, which are the docstrings of the modules in render/engines."""

from __future__ import annotations

import ast
from pathlib import Path

INTRODUCTION = """# Engines

An engine draws the picture of a scene through a camera. `--engine NAME` chooses one, and the
[guide](../guide/engines.md) compares them.

"""


def page(root: Path) -> str:
    """One section for each module of render/engines that defines an engine."""
    modules = [file.stem for file in sorted((root / "render/engines").glob("*.py")) if _defines_engine(file)]
    directives = (
        f"::: render.engines.{name}\n    options:\n      members: false\n      show_root_full_path: false\n"
        for name in modules
    )
    return INTRODUCTION + "\n".join(directives)


def _defines_engine(file: Path) -> bool:
    """Whether a module has a public class that has a method ``draw``."""
    classes = (node for node in ast.parse(file.read_text(encoding="utf-8")).body if isinstance(node, ast.ClassDef))
    return any(isinstance(node, ast.FunctionDef) and node.name == "draw" for cls in classes for node in cls.body)
