"""The keys of the page, from the list in web/src/view/keyboard.ts that its help shows."""

from __future__ import annotations

import re
from pathlib import Path

from docs._site.markdown import table

PLACE = "{{ keys }}"
"""Line of a page that the table replaces."""
_SHORTCUT = re.compile(r'\{\s*keys: "(.*?)",\s*does: "(.*?)",?\s*\}')


def with_keys(markdown: str, root: Path) -> str:
    """A page with the table of keys in its place."""
    if PLACE not in markdown:
        return markdown
    source = (root / "web/src/view/keyboard.ts").read_text(encoding="utf-8")
    rows = [(f"`{keys}`", does) for keys, does in _SHORTCUT.findall(source)]
    return markdown.replace(PLACE, table(("key or click", "effect"), rows))
