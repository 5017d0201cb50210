"""The generated reference pages hold everything that the code declares."""

from __future__ import annotations

import json
from pathlib import Path

from pxr import Sdf

from docs._site import (
    command_line,
    keys,
    lens_library,
    openapi,
    overview,
    properties,
    python_api,
    schema,
    service_settings,
)
from render.stage.honoured.rules import RULES
from service.http.configuration import setting_types
from usd_schemas import library_lenses
from usd_schemas.lens_search import FAMILIES

COMMANDS = (
    "record",
    "inspect",
    "focus-curve",
    "meter",
    "lenses show",
    "films show",
    "splats",
    "demo",
    "serve",
    "push",
    "render",
    "jobs watch",
    "doctor",
    "backup",
    "restore",
    "bench lens",
)
ROOT = Path(__file__).parents[2]


def test_the_command_line_page_has_every_command() -> None:
    page = command_line.page()
    for command in COMMANDS:
        assert f"# pullfocus {command} {{" in page
    assert "`--imageWidth PX` `-w PX`" in page
    assert str(Path.home()) not in page


def test_the_rest_pages_have_every_route_and_model() -> None:
    document = json.loads((ROOT / "web/openapi.json").read_text(encoding="utf-8"))
    routes, models = openapi.routes_page(ROOT), openapi.models_page(ROOT)
    assert [path for path in document["paths"] if f"{path}`" not in routes] == []
    assert [name for name in document["components"]["schemas"] if f"## {name} {{" not in models] == []


def test_the_schema_page_has_every_property() -> None:
    layer = Sdf.Layer.OpenAsAnonymous(str(ROOT / "usd_schemas/schema.usda"))
    page = schema.page(ROOT)
    names = [prop.name for prim in layer.rootPrims for prop in prim.properties]
    assert len(names) > 100
    assert [name for name in names if f"#### `{name}` {{" not in page] == []


def test_the_properties_page_has_every_rule() -> None:
    page = properties.page()
    for schema_name, rules in RULES.items():
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{schema_name}` |")]
        for names in (rules.honoured, *rules.neutral, *rules.ignored, *rules.named):
            assert all(f"`{name}`" in row for name in names.split() if name != "*")


def test_the_page_of_lenses_has_each_with_its_source() -> None:
    page = lens_library.page()
    for lens in library_lenses():
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{lens.name}` |")]
        assert row.endswith(f"| {lens.source} |")
    assert all(f"| {word} |" in page for word in FAMILIES)


def test_the_page_of_settings_explains_each_of_them() -> None:
    page = service_settings.page()
    for name, default in (("port", "`8000`"), ("max_upload_mb", "`512`"), ("demo", "`true`"), ("data", "`~/")):
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{name}` |")]
        assert default in row
    assert page.count("\n| `") == len(setting_types())
    assert str(Path.home()) not in page


def test_the_python_pages_name_every_package() -> None:
    pages = python_api.pages(ROOT, "index.md")
    for package in ("usd_schemas", "render.optics", "render.shot", "service.http"):
        assert f"::: {package}\n" in pages[f"/{package}.md"]


def test_the_overview_links_to_pages_of_the_site_alone() -> None:
    page = overview.index_page(ROOT)
    assert "](guide/shots.md)" in page
    assert "](docs/" not in page


def test_the_keys_of_the_page_have_their_place() -> None:
    page = keys.with_keys((ROOT / "docs/guide/page.md").read_text(encoding="utf-8"), ROOT)
    assert keys.PLACE not in page
    assert "| `Space` | Play or pause |" in page
