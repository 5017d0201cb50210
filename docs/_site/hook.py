"""The mkdocs hook: adds the pages that are generated from the code.

mkdocs loads this file (`hooks` in mkdocs.yml) and calls the functions named ``on_…``. Pages are generated in memory at
each build and none of them is checked in. Every other module of this folder returns the Markdown of one kind of page.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from docs._site import (
    command_line,
    engine_pages,
    keys,
    lens_library,
    openapi,
    overview,
    properties,
    python_api,
    schema,
    service_settings,
)

ROOT = Path(__file__).parents[2]
PYTHON_INDEX = "reference/python/index.md"


@functools.cache
def generated_pages() -> dict[str, str]:
    """Markdown of every generated page, by its path under docs/."""
    return {
        "index.md": overview.index_page(ROOT),
        "reference/measurements.md": overview.repository_page(ROOT, "tests/bench/RESULTS.md"),
        "reference/schema.md": schema.page(ROOT),
        "reference/command_line.md": command_line.page(),
        "reference/rest.md": openapi.routes_page(ROOT),
        "reference/models.md": openapi.models_page(ROOT),
        "reference/engines.md": engine_pages.page(),
        "reference/properties.md": properties.page(),
        "reference/lens_library.md": lens_library.page(),
        "reference/service_settings.md": service_settings.page(),
        **python_api.pages(ROOT, PYTHON_INDEX),
    }


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Replace the entry of the Python reference in the navigation by the list of its pages."""
    config.nav = _with_python_pages(config.nav)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages to those in docs/."""
    for path, text in generated_pages().items():
        files.append(File.generated(config, path, content=text))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Put generated tables into pages that have a place for them."""
    return keys.with_keys(markdown, ROOT)


def _with_python_pages(entry: Any) -> Any:
    if isinstance(entry, list):
        return [_with_python_pages(child) for child in entry]
    if isinstance(entry, dict):
        return {title: _with_python_pages(child) for title, child in entry.items()}
    if entry == PYTHON_INDEX:
        return [path for path in generated_pages() if path.startswith("reference/python/")]
    return entry
