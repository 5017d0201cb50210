"""The files, modules and names that the pages mention exist."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / name for name in ("README.md", "usd_schemas/README.md", "tests/bench/RESULTS.md")]
PAGES += sorted((ROOT / "docs").rglob("*.md"))
CODE = re.compile(r"`([^`\n]+)`")
ROOMS = "render|service|usd_schemas|tests|web|scripts|docs"
FILE = re.compile(rf"(?:{ROOMS})/[\w./-]*")
DOTTED = re.compile(rf"(?:{ROOMS})(?:\.\w+)+")


def mentions(page: Path, pattern: re.Pattern[str]) -> list[str]:
    """Names in the code spans of a page that match a pattern, placeholders left out."""
    spans = (span.removesuffix("/*") for span in CODE.findall(page.read_text(encoding="utf-8")))
    return [span for span in spans if pattern.fullmatch(span) and "NAME" not in span]


def exists(dotted: str) -> bool:
    """Whether there is a package or module of that name, or one that defines the last part of it."""
    path = ROOT.joinpath(*dotted.split("."))
    if path.is_dir() or path.with_suffix(".py").is_file():
        return True
    module, name = path.parent, path.name
    source = module / "__init__.py" if module.is_dir() else module.with_suffix(".py")
    if not source.is_file():
        return False
    return re.search(rf"\b{name}\b", source.read_text(encoding="utf-8")) is not None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_a_page_mentions_exists(page: Path) -> None:
    assert [name for name in mentions(page, FILE) if not (ROOT / name).exists()] == []
    assert [name for name in mentions(page, DOTTED) if not exists(name)] == []


def test_the_pages_mention_files_and_modules() -> None:
    assert sum(len(mentions(page, FILE)) for page in PAGES) > 30
    assert sum(len(mentions(page, DOTTED)) for page in PAGES) > 20
