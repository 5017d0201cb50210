"""Pages that are files of the repository: the README as the overview, the measurements."""

from __future__ import annotations

import re
from pathlib import Path

_LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?:)([^)#\s]+)(#[^)\s]*)?\)")


def index_page(root: Path) -> str:
    """The README, its links relative to docs/. Links to files outside docs/ become plain text: the site does not hold them."""

    def relinked(match: re.Match[str]) -> str:
        bang, text, target, fragment = match.groups()
        if target.startswith("docs/"):
            return f"{bang}[{text}]({target.removeprefix('docs/')}{fragment or ''})"
        return text

    return _LINK.sub(relinked, (root / "README.md").read_text(encoding="utf-8"))


def repository_page(root: Path, path: str) -> str:
    """A Markdown file of the repository that holds no relative links."""
    return (root / path).read_text(encoding="utf-8")
