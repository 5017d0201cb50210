"""Roles: names for usual sets of scopes."""

from __future__ import annotations

from render.errors import SettingsError
from service.identity.principal import SCOPES

ROLES: dict[str, frozenset[str]] = {
    "reader": frozenset({"read"}),
    "viewer": frozenset({"read", "render"}),
    "artist": frozenset({"read", "edit", "render"}),
    "admin": SCOPES,
}


def scopes_of(words: list[str]) -> frozenset[str]:
    """Return the scopes that roles and scopes stand for together.

    Args:
        words: names of roles and of scopes.

    Raises:
        SettingsError: a word is neither.
    """
    unknown = sorted(set(words) - ROLES.keys() - SCOPES)
    if unknown or not words:
        known = ", ".join((*ROLES, *sorted(SCOPES - ROLES.keys())))
        got = ", ".join(map(repr, unknown)) or "none"
        raise SettingsError(f"a key has roles or scopes of {known}; got {got}", code="bad_scope", path="scopes")
    return frozenset[str]().union(*(ROLES.get(word, frozenset({word})) for word in words))
