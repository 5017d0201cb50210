"""The Python reference: a page for each package, whose members mkdocstrings reads from the source without importing it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from docs._site.markdown import first_sentence, plain, table

ROOMS = ("usd_schemas", "render", "service")
INTRODUCTION = """# Python

Each page is made from the docstrings of one package. Names that begin with an underscore are left out.

"""
LEFT_OUT = ("render.lab", "render.demo")
"""Packages without a page: benches and the demo shot's geometry are for those who read the source."""

MIGRATIONS = "migrations"
"""Folder of scripts that Alembic runs, which nobody imports."""


def pages(root: Path, index: str) -> dict[str, str]:
    """The index and a page for each package, by path."""
    packages = {name: modules for room in ROOMS for name, modules in _packages(root, room)}
    rows = ((f"[{name}]({name}.md)", plain(_summary(root, name))) for name in packages)
    made = {index: INTRODUCTION + table(("package", "content"), rows)}
    folder = index.rpartition("/")[0]
    for name, modules in packages.items():
        made[f"{folder}/{name}.md"] = _page(name, modules)
    return made


def _packages(root: Path, room: str) -> Iterator[tuple[str, list[str]]]:
    """Packages down to the second level, each with all modules below it that are of no other."""
    top = root / room
    yield room, [room, *(f"{room}.{file.stem}" for file in sorted(top.glob("*.py")) if _is_public(file))]
    for folder in sorted(path for path in top.iterdir() if (path / "__init__.py").exists()):
        name = f"{room}.{folder.name}"
        if name not in LEFT_OUT:
            yield (
                name,
                [name, *(_module(root, file) for file in sorted(folder.rglob("*.py")) if _is_public(file, folder))],
            )


def _is_public(file: Path, package: Path | None = None) -> bool:
    if file.name == "__init__.py" and MIGRATIONS not in file.parts:
        return package is not None and file.parent != package
    return not file.stem.startswith("_") and MIGRATIONS not in file.parts


def _module(root: Path, file: Path) -> str:
    parts = file.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _summary(root: Path, module: str) -> str:
    base = root.joinpath(*module.split("."))
    file = base / "__init__.py" if base.is_dir() else base.with_suffix(".py")
    return first_sentence(ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "")


def _page(package: str, modules: list[str]) -> str:
    directives = [f"::: {name}\n    options:\n      heading_level: {1 if name == package else 2}\n" for name in modules]
    return f"---\ntitle: {package}\n---\n\n" + "\n".join(directives)
