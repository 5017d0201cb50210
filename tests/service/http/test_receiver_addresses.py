"""Addresses of receivers: which URLs may be named, and which addresses may be reached."""

from __future__ import annotations

import asyncio

import httpx
import pytest

from render.errors import InputError
from service.http.receiver_addresses import AddressError, addresses_of, check_url

PRIVATE = ["127.0.0.1", "127.8.8.8", "::1", "::ffff:7f00:1", "10.0.0.1", "172.16.0.1", "192.168.1.1", "100.64.0.1"]
PRIVATE += ["fd00::1", "fec0::1", "64:ff9b::7f00:1"]
NEVER = ["169.254.169.254", "fe80::1", "fe80::1%eth0", "224.0.0.1", "ff02::1", "0.0.0.0", "0.1.2.3", "::", "240.0.0.1"]
NEVER += ["255.255.255.255", "::ffff:169.254.169.254", "64:ff9b::a9fe:a9fe", "2002:a9fe:a9fe::", "::a9fe:a9fe"]
NEVER += ["100.100.100.200", "168.63.129.16", "fd00:ec2::254"]
PUBLIC = ["8.8.8.8", "2606:4700::1"]


def reached(*found: str, allows_private: bool = False) -> list[str]:
    """The addresses that are reached where a name has some."""

    async def look_up(host: str, port: int) -> list[str]:
        assert (host, port) == ("hooks.studio.example", 443)
        return list(found)

    url = httpx.URL("https://hooks.studio.example/x")
    return [str(address) for address in asyncio.run(addresses_of(url, look_up, allows_private=allows_private))]


@pytest.mark.parametrize("address", NEVER)
@pytest.mark.parametrize("allows_private", [False, True])
def test_some_addresses_are_never_reached(address, allows_private):
    with pytest.raises(AddressError, match=r"no address of 'hooks\.studio\.example' may be reached"):
        reached(address, allows_private=allows_private)


@pytest.mark.parametrize("address", PRIVATE)
def test_private_addresses_are_reached_where_that_is_set(address):
    with pytest.raises(AddressError, match=r"this machine$|private$"):
        reached(address)
    assert reached(address, allows_private=True) == [address]


@pytest.mark.parametrize("address", PUBLIC)
def test_public_addresses_are_reached(address):
    assert reached(address) == [address]


def test_of_several_addresses_those_that_are_allowed_are_reached():
    assert reached("127.0.0.1", "8.8.8.8", "fe80::1", "2606:4700::1") == ["8.8.8.8", "2606:4700::1"]


@pytest.mark.parametrize("error", [OSError("no such name"), UnicodeError("label too long")])
def test_a_name_without_addresses_is_an_error(error):
    async def look_up(host: str, port: int) -> list[str]:
        raise error

    with pytest.raises(AddressError, match=r"'nowhere\.example' is not found"):
        asyncio.run(addresses_of(httpx.URL("http://nowhere.example"), look_up, allows_private=True))


@pytest.mark.parametrize(
    ("url", "reason"),
    [
        ("ftp://studio.example/", "begins with http"),
        ("//studio.example/", "begins with http"),
        ("studio.example", "begins with http"),
        ("http://mara@studio.example/", "names a user"),
        ("http://mara:word@studio.example/", "names a user"),
        ("http://studio.example\\@other.example/", "names a user"),
        ("http://studio.example/#part", "has a fragment"),
        ("http:///path", "names no host"),
        ("http://studio.example:0/", "its port is none"),
        ("http://studio.example:99999/", "its port is none"),
        ("http://studio example/", "has spaces"),
        ("http://studio.example/\n", "cannot be read"),
        ("http://studio.example/\u2028", "has spaces or control"),
        ("http://[::1", "cannot be read"),
        ("http://\udcff.example/", "cannot be read"),
    ],
)
def test_an_url_of_no_receiver_is_refused(url, reason):
    with pytest.raises(InputError, match=reason):
        check_url(url)


@pytest.mark.parametrize(
    "url", ["http://studio.example", "https://studio.example:8443/a?b=c", "https://[2606:4700::1]/"]
)
def test_an_url_of_a_receiver_is_taken(url):
    check_url(url)
