"""Addresses of clients, and whom they count for."""

from __future__ import annotations

import pytest

from service.http.addresses import address_of, counted_address


@pytest.mark.parametrize(
    ("client", "counts_for"),
    [
        (("192.0.2.7", 5000), "192.0.2.7"),
        (("2001:db8:1:2:3:4:5:6", 5000), "2001:db8:1:2::/64"),
        (("::ffff:192.0.2.7", 5000), "192.0.2.7"),
        (("::1", 5000), "::/64"),
        (("a-name", 0), "a-name"),
        (None, "unknown"),
    ],
)
def test_ipv6_clients_count_by_their_network(client, counts_for):
    assert counted_address({"client": client}) == counts_for
    assert address_of({"client": client}) == (client[0] if client else "unknown")
