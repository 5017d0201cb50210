"""Tokens of an issuer: JSON Web Tokens (RFC 7519) that say who sends a request, as OpenID Connect issues them."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

from joserfc import jws, jwt
from joserfc.errors import JoseError

from service.identity.errors import NoRoleError, TokenError
from service.identity.grants import Grant, granted, values_at
from service.identity.issuer import Issuer
from service.identity.keys import MAX_LABEL
from service.identity.principal import Principal

ALGORITHMS = ("RS256", "RS384", "RS512", "PS256", "PS384", "PS512", "ES256", "ES384", "ES512", "EdDSA", "Ed25519")
"""Signatures that only the issuer can make: none with a secret that this service would have to know, and not ``none``."""
MAX_TOKEN = 16_384
"""Characters of a token."""
LEEWAY_S = 60
"""Difference between the clocks of issuer and service, s."""
NAMES = ("preferred_username", "email", "name", "sub")
_TOKEN = re.compile(r"[\w-]+\.[\w-]+\.[\w-]*", re.ASCII)
_SUBJECT = re.compile(r"[\x21-\x7e]{1,255}")


def looks_like_token(sent: str) -> bool:
    """Whether a text has the form of a JSON Web Token."""
    return _TOKEN.fullmatch(sent) is not None


class Tokens:
    """Judge of tokens. Any thread may use it.

    Args:
        issuer: has the keys that they are signed with.
        audience: that they are for.
        claim: where they say what their holder may do, as for `values_at`.
        grants: what that stands for.
        now: the time.
    """

    def __init__(
        self,
        issuer: Issuer,
        audience: str,
        claim: str,
        grants: Sequence[Grant],
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        self._issuer = issuer
        self._audience = audience
        self._claim = claim
        self._grants = grants
        self._now = now

    def principal(self, token: str) -> Principal:
        """Return the sender that a token stands for. It may ask the issuer for its keys, which takes time.

        Args:
            token: as it was sent.

        Raises:
            TokenError: the token is not valid.
            NoRoleError: its holder may do nothing here.
            IssuerError: the issuer cannot be reached.
        """
        if len(token) > MAX_TOKEN:
            raise TokenError(f"the token has more than {MAX_TOKEN:,} characters")
        claims = self._checked_claims(token)
        label = _label(claims)
        held = granted(self._grants, values_at(claims, self._claim))
        if held is None:
            raise NoRoleError(
                f"{label} has no role here: the claim {self._claim!r} of the token names none that is known."
            )
        subject = claims["sub"]
        ends_at = datetime.fromtimestamp(claims["exp"] + LEEWAY_S, UTC)
        return Principal(f"oidc:{subject}", label, *held, ends_at)

    def _checked_claims(self, token: str) -> Mapping[str, Any]:
        """Return the claims of a token whose signature, issuer, audience and times are right."""
        try:
            header = jws.extract_compact(token.encode()).headers()
            key_id = header.get("kid")
            if header.get("alg") not in ALGORITHMS or "crit" in header or not isinstance(key_id, str | None):
                raise TokenError("the token is signed in a way that is not accepted")
            key = self._issuer.key(key_id)
            if key is None:
                raise TokenError("the token is signed with a key that its issuer does not have")
            claims = jwt.decode(token, key, algorithms=list(ALGORITHMS)).claims
            jwt.JWTClaimsRegistry(
                now=int(self._now().timestamp()),
                leeway=LEEWAY_S,
                iss={"essential": True, "value": self._issuer.address},
                aud={"essential": True, "value": self._audience},
                exp={"essential": True},
                sub={"essential": True},
            ).validate(claims)
        except JoseError as error:
            raise TokenError(f"the token is not valid: {error.description or error.error}") from error
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
            raise TokenError("the token cannot be read") from error
        if not isinstance(claims["sub"], str) or not _SUBJECT.fullmatch(claims["sub"]):
            raise TokenError("the token names nobody (`sub`)")
        if not isinstance(claims["exp"], int | float) or not 0 <= claims["exp"] < 1e11:
            raise TokenError("the token has no end (`exp`)")
        return claims


def _label(claims: Mapping[str, Any]) -> str:
    """Return the name of a token's holder for people, in one line."""
    for name in NAMES:
        value = claims.get(name)
        if isinstance(value, str) and value.strip() and value.isprintable():
            return value.strip()[:MAX_LABEL]
    return "somebody"
