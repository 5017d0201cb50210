"""Errors of tokens. The service answers each in its own way."""

from __future__ import annotations


class TokenError(Exception):
    """A token is not valid."""


class NoRoleError(Exception):
    """A valid token whose holder may do nothing here."""


class IssuerError(Exception):
    """The issuer of the tokens cannot be reached.

    Args:
        detail: what is wrong.
        wait_s: time after which it is tried again, s.
    """

    def __init__(self, detail: str, wait_s: float) -> None:
        super().__init__(detail)
        self.wait_s = wait_s
