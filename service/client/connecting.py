"""The parts that both clients share: the address of the service, the key, and the headers of each request."""

from __future__ import annotations

import re
from typing import TypedDict

import httpx

from .errors import SettingError

DEFAULT_URL = "http://127.0.0.1:8000"
VERSION = "0.1.0"
_KEY = re.compile(r"[\x21-\x7e]{1,16384}")


class HttpArguments(TypedDict):
    """Arguments of `httpx.Client` and `httpx.AsyncClient`."""

    base_url: httpx.URL
    headers: dict[str, str]
    follow_redirects: bool
    limits: httpx.Limits


def http_arguments(url: str, key: str | None) -> HttpArguments:
    """Return the arguments of an HTTP client. Redirects are not followed, so that the key goes to no other host.

    Args:
        url: address of the service; it may have a path, as behind a proxy.
        key: of the service, or a token; None for a service that needs none.

    Raises:
        SettingError: the address or the key cannot be used.
    """
    headers = {
        "Accept": "*/*",
        "Accept-Encoding": "identity",  # lengths are checked as they come, and a compressed answer has no bound
        "User-Agent": f"pullfocus-client/{VERSION} python-httpx/{httpx.__version__}",
    }
    if key is not None:
        if not _KEY.fullmatch(key):
            raise SettingError("the key is empty, or has spaces, line breaks or other signs that no key has")
        headers["Authorization"] = f"Bearer {key}"
    return {
        "base_url": _address(url),
        "headers": headers,
        "follow_redirects": False,
        "limits": httpx.Limits(max_connections=32),
    }


def _address(url: str) -> httpx.URL:
    try:
        address = httpx.URL(url)
        is_named = address.scheme in ("http", "https") and bool(address.host)
    except (httpx.InvalidURL, TypeError, ValueError) as error:
        shown = f"{url!r} is no" if "@" not in str(url) else "that is no"  # it may hold a password
        raise SettingError(f"{shown} address of a service; expected one such as {DEFAULT_URL}") from error
    if address.userinfo:
        raise SettingError("the address of a service has no name and no password; the key is given by itself")
    if not is_named:
        raise SettingError(f"{url!r} is no address of a service; expected one such as {DEFAULT_URL}")
    if address.query or address.fragment:
        raise SettingError(f"{url!r} is no address of a service: it ends with its path")
    return address
