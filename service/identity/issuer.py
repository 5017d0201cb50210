"""Issuer of tokens (OpenID Connect Discovery 1.0): its public keys, which are fetched over HTTP and kept for a while."""

from __future__ import annotations

import json
import logging
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable, Mapping
from typing import Any

from joserfc.errors import JoseError
from joserfc.jwk import Key, import_key

from render.errors import SettingsError
from service.identity.errors import IssuerError

log = logging.getLogger("pullfocus.service")

DISCOVERY = "/.well-known/openid-configuration"
FETCH_S = 5.0
"""Time that one answer of the issuer may take."""
MAX_BYTES = 1 << 20
FRESH_S = 3600.0
"""Time after which keys are fetched again."""
KEPT_S = 86400.0
"""Time for which keys hold while the issuer cannot be reached: after that, one that it has withdrawn could still be used."""
PAUSE_S = 30.0
"""Least time between two fetches, however many tokens name keys that are not known."""
LOOPBACK = ("127.0.0.1", "localhost", "::1")
MIN_RSA_BITS, BITS_PER_DIGIT = 2048, 6


class Issuer:
    """Public keys of one issuer. Any thread may use it.

    Args:
        address: of the issuer, as its tokens name it: https, or http on this machine.
        clock: seconds that never go back.

    Raises:
        SettingsError: the address is none.
    """

    def __init__(self, address: str, clock: Callable[[], float] = time.monotonic) -> None:
        if not _is_safe(address):
            detail = (
                f"the address of an issuer begins with https:// (or http:// on this machine), got {address[:200]!r}"
            )
            raise SettingsError(detail, code="bad_issuer", path="oidc_issuer")
        self.address = address
        self._clock = clock
        self._keys: dict[str | None, Key] = {}
        self._fetched_s: float | None = None
        self._tried_s: float | None = None
        self._lock = threading.Lock()

    def key(self, key_id: str | None) -> Key | None:
        """Return a public key; None where the issuer has none of that name.

        Args:
            key_id: its name; None where the token names none, which is enough where the issuer has one key.

        Raises:
            IssuerError: the issuer cannot be reached, and no keys of it are kept.
        """
        with self._lock:
            now_s = self._clock()
            is_fresh = self._fetched_s is not None and now_s - self._fetched_s < FRESH_S
            may_try = self._tried_s is None or now_s - self._tried_s >= PAUSE_S
            if may_try and not (is_fresh and self._find(key_id)):
                self._tried_s = now_s
                self._fetch(now_s)
            if self._fetched_s is None or now_s - self._fetched_s >= KEPT_S:
                raise IssuerError("The issuer of the tokens cannot be reached.", PAUSE_S)
            return self._find(key_id)

    def fetch_keys(self) -> dict[str | None, Key]:
        """Fetch the issuer's public keys, by their names.

        Raises:
            OSError: the issuer cannot be reached.
            ValueError: its answer is not what OpenID Connect Discovery asks for.
        """
        found = _get_json(self.address.rstrip("/") + DISCOVERY)
        if found.get("issuer") != self.address:
            raise ValueError(f"it names itself {str(found.get('issuer'))[:200]!r}")
        place = found.get("jwks_uri")
        if not isinstance(place, str) or not _is_safe(place):
            raise ValueError("its keys are at no https address (`jwks_uri`)")
        listed = _get_json(place).get("keys")
        keys = [_public_key(each) for each in listed] if isinstance(listed, list) else []
        return {key.kid: key for key in keys if key is not None}

    def _find(self, key_id: str | None) -> Key | None:
        if key_id is None:
            return next(iter(self._keys.values())) if len(self._keys) == 1 else None
        return self._keys.get(key_id)

    def _fetch(self, now_s: float) -> None:
        try:
            keys = self.fetch_keys()
        except (OSError, ValueError) as error:
            log.warning("the keys of the issuer %s cannot be fetched: %s", self.address, error)
            return
        self._keys, self._fetched_s = keys, now_s


def _public_key(fields: object) -> Key | None:
    """Import a key that signs; None for others, and for those that cannot be used: an issuer may have keys of any kind."""
    if (
        not isinstance(fields, dict)
        or fields.get("use", "sig") != "sig"
        or fields.get("kty") not in ("RSA", "EC", "OKP")
    ):
        return None
    if fields["kty"] == "RSA" and len(str(fields.get("n"))) * BITS_PER_DIGIT < MIN_RSA_BITS:
        return None
    try:
        return import_key(fields)
    except (JoseError, ValueError, TypeError, KeyError):
        return None


def _is_safe(address: str) -> bool:
    """Whether an address is one of https, or of http on this machine, where nobody can change what is sent."""
    try:
        parts = urllib.parse.urlsplit(address)
        is_plain = not (parts.query or parts.fragment or parts.username)
        return (
            is_plain
            and bool(parts.hostname)
            and (parts.scheme == "https" or (parts.scheme == "http" and parts.hostname in LOOPBACK))
        )
    except ValueError:
        return False


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    def redirect_request(self, *_: Any) -> None:
        """Follow no redirect: it could lead anywhere."""


def _get_json(address: str) -> Mapping[str, Any]:
    request = urllib.request.Request(address, headers={"Accept": "application/json"})
    with urllib.request.build_opener(_NoRedirects).open(request, timeout=FETCH_S) as answer:
        content = answer.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise ValueError(f"{address} has more than {MAX_BYTES:,} bytes")
    try:
        found = json.loads(content)
    except RecursionError as error:
        raise ValueError(f"{address} is nested too deeply") from error
    if not isinstance(found, dict):
        raise ValueError(f"{address} is no JSON object")
    return found
