"""Addresses of receivers of webhooks: which URLs may be named, and which addresses of the network may be reached.

A name is looked up for each delivery, and the connection goes to one of the addresses that were checked, so that a name which
changes in between leads nowhere else.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from ipaddress import IPv4Address, IPv6Address, IPv6Network, ip_address

import httpx

from render.errors import InputError, PullfocusError

Address = IPv4Address | IPv6Address
LookUp = Callable[[str, int], Awaitable[list[str]]]

METADATA = frozenset(
    map(ip_address, ("168.63.129.16", "100.100.100.200", "192.0.0.192", "fd00:ec2::254", "fd20:ce::254"))
)
"""Services of clouds that tell a machine its credentials, and are not link-local as the others are."""
NAT64 = IPv6Network("64:ff9b::/96")
MOST_ADDRESSES = 4
"""Addresses of a name that are tried."""
_THREADS = ThreadPoolExecutor(32, "look-up")
"""Threads of look-ups, which may take long: neither other work in threads nor the end of the event loop waits for them."""


class AddressError(PullfocusError):
    """An address that no webhook may reach, or none for a name."""

    default_code = "refused_address"


def check_url(text: str) -> None:
    """Check that a URL may name a receiver.

    Args:
        text: the URL.

    Raises:
        InputError: it is none of http or https, has a user, a password or a fragment, or no host.
    """
    try:
        url = httpx.URL(text)
        reason = _reason_against(text, url)
    except (httpx.InvalidURL, ValueError):  # also of its properties, as of a name that is none of IDNA
        reason = "it cannot be read"
    if reason:
        raise InputError(f"{text[:200]!r} is no URL for a webhook: {reason}", code="bad_url", path="url")


def _reason_against(text: str, url: httpx.URL) -> str:
    if not text.isprintable() or " " in text:
        return "it has spaces or control characters"
    if url.scheme not in ("http", "https"):
        return "it begins with http:// or https://"
    if url.userinfo:
        return "it names a user"
    if "#" in text:
        return "it has a fragment"
    if not url.raw_host:
        return "it names no host"
    if url.port is not None and not 1 <= url.port <= 65_535:
        return "its port is none"
    return ""


async def look_up(host: str, port: int) -> list[str]:
    """Return the addresses of a host.

    Args:
        host: its name or address.
        port: that is to be reached.

    Raises:
        OSError: there are none.
    """
    kind = socket.SOCK_STREAM
    found = await asyncio.get_running_loop().run_in_executor(
        _THREADS, partial(socket.getaddrinfo, host, port, type=kind)
    )
    return [str(place[0]) for *_, place in found]


async def addresses_of(url: httpx.URL, look_up: LookUp, *, allows_private: bool) -> list[Address]:
    """Look up the addresses of a receiver that may be reached.

    Args:
        url: of the receiver.
        look_up: returns the addresses of a host and a port.
        allows_private: whether those of this machine and of private networks may be reached, too.

    Raises:
        AddressError: there is none that may be reached.
    """
    host = url.raw_host.decode("ascii")
    try:
        found = [ip_address(text) for text in await look_up(host, url.port or (443 if url.scheme == "https" else 80))]
    except (OSError, ValueError) as error:  # `UnicodeError` of a label that is too long is a `ValueError`
        raise AddressError(f"the host {host[:200]!r} is not found", code="unknown_host") from error
    refused = {address: refusal_of(address, allows_private=allows_private) for address in found}
    allowed = [address for address, reason in refused.items() if not reason]
    if not allowed:
        reasons = ", ".join(f"{address} is {reason}" for address, reason in refused.items())
        raise AddressError(f"no address of {host[:200]!r} may be reached: {reasons or 'it has none'}")
    return allowed[:MOST_ADDRESSES]


def refusal_of(address: Address, *, allows_private: bool) -> str:
    """Return why an address may not be reached; empty where it may.

    Args:
        address: of a receiver.
        allows_private: whether those of this machine and of private networks may be reached.
    """
    judged = _within(address)
    if judged in METADATA:
        return "the metadata of a cloud"
    if judged.is_loopback:
        return "" if allows_private else "this machine"
    if isinstance(judged, IPv4Address) and judged.packed[0] == 0:
        return "unspecified"
    for kind in ("unspecified", "link_local", "multicast", "reserved"):
        if getattr(judged, f"is_{kind}"):
            return kind.replace("_", "-")
    is_public = judged.is_global and not (isinstance(judged, IPv6Address) and judged.is_site_local)
    return "" if allows_private or is_public else "private"


def _within(address: Address) -> Address:
    """Return the IPv4 address that an IPv6 address leads to, or the address itself."""
    if isinstance(address, IPv4Address):
        return address
    if address in NAT64:
        return IPv4Address(address.packed[-4:])
    return address.ipv4_mapped or address.sixtofour or address
