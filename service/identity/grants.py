"""Grants: what the holders of a token may do, by what its issuer says of them."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from render.errors import SettingsError
from service.identity.principal import ALL_PROJECTS, DEFAULT_PROJECT, PROJECT_PATTERN
from service.identity.roles import scopes_of

_GRANT = re.compile(r"(?P<value>\S.*?)\s*=\s*(?P<role>[a-z]+)(?:\s*@\s*(?P<project>\S+))?\s*")


@dataclass(frozen=True)
class Grant:
    """Rights that one value of a claim stands for.

    Attributes:
        value: of the claim.
        scopes: what its holder may do.
        project: whose shots they see.
    """

    value: str
    scopes: frozenset[str]
    project: str


def parse_grants(lines: Sequence[str]) -> tuple[Grant, ...]:
    """Parse grants such as ``night-tram-artists = artist @ night-tram``.

    Args:
        lines: each a value of the claim, a role or scope, and a project: ``default`` if left out, for administrators ``*``.

    Raises:
        SettingsError: a line is no grant.
    """
    return tuple(map(_parse, lines))


def _parse(line: str) -> Grant:
    match = _GRANT.fullmatch(line)
    if match is None:
        detail = f"a grant is written `VALUE = ROLE @ PROJECT`, got {line[:200]!r}"
        raise SettingsError(detail, code="bad_grant", path="oidc_roles")
    scopes = scopes_of([match["role"]])
    is_admin = "admin" in scopes
    project = match["project"] or (ALL_PROJECTS if is_admin else DEFAULT_PROJECT)
    if project != ALL_PROJECTS and (is_admin or not re.fullmatch(PROJECT_PATTERN, project)):
        detail = f"{line[:200]!r}: a project is a name of a-z, 0-9, _ and -, or * for all, as for whoever administers"
        raise SettingsError(detail, code="bad_grant", path="oidc_roles")
    return Grant(match["value"], scopes, project)


def granted(grants: Sequence[Grant], values: Collection[str]) -> tuple[frozenset[str], str] | None:
    """Return scopes and project of the holder of some values of a claim; None where no grant names any of them.

    The first grant that names one decides the project; the scopes of all grants of that project add up.

    Args:
        grants: in their order.
        values: of the claim.
    """
    held = [grant for grant in grants if grant.value in values]
    if not held:
        return None
    project = held[0].project
    return frozenset[str]().union(*(grant.scopes for grant in held if grant.project == project)), project


def values_at(claims: Mapping[str, object], path: str) -> frozenset[str]:
    """Return the texts of a claim, which may be one text or a list of them; none where it is not there.

    Args:
        claims: of a token.
        path: name of the claim, or names of claims within claims with dots between: ``realm_access.roles``. A claim whose name
            has dots itself is found by its whole name.
    """
    found: object = claims.get(path)
    if found is None:
        found = claims
        for name in path.split("."):
            found = found.get(name) if isinstance(found, Mapping) else None
    if isinstance(found, str):
        return frozenset({found})
    return frozenset(value for value in found if isinstance(value, str)) if isinstance(found, list) else frozenset()
