"""`pullfocus keys`: the keys of a data folder. A service that runs on it knows them at once."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

from render.cli.console import print_message
from service.http.settings import default_data_folder
from service.identity.keys import Keys
from service.identity.principal import DEFAULT_PROJECT
from service.identity.roles import ROLES, scopes_of


def keys(arguments: Sequence[str]) -> int:
    """Create, list or revoke keys.

    Args:
        arguments: as typed after ``pullfocus keys``.

    Returns:
        The exit status.

    Raises:
        SettingsError: a role, label or project cannot be used.
        NotFoundError: there is no key of this id.
        OutputError: the keys cannot be read or written.
    """
    typed = _parser().parse_args(arguments)
    store = Keys(typed.data.expanduser().absolute())
    if typed.action == "create":
        expires_at = datetime.now(UTC) + timedelta(days=typed.days) if typed.days else None
        project = typed.project or ("*" if "admin" in typed.role else DEFAULT_PROJECT)
        _, text = store.create(typed.label, scopes_of(typed.role), project, expires_at)
        print(text)
    elif typed.action == "revoke":
        key = store.revoke(typed.id)
        print(f"revoked {key.id} ({key.label})")
    else:
        found = store.list()
        if not found:
            print_message(f"there are no keys in {typed.data}")
        for key in found:
            end = f"until {key.expires_at}" if key.expires_at else "for ever"
            print(f"{key.id}  {key.label}  {','.join(key.scopes)}  project {key.project}  {end}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="pullfocus keys", description="Keys of the service.", allow_abbrev=False)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    create = actions.add_parser("create", help="create a key and print it: it cannot be shown again")
    create.add_argument("label", metavar="NAME", help="whom it is for")
    create.add_argument(
        "--role",
        action="append",
        required=True,
        help=f"{', '.join(ROLES)}, or a scope: read, edit, render, admin; repeat it for several",
    )
    create.add_argument(
        "--project", help=f"project whose shots it sees, * for all (default: {DEFAULT_PROJECT}; * with the role admin)"
    )
    create.add_argument("--days", type=_days, help="days until it expires (default: never)")
    listing = actions.add_parser("list", help="list the keys, without their secrets")
    revoke = actions.add_parser("revoke", help="refuse a key from now on")
    revoke.add_argument("id", metavar="ID", help="its id, as `list` prints it")
    for action in (create, listing, revoke):
        action.add_argument(
            "--data",
            metavar="DIR",
            type=Path,
            default=default_data_folder(),
            help="data folder of the service (default: %(default)s)",
        )
    return parser


def _days(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 36_500:
        raise argparse.ArgumentTypeError(f"expected 1 to 36500 days, got {text!r}")
    return int(text)
