"""The doors: a web page from elsewhere may neither look in nor change anything."""

from __future__ import annotations

import pytest

from service.http.settings import Settings
from tests.service.conftest import running


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example:8000", "localhost.evil.example", ""])
def test_a_foreign_host_name_is_refused(client, host):
    answer = client.get("/v1/shots", headers={"Host": host})
    assert (answer.status_code, answer.json()["code"]) == (421, "unknown_host")


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:5173", "127.0.0.1:1", "[::1]:8000"])
def test_this_machine_s_names_are_taken(client, host):
    assert client.get("/v1/shots", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize("method", ["POST", "DELETE", "PATCH", "PUT"])
def test_a_page_of_another_site_changes_nothing(client, room, method):
    answer = client.request(method, f"/v1/shots/{room}", headers={"Sec-Fetch-Site": "cross-site"})
    assert (answer.status_code, answer.json()["code"]) == (403, "cross_site")
    assert client.get(f"/v1/shots/{room}").status_code == 200


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://localhost:1"])
def test_the_origin_of_what_changes_something_is_ours(client, room, origin):
    answer = client.delete(f"/v1/shots/{room}", headers={"Origin": origin})
    assert (answer.status_code, answer.json()["code"]) == (403, "cross_site")
    own = str(client.base_url).rstrip("/")
    assert client.delete("/v1/shots/none", headers={"Origin": own}).status_code == 404


def test_another_site_may_link_here_and_embed_nothing(client):
    headers = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"}
    assert client.get("/v1/shots", headers=headers).json()["code"] == "cross_site"
    assert client.get("/v1/shots", headers=headers | {"Sec-Fetch-Mode": "navigate"}).status_code == 200


@pytest.mark.parametrize("site", ["same-origin", "same-site", "none"])
def test_our_own_page_may(client, site):
    assert client.delete("/v1/shots/none", headers={"Sec-Fetch-Site": site}).status_code == 404


def test_no_other_site_may_read(client):
    answer = client.get("/v1/shots", headers={"Origin": "https://evil.example"})
    assert not [name for name in answer.headers if name.startswith("access-control-")]


def test_the_page_says_how_to_build_it_or_is_served(tmp_path):
    built = tmp_path / "static"
    with running(Settings(data=tmp_path / "one", demo=False, static=built)) as service:
        missing = service.client.get("/")
        assert missing.status_code == 503
        assert "make setup" in missing.text
    (built / "assets").mkdir(parents=True)
    (built / "index.html").write_text("<!doctype html><title>Built</title>")
    (built / "assets" / "page-1234.js").write_text("1")
    (built / "favicon.svg").write_text("<svg/>")
    with running(Settings(data=tmp_path / "two", demo=False, static=built)) as service:
        assert "Built" in service.client.get("/").text
        assert service.client.get("/assets/page-1234.js").text == "1"
        assert service.client.get("/favicon.svg").headers["content-type"].startswith("image/svg")
        for path in ("/assets/../index.html", "/assets/%2e%2e/%2e%2e/one/lock", "/assets/none.js", "/index.htm"):
            answer = service.client.get(path)
            assert answer.status_code == 404, path
            assert answer.json()["code"] == "not_found"
