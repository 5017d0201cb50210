"""An issuer of tokens over real HTTP: discovery, public keys, and tokens for clients (OAuth 2.0, section 4.4)."""

from __future__ import annotations

import json
import threading
import time
import urllib.parse
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from joserfc import jwt
from joserfc.jwk import ECKey, Key, RSAKey

AUDIENCE = "pullfocus"
DISCOVERY, KEYS, TOKENS = "/.well-known/openid-configuration", "/keys", "/token"


class Issuer:
    """An issuer, its keys and its clients.

    Attributes:
        address: as its tokens name it.
        keys: that it publishes; the last one signs.
        asked: paths that it was asked for.
        claims: of each client, by its id.
        is_broken: whether it answers something that is no JSON.
        is_no_http: whether it answers something that is no HTTP.
        may_answer: set unless it keeps those who ask waiting.
        drip_s: time between two bytes of its answers, s.
        was_asked: set with each question.
    """

    def __init__(self) -> None:
        self.keys: list[Key] = [new_key("first")]
        self.asked: list[str] = []
        self.claims: dict[str, dict[str, Any]] = {}
        self.discovery: dict[str, Any] = {}
        self.is_broken = self.is_no_http = False
        self.drip_s = 0.0
        self.may_answer, self.was_asked = threading.Event(), threading.Event()
        self.may_answer.set()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self.address = f"http://127.0.0.1:{self._server.server_address[1]}"
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Stop, as an issuer that is down."""
        self._server.shutdown()
        self._server.server_close()

    def token(self, key: Key | None = None, header: dict[str, Any] | None = None, **claims: Any) -> str:
        """Sign a token; claims that are None are left out."""
        signing = key or self.keys[-1]
        now = int(time.time())
        given = {"iss": self.address, "aud": AUDIENCE, "sub": "mara", "iat": now, "exp": now + 300} | claims
        fields = {name: value for name, value in given.items() if value is not None}
        algorithm = "ES256" if isinstance(signing, ECKey) else "RS256"
        head = {"alg": algorithm, "kid": signing.kid} | (header or {})
        return jwt.encode({name: value for name, value in head.items() if value is not None}, fields, signing)

    def _answer(self, path: str, form: dict[str, list[str]]) -> dict[str, Any]:
        if path == DISCOVERY:
            endpoints = {"jwks_uri": self.address + KEYS, "token_endpoint": self.address + TOKENS}
            return {"issuer": self.address, **endpoints} | self.discovery
        if path == KEYS:
            return {"keys": [key.as_dict(private=False) for key in self.keys]}
        return {"access_token": self.token(**self.claims[form["client_id"][0]]), "token_type": "Bearer"}

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        issuer = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                self._reply({})

            def do_POST(self) -> None:
                sent = self.rfile.read(int(self.headers["Content-Length"])).decode()
                self._reply(urllib.parse.parse_qs(sent))

            def _reply(self, form: dict[str, list[str]]) -> None:
                issuer.asked.append(self.path)
                issuer.was_asked.set()
                issuer.may_answer.wait()
                if issuer.is_no_http:
                    self.wfile.write(b"no HTTP\r\n\r\n")
                    return
                content = b"<html>" if issuer.is_broken else json.dumps(issuer._answer(self.path, form)).encode()
                self.send_response(200)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(content)))
                self.end_headers()
                with suppress(OSError):  # whoever asked has gone
                    for at in range(len(content)) if issuer.drip_s else ():
                        self.wfile.write(content[at : at + 1])
                        time.sleep(issuer.drip_s)
                    if not issuer.drip_s:
                        self.wfile.write(content)

            def log_message(self, *_: object) -> None:
                """Say nothing."""

        return Handler


def new_key(name: str, bits: int = 2048) -> RSAKey:
    """Make a key that signs."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of few bits
        return RSAKey.generate_key(bits, {"kid": name, "use": "sig"})


def new_curve_key(name: str) -> ECKey:
    """Make a key on an elliptic curve."""
    return ECKey.generate_key("P-256", {"kid": name, "use": "sig"})


@contextmanager
def running_issuer() -> Iterator[Issuer]:
    """Run an issuer until the end of the context."""
    issuer = Issuer()
    try:
        yield issuer
    finally:
        issuer.close()
