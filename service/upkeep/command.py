"""`pullfocus doctor`, `pullfocus backup` and `pullfocus restore`."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

from render.cli.console import print_message
from render.errors import SettingsError
from service.http.configuration import read_configuration
from service.http.settings import Settings, default_data_folder
from service.storage.backup import back_up
from service.storage.database.file import noted_database
from service.storage.restore import restore as restore_backup
from service.upkeep.doctor import examine

_WORDS = {"ok": "ok  ", "warn": "warn", "fail": "FAIL"}
_ENDINGS = (".tar.gz", ".tgz")


def doctor(arguments: Sequence[str]) -> int:
    """Check what the service needs of this machine, and print a line for each check.

    Args:
        arguments: as typed after ``pullfocus doctor``.

    Returns:
        The exit status: 1 where a check has failed.

    Raises:
        SettingsError: the configuration cannot be used.
    """
    given_alone = argparse.SUPPRESS
    parser = _parser(
        "doctor",
        "Check what the service needs of this machine. The exit status is 1 where it would not run.",
        given_alone,
    )
    parser.add_argument(
        "--config", metavar="FILE", type=Path, help="settings of the service in TOML; the other arguments go before it"
    )
    parser.add_argument("--host", default=given_alone, help=f"address to listen on (default: {Settings.host})")
    parser.add_argument("--port", type=int, default=given_alone, help=f"port to listen on (default: {Settings.port})")
    parser.add_argument(
        "--issuer",
        metavar="ADDRESS",
        dest="oidc_issuer",
        default=given_alone,
        help="issuer of tokens (oidc_issuer), asked for its keys",
    )
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")
    typed = vars(parser.parse_args(arguments))
    file, as_json = typed.pop("config"), typed.pop("json")
    settings = Settings(**(read_configuration(file) if file else {}) | typed)
    findings = list(examine(replace(settings, data=settings.data.expanduser().absolute())))
    if as_json:
        print(json.dumps([asdict(finding) for finding in findings], indent=1))
    else:
        for finding in findings:
            print(f"{_WORDS[finding.state]}  {finding.name:<10} {finding.text}")
            if finding.remedy:
                print(f"{'':<17}{finding.remedy}")
    return int(any(finding.state == "fail" for finding in findings))


def backup(arguments: Sequence[str]) -> int:
    """Write a backup of a data folder.

    Args:
        arguments: as typed after ``pullfocus backup``.

    Returns:
        The exit status.

    Raises:
        SettingsError: the archive is of another kind.
        PullfocusError: the folder cannot be read, or the archive not written.
    """
    parser = _parser(
        "backup",
        "Write the data folder of a service, which may run, to one archive. It holds keys: keep it safe.",
        default_data_folder(),
    )
    parser.add_argument("archive", metavar="OUT.tar.gz", type=Path, help="the archive to write")
    typed = parser.parse_args(arguments)
    if not typed.archive.name.endswith(_ENDINGS):
        raise SettingsError(f"a backup is a {' or '.join(_ENDINGS)} file, got {typed.archive.name}", code="bad_archive")
    data = typed.data.expanduser().absolute()
    count = back_up(data, typed.archive)
    size = typed.archive.stat().st_size / 1024**2
    print_message(f"{typed.archive}: {count:,} files, {size:.1f} MiB, read again and compared")
    database = noted_database(data)
    if database is not None:
        print_message(f"the list of renders is not in it: back up the database {database} by pg_dump")
    return 0


def restore(arguments: Sequence[str]) -> int:
    """Make a data folder from a backup.

    Args:
        arguments: as typed after ``pullfocus restore``.

    Returns:
        The exit status.

    Raises:
        PullfocusError: the archive is damaged, or the folder is not empty or cannot be written.
    """
    parser = _parser(
        "restore",
        "Make the data folder of a service from a backup. The folder must be empty or not there.",
        default_data_folder(),
    )
    parser.add_argument("archive", metavar="FILE.tar.gz", type=Path, help="a backup")
    typed = parser.parse_args(arguments)
    data = typed.data.expanduser().absolute()
    count = restore_backup(typed.archive, data)
    print_message(f"{data}: {count:,} files, each as it was backed up")
    database = noted_database(data)
    if database is not None:
        print_message(
            f"the list of renders was not in it, but in the database {database}: restore that by psql or pg_restore"
        )
    return 0


def _parser(command: str, description: str, data: Path | str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=f"pullfocus {command}", description=description, allow_abbrev=False)
    parser.add_argument(
        "--data",
        metavar="DIR",
        type=Path,
        default=data,
        help=f"data folder of the service (default: {default_data_folder()})",
    )
    return parser
