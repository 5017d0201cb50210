"""`pullfocus serve`: the service and its page on one address."""

from __future__ import annotations

import argparse
import errno
import logging
import socket
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import get_args

from render.errors import OutputError, SettingsError
from service.http.app import create_app
from service.http.configuration import read_configuration
from service.http.connections import server_config
from service.http.exposure import with_exposure
from service.http.logs import LogFormat, set_up_logs
from service.http.settings import Settings, default_data_folder
from service.http.stopping import GracefulServer
from service.storage.database.connection import open_database
from service.storage.store import ShotStore


def serve(arguments: Sequence[str]) -> int:
    """Run the service until it is stopped.

    Args:
        arguments: as typed after ``pullfocus serve``.

    Returns:
        The exit status.

    Raises:
        SettingsError: the host is no address of this machine, the port is out of range, keys are needed and there are none, or
            the database is none that can be used.
        OutputError: the port or the data folder is in use, or they or the database cannot be opened.
    """
    settings = _settings(_parser().parse_args(arguments))
    listener = _listen(settings.host, settings.port)
    set_up_logs(settings.log_format)
    settings = with_exposure(settings)
    _try_data(settings)
    host, port = listener.getsockname()[:2]
    shown = f"[{host}]" if ":" in host else host
    logging.getLogger("pullfocus.service").info("http://%s:%d/ serves the shots of %s", shown, port, settings.data)
    app = create_app(settings)
    server = GracefulServer(app, server_config(app, settings), settings.stop_grace_s)
    server.run(sockets=[listener])
    return 0 if server.started else 1


def _try_data(settings: Settings) -> None:
    """Open the data folder and the database: those that cannot be used fail here, before the server starts."""
    store = ShotStore(settings.data)
    try:
        open_database(settings.data, settings.database).dispose()
    finally:
        store.close()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pullfocus serve", description="Serve the page and the REST interface.", allow_abbrev=False
    )
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help="settings in TOML, by their names; the arguments below go before it"
    )
    given_alone = argparse.SUPPRESS
    parser.add_argument(
        "--host", default=given_alone, help=f"address to listen on (default: {Settings.host}, this machine)"
    )
    parser.add_argument(
        "--port",
        type=int,
        default=given_alone,
        help=f"port to listen on, 0 takes a free one (default: {Settings.port})",
    )
    parser.add_argument(
        "--data",
        metavar="DIR",
        type=Path,
        default=given_alone,
        help=f"folder that keeps shots and edits (default: {default_data_folder()})",
    )
    parser.add_argument(
        "--no-demo", dest="demo", action="store_false", default=given_alone, help="do not write the demo shot"
    )
    parser.add_argument(
        "--log-format",
        choices=get_args(LogFormat),
        default=given_alone,
        help="format of the log (default: text on a terminal, else json)",
    )
    parser.add_argument(
        "--dask",
        metavar="ADDRESS",
        default=given_alone,
        help="scheduler whose workers draw the frames of renders, such as tcp://farm:8786; local:N starts N on this machine",
    )
    parser.add_argument(
        "--proxy-headers",
        dest="trusted_proxies",
        metavar="ADDRESS",
        nargs="+",
        default=given_alone,
        help="proxies whose X-Forwarded-For and X-Forwarded-Proto are believed",
    )
    parser.add_argument(
        "--allowed-host",
        dest="allowed_hosts",
        metavar="NAME",
        action="append",
        default=given_alone,
        help="further name that the service is reached by, such as that of a proxy; repeat it for several",
    )
    access = parser.add_mutually_exclusive_group()
    access.add_argument(
        "--require-keys",
        dest="access",
        action="store_const",
        const="keys",
        default=given_alone,
        help="need keys also where this machine alone reaches the service",
    )
    access.add_argument(
        "--insecure",
        dest="access",
        action="store_const",
        const="insecure",
        default=given_alone,
        help="let everybody in who reaches the service",
    )
    return parser


def _settings(typed: argparse.Namespace) -> Settings:
    """Return the settings of the service, by the configuration file and the arguments, which go before it."""
    arguments = vars(typed)
    file = arguments.pop("config")
    named = tuple(arguments.pop("allowed_hosts", ()))
    settings = Settings(**(read_configuration(file) if file else {}) | arguments)
    return replace(
        settings,
        data=settings.data.expanduser().absolute(),
        trusted_proxies=tuple(settings.trusted_proxies),
        allowed_hosts=(*settings.allowed_hosts, *named),
    )


def _listen(host: str, port: int) -> socket.socket:
    """Open the listening socket before anything is started, so that a port in use is one clear error."""
    if not 0 <= port <= 65535:
        raise SettingsError(f"a port is a number from 0 to 65535, got {port}", code="bad_port")
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listener = socket.create_server((host, port), family=family, backlog=2048)
        # Its connections inherit it. Without it the body of an answer, a write of its own, waits for the client's delayed ACK.
        listener.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return listener
    except socket.gaierror as error:
        raise SettingsError(f"{host} is no address to listen on: {error.strerror}", code="bad_host") from error
    except OSError as error:
        if error.errno == errno.EADDRNOTAVAIL:
            raise SettingsError(f"{host} is no address of this machine", code="bad_host") from error
        reason = "is in use; choose another with --port" if error.errno == errno.EADDRINUSE else error.strerror
        raise OutputError(f"port {port} on {host} {reason}", code="port") from error
