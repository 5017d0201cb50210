"""Tokens of an issuer that runs: which are accepted, and for whom."""

from __future__ import annotations

import base64
import hmac
import json
import logging
import socket
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from datetime import UTC, datetime, timedelta

import pytest
from joserfc.jwk import OctKey

from render.errors import SettingsError
from service.identity.errors import IssuerError, NoRoleError, TokenError
from service.identity.fetching import fetch
from service.identity.grants import granted, parse_grants, values_at
from service.identity.issuer import FRESH_S, KEPT_S, PAUSE_S
from service.identity.issuer import Issuer as Trusted
from service.identity.roles import ROLES
from service.identity.tokens import LEEWAY_S, MAX_TOKEN, Tokens, looks_like_token
from tests.service.kits.issuer import AUDIENCE, KEYS, Issuer, new_curve_key, new_key, running_issuer

GRANTS = parse_grants(["focus pullers = artist @ night-tram", "td = admin", "guests = reader @ night-tram"])
PULLER = {"roles": ["staff", "focus pullers"]}


class Clock:
    """A clock that tests turn."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def issuer() -> Iterator[Issuer]:
    with running_issuer() as issuer:
        yield issuer


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def tokens(issuer: Issuer, clock: Clock) -> Tokens:
    return Tokens(Trusted(issuer.address, clock), AUDIENCE, "roles", GRANTS)


def test_a_token_says_who_sends_a_request(issuer: Issuer, tokens: Tokens) -> None:
    principal = tokens.principal(issuer.token(**PULLER, preferred_username="Mara"))
    assert (principal.id, principal.label, principal.project) == ("oidc:mara", "Mara", "night-tram")
    assert principal.scopes == ROLES["artist"]
    assert principal.ends_at is not None
    assert timedelta(0) < principal.ends_at - datetime.now(UTC) <= timedelta(seconds=300 + LEEWAY_S)


def test_names_that_could_break_a_log_are_not_shown(issuer: Issuer, tokens: Tokens) -> None:
    assert tokens.principal(issuer.token(**PULLER, name="Mara\nroot", email="m@x")).label == "m@x"


@pytest.mark.parametrize(
    "claims",
    [
        {"iss": "https://elsewhere.example"},
        {"iss": None},
        {"aud": "another"},
        {"aud": ["another"]},
        {"aud": None},
        {"exp": 1_000_000},
        {"exp": None},
        {"exp": "tomorrow"},
        {"exp": 1e300},
        {"nbf": 99_999_999_999},
        {"iat": 99_999_999_999},
        {"sub": None},
        {"sub": 7},
        {"sub": "a\nb"},
        {"sub": ""},
    ],
    ids=str,
)
def test_tokens_with_wrong_claims_are_refused(issuer: Issuer, tokens: Tokens, claims: dict[str, object]) -> None:
    with pytest.raises(TokenError):
        tokens.principal(issuer.token(**PULLER | claims))


def test_clocks_may_differ_a_little(issuer: Issuer, tokens: Tokens) -> None:
    now = int(datetime.now(UTC).timestamp())
    assert tokens.principal(issuer.token(**PULLER, nbf=now + 30, iat=now + 30))
    with pytest.raises(TokenError):
        tokens.principal(issuer.token(**PULLER, nbf=now + 300))


def unsigned(issuer: Issuer) -> str:
    return f"{encoded({'alg': 'none', 'kid': 'first'})}.{body_of(issuer)}."


def signed_with_the_public_key(issuer: Issuer) -> str:
    signed = f"{encoded({'alg': 'HS256', 'kid': 'first'})}.{body_of(issuer)}"
    digest = hmac.digest(issuer.keys[0].as_pem(private=False), signed.encode(), "sha256")
    return f"{signed}.{base64.urlsafe_b64encode(digest).rstrip(b'=').decode()}"


def body_of(issuer: Issuer) -> str:
    return issuer.token(**PULLER).split(".")[1]


def encoded(fields: dict[str, object]) -> str:
    return base64.urlsafe_b64encode(json.dumps(fields).encode()).rstrip(b"=").decode()


def bringing_its_own_key(issuer: Issuer) -> str:
    stranger = new_key("first")
    return issuer.token(stranger, {"jwk": stranger.as_dict(private=False)}, **PULLER)


@pytest.mark.parametrize("forge", [unsigned, signed_with_the_public_key, bringing_its_own_key])
def test_forged_tokens_are_refused(issuer: Issuer, tokens: Tokens, forge) -> None:
    with pytest.raises(TokenError):
        tokens.principal(forge(issuer))


@pytest.mark.parametrize(
    "sent", ["", "a.b.c", "..", "é.é.é", "e30.e30.e30", "x" * (MAX_TOKEN + 1), encoded({"alg": 5}) + ".e30.e30"]
)
def test_what_is_no_token_is_refused(tokens: Tokens, sent: str) -> None:
    with pytest.raises(TokenError):
        tokens.principal(sent)


def test_a_token_with_critical_headers_is_refused(issuer: Issuer, tokens: Tokens) -> None:
    signature = issuer.token(**PULLER).split(".")[2]
    head = encoded({"alg": "RS256", "kid": "first", "crit": ["b64"], "b64": False})
    with pytest.raises(TokenError, match="not accepted"):
        tokens.principal(f"{head}.{body_of(issuer)}.{signature}")


def test_keys_of_other_kinds_and_weak_ones_are_passed_over(issuer: Issuer, tokens: Tokens) -> None:
    issuer.keys = [OctKey.generate_key(256, {"kid": "shared"}), new_key("weak", 1024), new_curve_key("curve")]
    assert tokens.principal(issuer.token(**PULLER))
    for key in issuer.keys[:2]:
        with pytest.raises(TokenError, match="does not have"):
            tokens.principal(issuer.token(new_key("x"), {"kid": key.kid}, **PULLER))


def test_new_keys_are_fetched_but_not_for_each_unknown_one(issuer: Issuer, tokens: Tokens, clock: Clock) -> None:
    assert tokens.principal(issuer.token(**PULLER))
    for n in range(20):
        with pytest.raises(TokenError):
            tokens.principal(issuer.token(new_key("first"), {"kid": f"unknown {n}"}, **PULLER))
    assert issuer.asked.count(KEYS) == 1
    issuer.keys.append(new_key("second"))
    clock.now_s += PAUSE_S
    assert tokens.principal(issuer.token(**PULLER))
    assert issuer.asked.count(KEYS) == 2


def test_a_withdrawn_key_is_forgotten(issuer: Issuer, tokens: Tokens, clock: Clock) -> None:
    old = issuer.token(**PULLER)
    assert tokens.principal(old)
    issuer.keys = [new_key("second")]
    clock.now_s += PAUSE_S
    assert tokens.principal(issuer.token(**PULLER))
    with pytest.raises(TokenError):
        tokens.principal(old)


def test_a_token_without_a_key_id_needs_an_issuer_with_one_key(issuer: Issuer, tokens: Tokens) -> None:
    assert tokens.principal(issuer.token(None, {"kid": None}, **PULLER))


def test_tokens_hold_while_the_issuer_is_down_for_a_day(issuer: Issuer, tokens: Tokens, clock: Clock, caplog) -> None:
    token = issuer.token(**PULLER)
    assert tokens.principal(token)
    issuer.close()
    clock.now_s += KEPT_S - 1
    with caplog.at_level(logging.WARNING):
        assert tokens.principal(token)
    assert "cannot be fetched" in caplog.text
    clock.now_s += PAUSE_S
    with pytest.raises(IssuerError):
        tokens.principal(token)


def test_nobody_waits_for_an_issuer_that_is_slow(issuer: Issuer, tokens: Tokens, clock: Clock) -> None:
    token = issuer.token(**PULLER)
    assert tokens.principal(token)
    clock.now_s += FRESH_S
    issuer.may_answer.clear()
    issuer.was_asked.clear()
    with ThreadPoolExecutor(1) as threads:
        first = threads.submit(tokens.principal, token)
        assert issuer.was_asked.wait(10)
        assert tokens.principal(token)
        with pytest.raises(IssuerError, match="slow"):
            tokens.principal(issuer.token(new_key("unknown"), **PULLER))
        assert not first.done()
        issuer.may_answer.set()
    assert first.result() == tokens.principal(token)


def test_an_issuer_that_drips_its_answer_is_given_up(issuer: Issuer, tokens: Tokens, monkeypatch) -> None:
    monkeypatch.setattr("service.identity.issuer.FETCH_S", 0.5)
    issuer.drip_s = 0.1  # each byte comes in time
    began_s = time.monotonic()
    with pytest.raises(IssuerError):
        tokens.principal(issuer.token(**PULLER))
    assert time.monotonic() - began_s < 3


@pytest.mark.parametrize(
    "drip", [b"HTTP/1.0 200 OK\r\nX: ", b"HTTP/1.0 200 OK\r\n\r\n", b"HTTP/1.1 100 Continue\r\n\r\n"]
)
def test_a_slow_answer_is_not_taken_for_a_whole_one(drip: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener, ThreadPoolExecutor(1) as threads:
        ended = threading.Event()

        def answer() -> None:
            with listener.accept()[0] as connection, suppress(OSError):
                connection.sendall(drip)
                while not ended.wait(0.1):
                    connection.sendall(b" ")

        answering = threads.submit(answer)
        try:
            with pytest.raises(TimeoutError, match=r"within 0\.5 s"):
                fetch(f"http://127.0.0.1:{listener.getsockname()[1]}/", 1000, 0.5)
        finally:
            ended.set()
        answering.result()


@pytest.mark.parametrize(
    "discovery",
    [
        {"issuer": "https://elsewhere.example"},
        {"jwks_uri": "http://elsewhere.example/keys"},
        {"jwks_uri": 5},
        {"jwks_uri": "file:///etc/passwd"},
    ],
)
def test_an_issuer_that_is_another_is_not_believed(issuer: Issuer, tokens: Tokens, discovery) -> None:
    issuer.discovery = discovery
    with pytest.raises(IssuerError):
        tokens.principal(issuer.token(**PULLER))
    assert KEYS not in issuer.asked


@pytest.mark.parametrize("nonsense", ["is_broken", "is_no_http"])
def test_an_issuer_that_talks_nonsense_is_as_one_that_is_down(
    issuer: Issuer, tokens: Tokens, clock: Clock, nonsense: str
) -> None:
    token = issuer.token(**PULLER)
    setattr(issuer, nonsense, True)
    with pytest.raises(IssuerError):
        tokens.principal(token)
    setattr(issuer, nonsense, False)
    with pytest.raises(IssuerError):
        tokens.principal(token)
    clock.now_s += PAUSE_S
    assert tokens.principal(token)


@pytest.mark.parametrize(
    "address", ["", "http://login.example", "ftp://x", "https://", "https://u@x", "https://x?y", "http://[x"]
)
def test_an_issuer_is_at_a_safe_address(address: str) -> None:
    with pytest.raises(SettingsError, match="issuer"):
        Trusted(address)


def test_a_holder_without_a_role_may_do_nothing(issuer: Issuer, tokens: Tokens) -> None:
    for claims in ({}, {"roles": []}, {"roles": "staff"}, {"roles": {"focus pullers": 1}}, {"roles": [1, None]}):
        with pytest.raises(NoRoleError, match="'roles'"):
            tokens.principal(issuer.token(**claims))


def test_the_first_grant_decides_the_project() -> None:
    assert granted(GRANTS, {"guests", "focus pullers"}) == (ROLES["artist"], "night-tram")
    assert granted(GRANTS, {"guests", "td"}) == (ROLES["admin"], "*")
    assert granted(GRANTS, {"guests"}) == (ROLES["reader"], "night-tram")
    assert granted(GRANTS, set()) is None


def test_claims_within_claims_are_found() -> None:
    claims = {"realm_access": {"roles": ["a", 5, "b"]}, "https://x.example/roles": "c"}
    assert values_at(claims, "realm_access.roles") == {"a", "b"}
    assert values_at(claims, "https://x.example/roles") == {"c"}
    assert values_at(claims, "realm_access.none.roles") == frozenset()


@pytest.mark.parametrize(
    "line", ["artist", "= artist", "a = ", "a = painter", "a = artist @ Night Tram", "a = admin @ tram"]
)
def test_what_is_no_grant_is_refused(line: str) -> None:
    with pytest.raises(SettingsError):
        parse_grants([line])


def test_keys_do_not_look_like_tokens() -> None:
    assert not looks_like_token("pf_0123456789ab_" + "x" * 43)
    assert looks_like_token("eyJ.eyJ.abc-_")
