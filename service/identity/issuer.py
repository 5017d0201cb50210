"""Issuer of tokens (OpenID Connect Discovery 1.0): its public keys, which are fetched over HTTP and kept for a while."""

from __future__ import annotations

import logging
import threading
import time
import urllib.parse
from collections.abc import Callable, Mapping
from typing import Any

from joserfc.errors import JoseError
from joserfc.jwk import Key, import_key

from render.errors import SettingsError
from service.identity.errors import IssuerError
from service.identity.fetching import fetch
from service.json_text import parse_json

log = logging.getLogger("pullfocus.service")

DISCOVERY = "/.well-known/openid-configuration"
FETCH_S = 5.0
"""Time that one answer of the issuer may take, however slowly it comes, s."""
MAX_BYTES = 1 << 20
FRESH_S = 3600.0
"""Time after which keys are fetched again."""
KEPT_S = 86400.0
"""Time for which keys hold while the issuer cannot be reached: after that, one that it has withdrawn could still be used."""
PAUSE_S = 30.0
"""Least time between two fetches, however many tokens name keys that are not known."""
WAIT_S = 1.0
"""Time that a token waits while the keys are fetched for another one, where its own key is not kept."""
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
            IssuerError: the issuer cannot be reached and no keys of it are kept, or it is slow and this key is not kept.
        """
        now_s = self._clock()
        if not (self._is_fetched_within(FRESH_S, now_s) and self._find(key_id)):
            has_key = self._is_fetched_within(KEPT_S, now_s) and self._find(key_id) is not None
            if self._lock.acquire(timeout=0 if has_key else WAIT_S):
                try:
                    self._fetch_if_due(key_id, now_s)
                finally:
                    self._lock.release()
            elif not has_key:
                raise IssuerError("The issuer of the tokens is slow to answer.", WAIT_S)
        if not self._is_fetched_within(KEPT_S, now_s):
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
        keys = self._keys  # another thread may replace them
        if key_id is None:
            return next(iter(keys.values())) if len(keys) == 1 else None
        return keys.get(key_id)

    def _is_fetched_within(self, age_s: float, now_s: float) -> bool:
        return self._fetched_s is not None and now_s - self._fetched_s < age_s

    def _fetch_if_due(self, key_id: str | None, now_s: float) -> None:
        """Fetch the keys, unless they were asked for lately, or another thread has fetched this one meanwhile."""
        is_there = self._is_fetched_within(FRESH_S, now_s) and self._find(key_id)
        if is_there or (self._tried_s is not None and now_s - self._tried_s < PAUSE_S):
            return
        self._tried_s = now_s
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


def _get_json(address: str) -> Mapping[str, Any]:
    content = fetch(address, MAX_BYTES, FETCH_S)
    found = parse_json(content)
    if not isinstance(found, dict):
        raise ValueError(f"{address} is no JSON object")
    return found
