"""Tokens as the settings of a service accept them."""

from __future__ import annotations

from render.errors import SettingsError
from service.http.settings import Settings
from service.identity.grants import parse_grants
from service.identity.issuer import Issuer
from service.identity.tokens import Tokens


def tokens_of(settings: Settings) -> Tokens | None:
    """Return the judge of tokens; None where no issuer is named.

    Args:
        settings: of the service.

    Raises:
        SettingsError: the issuer's address or a role cannot be used, or no role is named.
    """
    if not settings.oidc_issuer:
        return None
    grants = parse_grants(settings.oidc_roles)
    if not grants:
        detail = (
            'an issuer of tokens is named, and nobody may do anything: say who, as in oidc_roles = ["artists = artist"]'
        )
        raise SettingsError(detail, code="no_roles", path="oidc_roles")
    return Tokens(Issuer(settings.oidc_issuer), settings.oidc_audience, settings.oidc_claim, grants)
