"""Engines are found by listing their package, without OpenGL, and nothing outside it asks for their names."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import render
import service
from render.engines import Engine, all_engines, engine_names, registry

ROOTS = [Path(room.__path__[0]) for room in (render, service)]
# The engines themselves, benches that name what they measure, and a module that is made from the OpenAPI document.
EXEMPT = ("render/engines/", "render/lab/", "service/client/models.py")
NAMES = set(engine_names())
SUBCLASS = "from render.engines import Engine\nclass Toy(Engine):\n"


def test_engines_are_listed_by_rank() -> None:
    today = ("lens", "flag", "scatter", "gather", "linear", "importance", "accumulation", "pinhole")
    assert tuple(name for name in engine_names() if name in today) == today


def test_listing_engines_loads_neither_opengl_nor_usd() -> None:
    code = "import sys, render.engines; print(sorted({'moderngl', 'OpenGL', 'pyrender', 'pxr'} & set(sys.modules)))"
    listed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert listed.stdout == "[]\n"


@pytest.mark.parametrize(
    ("code", "reason"),
    [
        ("def draw(:", "SyntaxError"),
        ("import no_such_module", "no_such_module"),
        ("{}['key']", "KeyError"),
        ('"""A page."""', "defines no subclass of Engine"),
        (f"{SUBCLASS}    pass", "needs a name, got None"),
        (f"{SUBCLASS}    name = 5", "needs a name, got 5"),
        (f"{SUBCLASS}    name = 'toy'", "needs a summary, got None"),
        (f"{SUBCLASS}    name, summary = 'lens', 'another'", "there are two engines of the name lens"),
    ],
)
def test_a_broken_engine_module_is_named(monkeypatch, tmp_path: Path, code: str, reason: str) -> None:
    (tmp_path / "broken_toy.py").write_text(code)
    monkeypatch.setattr(render.engines, "__path__", [str(tmp_path)])
    monkeypatch.delitem(sys.modules, "render.engines.broken_toy", raising=False)
    names = engine_names()
    with pytest.raises(ImportError, match=f"engine module render.engines.broken_toy cannot be used: .*{reason}"):
        registry.discover([str(tmp_path)])
    assert engine_names() == names


@pytest.mark.parametrize("engine", all_engines(), ids=engine_names())
def test_each_engine_opens_with_its_manual_page(engine: type[Engine]) -> None:
    module = inspect.getmodule(engine)
    assert module is not None
    page = module.__doc__ or ""
    assert page.startswith(f"Engine ``{engine.name}``: ")
    titles = re.findall(r"^(Computes|Settings|Cost|Limits|Source|Example):", page, re.MULTILINE)
    assert titles == ["Computes", "Settings", "Cost", "Limits", "Source", "Example"]
    assert f"--engine {engine.name}" in page


@pytest.mark.parametrize("engine", all_engines(), ids=engine_names())
def test_what_an_engine_says_it_can_do_it_has(engine: type[Engine]) -> None:
    assert engine.draw is not Engine.draw
    assert engine.takes_velocities == (engine.draw_swept is not Engine.draw_swept)
    assert engine.draws_in_steps == (engine.draw_in_steps is not Engine.draw_in_steps)
    assert engine.draws_in_steps == (engine.partial_picture is not Engine.partial_picture)


def test_nothing_outside_the_engines_compares_or_lists_their_names() -> None:
    found = [f"{path}:{line}" for path, tree in product() for line in uses_of_names(tree)]
    assert found == []


@pytest.mark.parametrize(
    "code",
    [
        "settings.engine == 'toy'",
        "'toy' != settings.engine",
        "engine in ('toy', *others)",
        "match settings.engine:\n    case 'toy': pass",
        "{'flag': 1, 'gather': 2}",
        "render(engine='toy')",
        "ENGINES = ('lens', 'pinhole')",
        "Literal['lens', 'flag']",
    ],
)
def test_the_check_above_sees_a_name(code: str) -> None:
    assert list(uses_of_names(ast.parse(code)))


def product() -> Iterator[tuple[str, ast.Module]]:
    for root in ROOTS:
        for file in sorted(root.rglob("*.py")):
            path = file.relative_to(root.parent).as_posix()
            if not path.startswith(EXEMPT):
                yield path, ast.parse(file.read_text(encoding="utf-8"))


def uses_of_names(tree: ast.Module) -> Iterator[int]:
    """Lines that compare an engine with a string, pass one for an engine, or have two names of engines in one collection."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Match) and is_engine(node.subject):
            yield node.lineno
        if isinstance(node, ast.expr | ast.keyword) and (passes_a_name(node) or lists_names(node)):
            yield node.lineno


def passes_a_name(node: ast.AST) -> bool:
    if isinstance(node, ast.Compare):
        sides = [node.left, *node.comparators]
        return any(map(is_engine, sides)) and any(map(strings_in, sides))
    return isinstance(node, ast.keyword) and node.arg == "engine" and bool(strings_in(node.value))


def lists_names(node: ast.AST) -> bool:
    if isinstance(node, ast.Dict):
        parts = [key for key in node.keys if key is not None]
    elif isinstance(node, ast.Tuple | ast.List | ast.Set):
        parts = node.elts
    else:
        return False
    return len(NAMES.intersection(part.value for part in parts if isinstance(part, ast.Constant))) > 1


def is_engine(node: ast.expr) -> bool:
    return (isinstance(node, ast.Attribute) and node.attr == "engine") or (
        isinstance(node, ast.Name) and node.id == "engine"
    )


def strings_in(node: ast.expr) -> list[str]:
    return [part.value for part in ast.walk(node) if isinstance(part, ast.Constant) and isinstance(part.value, str)]
