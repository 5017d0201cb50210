"""Who may reach a service: the names that it answers to, and whether it needs keys."""

from __future__ import annotations

import logging
import re
import socket
from dataclasses import replace

from render.errors import SettingsError
from service.http.settings import Settings
from service.http.token_settings import tokens_of
from service.identity.keys import Keys

log = logging.getLogger("pullfocus.service")

LOOPBACK_NAMES = ("127.0.0.1", "localhost", "::1")
HOST_NAME = re.compile(r"[a-z0-9]([a-z0-9.-]{0,251}[a-z0-9])?|\[[0-9a-f:.]+\]")


def with_exposure(settings: Settings) -> Settings:
    """Return settings with the names that the service answers to, and who may use it.

    A service that only this machine can reach is open, unless an issuer of tokens is named. One that listens beyond it, that
    answers to a name which is not this machine's own, or that believes a proxy, needs keys or an issuer.

    Args:
        settings: of the service, as they were given.

    Raises:
        SettingsError: keys are needed and there are none, a name is none, or the issuer or its roles are not usable.
    """
    hosts = tuple(name.lower() for name in settings.allowed_hosts)
    for name in hosts:
        if not HOST_NAME.fullmatch(name):
            raise SettingsError(f"an allowed host is a name without a port, got {name!r}", code="bad_host")
    is_local = settings.host in LOOPBACK_NAMES
    beyond = (
        () if is_local else (_in_header(settings.host.lower()), socket.gethostname().lower(), socket.getfqdn().lower())
    )
    settings = replace(settings, allowed_hosts=tuple(dict.fromkeys((*hosts, *beyond))))
    if settings.access == "insecure":
        log.warning("INSECURE: everybody who reaches this service may read, edit and delete every shot, without a key")
        return settings
    is_behind_proxy = bool(settings.trusted_proxies) or not set(hosts) <= {*LOOPBACK_NAMES, "[::1]"}
    if settings.oidc_issuer:
        tokens_of(settings)  # an error in them stops the service here
        return replace(settings, access="keys")
    if settings.access == "open" and is_local and not is_behind_proxy:
        return settings
    if not Keys(settings.data).list():
        is_asked_for = settings.access == "keys"
        reason = "this service needs keys" if is_asked_for else "this service could be reached by others, needs keys"
        ways = "or name an issuer of tokens (oidc_issuer)"
        if not is_asked_for:
            ways = "name an issuer of tokens (oidc_issuer), or let everybody in with --insecure"
        create = f"`pullfocus keys create NAME --role admin --data {settings.data}`"
        raise SettingsError(f"{reason} and has none: create one with {create}, {ways}", code="no_keys")
    return replace(settings, access="keys")


def _in_header(host: str) -> str:
    """Return an address as it stands in a ``Host`` header."""
    return f"[{host}]" if ":" in host else host
