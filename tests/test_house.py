"""Rules of the house that no linter knows: names of tests, imports between tests, waits in pages, first words of docstrings."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("usd_schemas", "render", "service", "tests")
LONGEST_NAME = len("test_") + 60
BAD_START = re.compile(r"(Of|What|That|How)\b")


@cache
def trees(package: str) -> dict[str, ast.Module]:
    """Parse a package's files, by their path."""
    return {
        path.relative_to(ROOT).as_posix(): ast.parse(path.read_text(encoding="utf-8"))
        for path in sorted((ROOT / package).rglob("*.py"))
    }


def docstrings(tree: ast.Module) -> Iterator[ast.Constant]:
    """Find the docstrings of a file: of the module, its classes and functions, and those below constants and fields."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for statement in body if isinstance(body, list) else ():
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                yield statement.value


def test_a_tests_name_has_at_most_60_characters() -> None:
    names = [
        f"{path}: {node.name}"
        for path, tree in trees("tests").items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and node.name.startswith("test_")
        and len(node.name) > LONGEST_NAME
    ]
    assert names == []


def test_no_test_imports_another_test() -> None:
    """Helpers that tests share are in kits."""
    imports = [
        f"{path}: {node.module}"
        for path, tree in trees("tests").items()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and re.match(r"tests\..*\btest_", node.module or "")
    ]
    assert imports == []


def test_pages_are_waited_for_by_functions() -> None:
    """Playwright evaluates an expression anew at each look, which the page's policy of scripts refuses after the first."""
    found = [
        f"{path}:{node.lineno}"
        for path, tree in trees("tests").items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and node.func.attr == "wait_for_function"
        and isinstance(node.args[0], ast.Constant)
        and "=>" not in str(node.args[0].value)
    ]
    assert found == []


def test_docstrings_begin_with_a_verb_or_a_noun() -> None:
    found = [
        f"{path}:{docstring.lineno}: {docstring.value.strip().splitlines()[0]}"
        for package in PACKAGES
        for path, tree in trees(package).items()
        for docstring in docstrings(tree)
        if isinstance(docstring.value, str) and BAD_START.match(docstring.value.strip())
    ]
    assert found == []
