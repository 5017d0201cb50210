"""The keys of the page: the table beside this module, which the tests of the page hold to its commands."""

from __future__ import annotations

from pathlib import Path

PLACE = "{{ keys }}"
"""Line of a page that the tables replace."""
TABLES = "docs/_site/keys.md"


def with_keys(markdown: str, root: Path) -> str:
    """A page with the tables of keys in their place."""
    if PLACE not in markdown:
        return markdown
    return markdown.replace(PLACE, (root / TABLES).read_text(encoding="utf-8").rstrip())
