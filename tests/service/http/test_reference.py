"""The page /docs shows every call and every model, from this service alone."""

from __future__ import annotations

import re

from service.http.reference import reference_page


def test_every_call_and_model_is_there(client):
    page, document = client.get("/docs").text, client.get("/openapi.json").json()
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            assert f'id="{operation["operationId"]}"' in page
            assert f"<code>{method.upper()} {path}</code>" in page
    assert set(re.findall(r'href="#(\w+)"', page)) <= set(re.findall(r'id="(\w+)"', page))
    assert document["components"]["schemas"].keys() <= set(re.findall(r'id="(\w+)"', page))


def test_nothing_comes_from_another_origin(client):
    page = client.get("/docs").text
    assert "<script" not in page
    assert "style=" not in page
    addresses = re.findall(r'(?:href|src)="([^"#]*)"', page)
    assert "/docs/style.css" in addresses
    assert [address for address in addresses if address and not re.match(r"/[^/]", address)] == []
    style = client.get("/docs/style.css")
    assert style.headers["content-type"].startswith("text/css")
    assert "url(" not in style.text
    assert "@import" not in style.text


def test_requests_to_try_are_answered(client):
    page = client.get("/docs").text
    for address in ("/livez", "/v1/shots", "/v1/lenses", "/v1/films"):
        assert f'<a href="{address}">Try it</a>' in page
        assert client.get(address).status_code == 200
    assert '<a href="/v1/shots/demo/frame?time=' in page


def test_foreign_words_are_no_markup():
    document = {
        "info": {"title": "<b>", "version": "1", "description": "<script>"},
        "paths": {},
        "components": {"schemas": {"A": {"description": "<i>", "example": {"<u>": "</pre>"}}}},
    }
    page = reference_page(document)
    assert not [mark for mark in ("<b>", "<script>", "<i>", "<u>") if mark in page]
    assert page.count("</pre>") == 1
