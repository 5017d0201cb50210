"""`pullfocus films`: the film library, and the report and the data sheet of one stock."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table

from render.cli.console import print_json, print_message
from render.cli.rich_output import print_result
from render.cli.tables.film import film_json, film_table, wedge_table
from render.cli.tables.sheet_path import resolve_sheet_path
from render.files import write_atomic
from render.film.report import film_report
from usd_schemas import LibraryFilm, library_films


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run_list)
    parser.add_argument("--json", action="store_true", help="print JSON")
    actions = parser.add_subparsers(title="actions", metavar="ACTION")
    show = actions.add_parser("show", help="numbers of a stock, and with --out a data sheet with its curves")
    show.set_defaults(run=run_show)
    show.add_argument(
        "film", metavar="NAME", help="name in the library, or a part of one that no other name has, such as 5219"
    )
    show.add_argument(
        "--out",
        metavar="PATH",
        type=Path,
        help="draw a data sheet: a .png or .svg file, or a folder to put NAME.png in",
    )
    show.add_argument(
        "--push",
        metavar="STOPS",
        type=float,
        default=0.0,
        help="stops by which the camera stock is pushed in development; without it 0",
    )
    show.add_argument(
        "--with",
        dest="partner",
        metavar="NAME",
        help="print stock for a negative, or negative for a print stock; without it the usual one",
    )
    # No default here, so that --json before `show` is kept.
    show.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")


def run_list(arguments: argparse.Namespace) -> None:
    """Print the library.

    Args:
        arguments: as `add_arguments` declares them.
    """
    if arguments.json:
        print_json({"films": [_film_json(film) for film in library_films()]})
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("name", "process", "for"):
        table.add_column(title, no_wrap=True)
    for title in ("ISO", "light", "year"):
        table.add_column(title, no_wrap=True, justify="right")
    table.add_column("description")
    for film in library_films():
        speed = f"{film.film.speed:g}" if film.film.speed else ""
        light = f"{film.balance_k:g} K" if film.balance_k else ""
        description = f"{film.title}: {film.description}"
        table.add_row(film.name, film.film.process, film.kind, speed, light, str(film.year), description)
    print_result(table)


def run_show(arguments: argparse.Namespace) -> None:
    """Print the report of one stock, and draw its data sheet with --out.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the library has no such stock, or it cannot be combined with the other one.
        OutputError: the sheet cannot be written.
    """
    report = film_report(arguments.film, push=arguments.push, partner=arguments.partner)
    target = None if arguments.out is None else resolve_sheet_path(arguments.out, report.entry.name)
    if arguments.json:
        print_json(film_json(report))
    else:
        print_result(film_table(report))
        print_result(wedge_table(report))
    if target is not None:
        from render.drawing.film_sheet import draw_film_sheet  # matplotlib takes a second to load

        write_atomic(target, draw_film_sheet(report, target.suffix.lower().removeprefix(".")))
        print_message(f"drawn: {target}")


def _film_json(film: LibraryFilm) -> dict[str, Any]:
    return {
        "name": film.name,
        "title": film.title,
        "process": film.film.process,
        "kind": film.kind,
        "speed": film.film.speed or None,
        "balanceK": film.balance_k,
        "year": film.year,
        "description": film.description,
    }
