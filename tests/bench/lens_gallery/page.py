"""The page: plain HTML and its style in one file, with the pictures beside it."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from tests.bench.lens_gallery.entries import Section
from tests.bench.lens_gallery.photographs import Photograph

_STYLE = Path(__file__).with_name("style.css")


def page(sections: Sequence[tuple[Section, Sequence[Photograph]]], device: str) -> str:
    """The whole page.

    Args:
        sections: with the photographs that were taken of them.
        device: that rendered them.
    """
    links = "".join(f'<a href="#{_anchor(section)}">{escape(section.title)}</a>' for section, _ in sections)
    seconds = sum(photograph.seconds for _, photographs in sections for photograph in photographs)
    count = sum(len(photographs) for _, photographs in sections)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Pullfocus: the gallery</title>
<style>
{_STYLE.read_text()}</style>
</head>
<body>
<header>
<h1>The gallery</h1>
<p>Stocks, stops and shutters, lenses and aberrations of Pullfocus on the demo shot.
Beside each picture is a quarter of its width, enlarged twice.</p>
<nav>{links}</nav>
</header>
<main>
{"".join(_section(section, photographs) for section, photographs in sections)}</main>
<footer>{count} pictures in {seconds:.0f} s on {escape(device)}.</footer>
</body>
</html>
"""


def _section(section: Section, photographs: Sequence[Photograph]) -> str:
    figures = "".join(_figure(photograph) for photograph in photographs)
    return (
        f'<section id="{_anchor(section)}">\n<h2>{escape(section.title)}</h2>\n<p>{escape(section.text)}</p>\n'
        f'<div class="pictures">\n{figures}</div>\n</section>\n'
    )


def _figure(photograph: Photograph) -> str:
    entry = photograph.entry
    title = escape(entry.title)
    return (
        f'<figure id="{entry.slug}">\n<div class="pair">\n'
        f'<a href="{photograph.picture}"><img src="{photograph.picture}" alt="{title}" loading="lazy"></a>\n'
        f'<a href="{photograph.detail}"><img class="detail" src="{photograph.detail}" alt="{title}, detail" loading="lazy"></a>\n'
        f"</div>\n<figcaption><h3>{title}</h3><p>{escape(entry.note)}</p>"
        f'<p class="numbers">{escape(photograph.caption)} · {photograph.seconds:.1f} s</p></figcaption>\n</figure>\n'
    )


def _anchor(section: Section) -> str:
    return "-".join("".join(c if c.isalnum() else " " for c in section.title.lower()).split())
