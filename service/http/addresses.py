"""Addresses of clients: where a request comes from, and whom it counts for where there is no key."""

from __future__ import annotations

import ipaddress

from starlette.types import Scope

UNKNOWN = "unknown"
IPV6_PREFIX = 64
"""Bits of an IPv6 address that name a network (RFC 4291, section 2.5.4), whose hosts take any of its addresses. A subscriber may
have several (RFC 6177): with a /56, 256 shares. Counting by /56 would make one client of 256 customers of a host that gives
each a /64."""


def address_of(scope: Scope) -> str:
    """Return the address that a request or WebSocket comes from."""
    client = scope.get("client")
    return str(client[0]) if client else UNKNOWN


def counted_address(scope: Scope) -> str:
    """Return the address that a request counts for where it has no key; for IPv6, its /64 network.

    Whoever has an IPv6 network has 2^64 addresses, each of which would have a share and attempts of its own.
    """
    address = address_of(scope)
    try:
        parsed = ipaddress.ip_address(address)
    except ValueError:  # such as a name that a proxy sends
        return address
    if isinstance(parsed, ipaddress.IPv4Address):
        return address
    if parsed.ipv4_mapped is not None:
        return str(parsed.ipv4_mapped)
    return str(ipaddress.ip_network((int(parsed) >> (128 - IPV6_PREFIX) << (128 - IPV6_PREFIX), IPV6_PREFIX)))
