"""Pieces of Markdown that several generated pages use."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_CODE = re.compile(r"(`[^`]*`)")


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; line breaks and bars in cells are escaped."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(_cell(cell) for cell in line) + " |" for line in lines) + "\n"


def plain(text: str) -> str:
    """Text in which `<` and `*` outside code spans stand for themselves."""
    parts = _CODE.split(text)
    return "".join(part if part.startswith("`") else re.sub(r"([<*])", r"\\\1", part) for part in parts)


def anchor(text: str) -> str:
    """An HTML id made of a name."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")


def first_sentence(text: str) -> str:
    """The first sentence of a docstring, without its full stop."""
    line = " ".join(text.strip().split("\n\n")[0].split())
    return re.split(r"(?<=[a-z0-9)`])[.:] ", line)[0].rstrip(".")


def _cell(text: str) -> str:
    """Text on one line; a bar outside code spans does not end the cell."""
    parts = _CODE.split(" ".join(text.split()))
    return "".join(part if part.startswith("`") else part.replace("|", "\\|") for part in parts)
