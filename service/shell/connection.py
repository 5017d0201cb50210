"""The service that a command works with: its address, the key, and its errors."""

from __future__ import annotations

import argparse
import os
import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from render.errors import InputError, NotFoundError, PullfocusError, SettingsError
from service.client import Client, ClientError, ConnectionFailedError, FileError, RefusedError, SettingError
from service.client.connecting import DEFAULT_URL

URL_VARIABLE, KEY_VARIABLE = "PULLFOCUS_URL", "PULLFOCUS_KEY"
_MOST_KEY_BYTES = 64 * 1024
_WRONG_SETTINGS = ("invalid_request", "bad_setting")
"""Codes of refusals that are about what was typed."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments, for `connected`."""
    group = parser.add_argument_group("the service")
    group.add_argument("--on", metavar="URL", help=f"its address (default: {URL_VARIABLE}, else {DEFAULT_URL})")
    group.add_argument(
        "--key-file",
        metavar="FILE",
        type=Path,
        help=f"file with a key of the service (default: the key in {KEY_VARIABLE})",
    )


@contextmanager
def connected(typed: argparse.Namespace) -> Iterator[Client]:
    """Connect to the service that was typed.

    Args:
        typed: as `add_arguments` declares them.

    Raises:
        SettingsError: the address, the key or a setting cannot be used.
        PullfocusError: the service cannot be reached, or refuses a request.
    """
    url = address(typed)
    try:
        with Client(url, _key(typed)) as client:
            yield client
    except SettingError as error:
        raise SettingsError(str(error)) from error
    except RefusedError as error:
        raise _explained(error) from error
    except ConnectionFailedError as error:
        hint = f"is `pullfocus serve` running there? --on or {URL_VARIABLE} names another service"
        raise PullfocusError(f"{url}: {error}; {hint}", code="no_service") from error
    except FileError as error:
        raise PullfocusError(str(error), code="file") from error
    except ClientError as error:
        raise PullfocusError(f"{url}: {error}", code="bad_answer") from error


def address(typed: argparse.Namespace) -> str:
    """Return the address of the service."""
    return typed.on or os.environ.get(URL_VARIABLE) or DEFAULT_URL


def again(typed: argparse.Namespace, *words: str) -> str:
    """Return a command for the same service, as it is to be typed."""
    key = ["--key-file", str(typed.key_file)] if typed.key_file is not None else []
    return shlex.join(["pullfocus", *words, *(["--on", typed.on] if typed.on else []), *key])


def _key(typed: argparse.Namespace) -> str | None:
    if typed.key_file is None:
        return os.environ.get(KEY_VARIABLE) or None
    try:
        with typed.key_file.expanduser().open("rb") as file:
            content: bytes = file.read(_MOST_KEY_BYTES)
    except OSError as error:
        raise SettingsError(f"--key-file {typed.key_file}: {error.strerror or error}") from error
    return content.decode(errors="replace").strip()


def _explained(error: RefusedError) -> PullfocusError:
    if error.status == 401:
        detail = f"{error.detail.rstrip('.')}; put a key into {KEY_VARIABLE}, or into a file for --key-file"
        return PullfocusError(detail, code=error.code)
    if error.status == 404:
        return NotFoundError(error.detail, code=error.code, path=error.path)
    kind = SettingsError if error.code in _WRONG_SETTINGS else InputError
    return kind(error.detail, code=error.code, path=error.path)
