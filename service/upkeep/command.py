"""`pullfocus doctor`, `pullfocus backup` and `pullfocus restore`."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from render.cli.console import print_message
from render.errors import SettingsError
from service.http.settings import Settings, default_data_folder
from service.storage.backup import back_up
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
    """
    parser = _parser(
        "doctor", "Check what the service needs of this machine. The exit status is 1 where it would not run."
    )
    parser.add_argument("--host", default=Settings.host, help="address to listen on (default: %(default)s)")
    parser.add_argument("--port", type=int, default=Settings.port, help="port to listen on (default: %(default)s)")
    parser.add_argument(
        "--issuer", metavar="ADDRESS", default="", help="issuer of tokens (oidc_issuer), asked for its keys"
    )
    parser.add_argument("--json", action="store_true", help="print the findings as JSON")
    typed = parser.parse_args(arguments)
    findings = list(examine(typed.data.expanduser().absolute(), typed.host, typed.port, typed.issuer))
    if typed.json:
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
        "backup", "Write the data folder of a service, which may run, to one archive. It holds keys: keep it safe."
    )
    parser.add_argument("archive", metavar="OUT.tar.gz", type=Path, help="the archive to write")
    typed = parser.parse_args(arguments)
    if not typed.archive.name.endswith(_ENDINGS):
        raise SettingsError(f"a backup is a {' or '.join(_ENDINGS)} file, got {typed.archive.name}", code="bad_archive")
    count = back_up(typed.data.expanduser().absolute(), typed.archive)
    size = typed.archive.stat().st_size / 1024**2
    print_message(f"{typed.archive}: {count:,} files, {size:.1f} MiB, read again and compared")
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
        "restore", "Make the data folder of a service from a backup. The folder must be empty or not there."
    )
    parser.add_argument("archive", metavar="FILE.tar.gz", type=Path, help="a backup")
    typed = parser.parse_args(arguments)
    data = typed.data.expanduser().absolute()
    count = restore_backup(typed.archive, data)
    print_message(f"{data}: {count:,} files, each as it was backed up")
    return 0


def _parser(command: str, description: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=f"pullfocus {command}", description=description, allow_abbrev=False)
    parser.add_argument(
        "--data",
        metavar="DIR",
        type=Path,
        default=default_data_folder(),
        help="data folder of the service (default: %(default)s)",
    )
    return parser
