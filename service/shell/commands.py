"""`pullfocus push`, `pullfocus render` and `pullfocus jobs`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from render.cli.console import print_message
from render.cli.parser import Parser
from render.errors import SettingsError, one_line
from service.client import Client
from service.shell import connection, render_options, uploads
from service.shell.connection import again, connected
from service.shell.listing import print_plan, print_render, print_renders
from service.shell.watching import print_end, watch

_CHANGES = {
    "pause": "begin no more of its frames; those under way are finished",
    "resume": "go on with a render that was paused",
    "cancel": "end it; frames that are stored stay",
    "accept": "take it for done, though frames have failed or were given up",
    "retry": "draw those frames again that have failed, were given up, or are lost",
    "remove": "remove a render that has ended, and its files",
}


def push(arguments: Sequence[str]) -> int:
    """Upload a shot and print its id.

    Args:
        arguments: as typed after ``pullfocus push``.

    Returns:
        The exit status.

    Raises:
        PullfocusError: the shot cannot be read, or the service not reached, or it refuses.
    """
    parser = Parser(
        prog="pullfocus push", description="Upload a shot to a service, and print its id.", allow_abbrev=False
    )
    parser.add_argument(
        "shot",
        metavar="SHOT",
        type=Path,
        help="USD file, which goes with the layers and textures that it refers to; or a .usdz, .zip or folder",
    )
    parser.add_argument("--name", help="name of the shot (default: that of the file)")
    uploads.add_arguments(parser)
    connection.add_arguments(parser)
    typed = parser.parse_args(arguments)
    with connected(typed) as client:
        print(one_line(uploads.push_shot(client, typed.shot, typed, typed.name).id))
    return 0


def render(arguments: Sequence[str]) -> int:
    """Send a render, print its id, and watch it until its end.

    Args:
        arguments: as typed after ``pullfocus render``.

    Returns:
        The exit status: 1 where frames have failed, or a dry run finds that it would be refused.

    Raises:
        SettingsError: settings cannot be used, or contradict each other.
        PullfocusError: the shot cannot be read, or the service not reached, or it refuses.
    """
    typed = _render_parser().parse_args(arguments)
    settings = render_options.read_settings(typed)
    if typed.detach and typed.out is not None:
        raise SettingsError("--detach does not wait for the frames that --out fetches: leave one of them out")
    if typed.dry_run and uploads.is_path(typed.shot):
        raise SettingsError(f"--dry-run sends nothing: push {typed.shot} first, and give the id of the shot")
    with connected(typed) as client:
        if typed.dry_run:
            return print_plan(client.plan(typed.shot, **settings))
        shot = uploads.push_shot(client, Path(typed.shot), typed).id if uploads.is_path(typed.shot) else typed.shot
        sent = client.render(shot, idempotency_key=typed.idempotency_key, **settings)
        print(one_line(sent.id), flush=True)
        if typed.detach:
            print_message(f"`{again(typed, 'jobs', 'watch', sent.id)}` watches it")
            return 0
        return watch(client, sent.id, typed.out, typed)


def jobs(arguments: Sequence[str]) -> int:
    """List, watch and change the renders of a service.

    Args:
        arguments: as typed after ``pullfocus jobs``.

    Returns:
        The exit status: 1 where a render that is watched has not all its frames.

    Raises:
        PullfocusError: the service cannot be reached, or refuses.
    """
    typed = _jobs_parser().parse_args(arguments)
    with connected(typed) as client:
        return _run(client, typed)


def _run(client: Client, typed: argparse.Namespace) -> int:
    match typed.action:
        case "list" | "show":
            if typed.action == "list":
                print_renders(client.renders(typed.most), as_json=typed.json)
            else:
                print_render(client.get(typed.id), client.tasks(typed.id), as_json=typed.json)
        case "watch":
            return watch(client, typed.id, typed.out, typed)
        case "fetch":
            return _fetch(client, typed)
        case "log":
            _print_log(client, typed)
        case "remove":
            client.remove(typed.id)
            print_message(f"render {typed.id} is removed")
        case change:
            print_end(client, getattr(client, change)(typed.id), typed)
    return 0


def _print_log(client: Client, typed: argparse.Namespace) -> None:
    if typed.follow and typed.tail is not None:
        raise SettingsError("--follow prints all of a log: leave --tail out")
    if typed.follow:
        client.follow_log(
            typed.id, typed.frame, lambda text: print(_printable(text), end="", flush=True), attempt=typed.attempt
        )
    else:
        print(_printable(client.log(typed.id, typed.frame, attempt=typed.attempt, tail=typed.tail)), end="")


def _printable(text: str) -> str:
    return "\n".join(map(one_line, text.split("\n")))


def _fetch(client: Client, typed: argparse.Namespace) -> int:
    if all(wanted is None for wanted in (typed.out, typed.movie, typed.contact_sheet, typed.focus_report)):
        raise SettingsError("fetch needs --out, --movie, --contact-sheet or --focus-report, which say what goes where")
    is_complete = True
    if typed.out is not None:
        paths = client.download(typed.id, typed.out, on_file=lambda path: print_message(str(path)))
        render = client.get(typed.id)
        frames = len(paths) // len(render.formats)
        print_message(f"{frames} of {render.count} frames of render {render.id} are in {typed.out}")
        is_complete = frames == render.count
    if typed.movie is not None:
        print_message(str(client.movie(typed.id, typed.movie)))
    if typed.contact_sheet is not None:
        print_message(str(client.contact_sheet(typed.id, typed.contact_sheet)))
    if typed.focus_report is not None:
        print_message(str(client.focus_report(typed.id, typed.focus_report)))
    return 0 if is_complete else 1


def _render_parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="pullfocus render",
        description="Have a service render a shot: send it, print the id of the render, and watch it until its end.",
        allow_abbrev=False,
    )
    parser.add_argument(
        "shot", metavar="SHOT", help="id of a shot of the service, or a path with a dot or slash, which is pushed first"
    )
    parser.add_argument("--out", metavar="DIR", type=Path, help="fetch each frame into this folder when it is done")
    parser.add_argument("--detach", "--no-wait", action="store_true", help="do not wait for the frames")
    parser.add_argument(
        "--dry-run",
        action="store_true",
        help="tell the frames and settings, what they cost and what stands against them, and send nothing",
    )
    parser.add_argument("--idempotency-key", metavar="TEXT", help="the same one gives the same render")
    render_options.add_arguments(parser)
    uploads.add_arguments(parser)
    connection.add_arguments(parser)
    return parser


def _jobs_parser() -> argparse.ArgumentParser:
    parser = Parser(prog="pullfocus jobs", description="The renders of a service.", allow_abbrev=False)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    listing = actions.add_parser("list", help="list them, the newest first")
    listing.add_argument(
        "--most", metavar="N", type=_count, default=50, help="number of renders (default: %(default)s)"
    )
    show = actions.add_parser("show", help="show one with its frames, and what went wrong with them")
    watching = actions.add_parser("watch", help="show the progress of one until its end")
    fetch = actions.add_parser(
        "fetch", help="fetch the frames that are done, those that are there left out, or what is made of them"
    )
    watching.add_argument("--out", metavar="DIR", type=Path, help="fetch each frame into this folder when it is done")
    fetch.add_argument("--out", metavar="DIR", type=Path, help="folder for the frames")
    fetch.add_argument(
        "--movie", metavar="FILE", type=Path, help="write the movie of a render that has ended: .mp4, .mov, .webm"
    )
    fetch.add_argument("--contact-sheet", metavar="FILE.png", type=Path, help="write a sheet of its frames")
    fetch.add_argument(
        "--focus-report",
        metavar="FILE",
        type=Path,
        help="write how sharp its focus points are, frame by frame: .csv, .json, .html; it need not have ended",
    )
    log = actions.add_parser(
        "log", help="print the log of a frame: its steps, what was said meanwhile, what went wrong"
    )
    log.add_argument("--attempt", metavar="N", type=_count, help="number of an attempt (default: the last one)")
    log.add_argument("--tail", metavar="N", type=_count, help="print the last N lines")
    log.add_argument(
        "--follow", action="store_true", help="print further lines as they come, until the attempt has ended"
    )
    changes = [actions.add_parser(action, help=purpose) for action, purpose in _CHANGES.items()]
    for action in (show, watching, fetch, log, *changes):
        action.add_argument("id", metavar="ID", help="id of the render")
    log.add_argument("frame", metavar="FRAME", type=int, help="number of the frame")
    for action in (listing, show):
        action.add_argument("--json", action="store_true", help="print JSON, with the keys of the REST interface")
    for action in (listing, show, watching, fetch, log, *changes):
        connection.add_arguments(action)
    return parser


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text[:9]) <= 100_000:
        raise argparse.ArgumentTypeError(f"expected 1 to 100,000, got {text!r}")
    return int(text)
