"""Exposure: a service that others can reach needs keys, and answers to its own names alone."""

from __future__ import annotations

import socket

import pytest

from render.cli.main import main
from render.errors import SettingsError
from service.http.exposure import with_exposure
from service.http.settings import Settings
from service.identity.keys import Keys
from tests.service.conftest import running


def exposed(tmp_path, host="127.0.0.1", names=(), **given):
    names = (*Settings().allowed_hosts, *names)
    return with_exposure(Settings(data=tmp_path, host=host, allowed_hosts=names, **given))


@pytest.mark.parametrize(
    "given",
    [
        {"host": "0.0.0.0"},
        {"host": "::"},
        {"names": ("tram.example",)},
        {"trusted_proxies": ("10.0.0.2",)},
        {"host": "localhost", "access": "keys"},
    ],
)
def test_a_service_that_others_reach_needs_keys(tmp_path, given):
    with pytest.raises(SettingsError, match="pullfocus keys create"):
        exposed(tmp_path, **given)
    Keys(tmp_path).create("Mara", frozenset({"read"}), "default")
    assert exposed(tmp_path, **given).access == "keys"


@pytest.mark.parametrize(
    ("given", "says", "ways"),
    [({"host": "0.0.0.0"}, "could be reached by others", True), ({"access": "keys"}, "this service needs keys", False)],
)
def test_a_service_without_keys_says_why_it_needs_some(tmp_path, given, says, ways):
    with pytest.raises(SettingsError, match=says) as refused:
        exposed(tmp_path, **given)
    assert ("--insecure" in str(refused.value)) == ways


def test_a_folder_without_keys_is_named(tmp_path, capfd):
    assert main(["keys", "list", "--data", str(tmp_path / "mistyped")]) == 0
    assert "there are no keys in" in capfd.readouterr().err
    assert not (tmp_path / "mistyped").exists()


def test_a_service_of_this_machine_alone_is_open(tmp_path):
    Keys(tmp_path).create("Mara", frozenset({"read"}), "default")
    for host in ("127.0.0.1", "localhost", "::1"):
        assert exposed(tmp_path, host) == Settings(data=tmp_path, host=host)


def test_an_insecure_service_says_so(tmp_path, caplog):
    assert exposed(tmp_path, "0.0.0.0", access="insecure").access == "insecure"
    assert "INSECURE" in caplog.text


def test_the_names_of_a_service_are_its_own(tmp_path):
    hosts = exposed(tmp_path, "192.0.2.7", ("Tram.example",), access="insecure").allowed_hosts
    assert {"192.0.2.7", "tram.example", socket.gethostname().lower()} <= set(hosts)
    for wrong in ("a:80", "*", "", "http://a"):
        with pytest.raises(SettingsError, match="allowed host"):
            exposed(tmp_path, names=(wrong,), access="insecure")


def test_the_address_that_a_connection_came_to_is_a_name(tmp_path):
    with running(Settings(data=tmp_path, demo=False, allowed_hosts=("tram.example",))) as service:
        statuses = [
            service.client.get("/livez", headers={"Host": host}).status_code
            for host in ("127.0.0.1:1", "tram.example", "127.0.0.2", "evil.example")
        ]
        assert statuses == [200, 200, 421, 421]


def test_serve_refuses_to_start_without_keys(tmp_path, capfd):
    assert main(["serve", "--host", "0.0.0.0", "--port", "0", "--data", str(tmp_path)]) == 2
    printed = capfd.readouterr().err
    assert printed.count("\n") == 1
    assert "--insecure" in printed
