"""The page's table of settings: current, and with a slider for each number that REST has a range for the page of."""

from __future__ import annotations

from pathlib import Path

from service.http.page_settings import page_settings

TABLE = Path(__file__).parents[3] / "web" / "src" / "model" / "settings.gen.ts"


def test_the_page_is_built_with_the_declared_settings():
    """Written anew by `make schema`."""
    assert TABLE.read_text(encoding="utf-8") == page_settings()
