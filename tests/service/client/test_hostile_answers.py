"""Answers that no service gives: each is one error of the client."""

from __future__ import annotations

import httpx
import pytest

from service.client import Client, ClientError, FileError, SettingError, WaitTimeoutError
from tests.service.client.fake import RENDER, Fake, in_turn


@pytest.mark.parametrize("place", ["http://xn--a/", "http://[", "http://host:port/"])
def test_a_redirect_to_nowhere_is_an_error(place):
    service = Fake(lambda _: httpx.Response(302, headers={"Location": place}))
    with service.client() as client, pytest.raises(ClientError):
        client.shots()


@pytest.mark.parametrize("status", [404, 503])
def test_a_date_beyond_all_dates_is_no_pause(status):
    headers = {"Retry-After": "Mon, 01 Jan 2024 00:00:00 +999999999999999999", "Date": "Mon, 01 Jan 2024 00:00:00 GMT"}
    with Fake(lambda _: httpx.Response(status, headers=headers)).client() as client, pytest.raises(ClientError):
        client.shots()


def test_a_number_beyond_all_numbers_is_an_error():
    content = httpx.Response(200, json=RENDER | {"secondsLeft": 1}).text.replace(
        '"secondsLeft":1', f'"secondsLeft":1{"0" * 400}'
    )
    with in_turn(httpx.Response(200, text=content)).client() as client, pytest.raises(ClientError):
        client.get("r-1")


def test_waiting_ends_in_time_while_the_service_is_away(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("service.client.operations.time.monotonic", lambda: now[0])
    monkeypatch.setattr("service.client.sync_client._pause", lambda seconds, _: now.__setitem__(0, now[0] + seconds))
    answers = iter([httpx.Response(200, json=RENDER | {"state": "running"})])

    def reply(_: httpx.Request) -> httpx.Response:
        for answer in answers:
            return answer
        raise httpx.ConnectError("refused")

    with Fake(reply).client() as client, pytest.raises(WaitTimeoutError):
        client.wait("r-1", timeout_s=5)
    assert now[0] < 6


def test_a_page_is_no_movie(tmp_path):
    page = httpx.Response(200, text="<html>", headers={"Content-Type": "text/html"})
    with in_turn(page).client() as client, pytest.raises(ClientError, match="text/html"):
        client.movie("r-1", tmp_path / "shot.mp4")
    with in_turn(page).client() as client, pytest.raises(ClientError, match="expected text/csv"):
        client.focus_report("r-1", tmp_path / "focus.csv")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "url", ["http://xn--a", "http://xn--", "ftp://user:hunter2@host", "http://user:hunter2@host:x"]
)
def test_an_address_that_is_none_shows_no_password(url):
    with pytest.raises(SettingError) as refused:
        Client(url)
    assert "hunter2" not in str(refused.value)


def test_names_that_are_no_text_are_errors(tmp_path):
    with in_turn().client() as client:
        with pytest.raises(FileError):
            client.push("a\0.usda")
        (tmp_path / "\udcff.usda").write_text("#usda 1.0")
        with pytest.raises(FileError, match="UTF-8"):
            client.push(tmp_path / "\udcff.usda")
        with pytest.raises(SettingError):
            client.get("\ud800")
