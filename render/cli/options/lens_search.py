"""Options that search the lens library."""

from __future__ import annotations

import argparse
import math
import re

from render.errors import SettingsError
from usd_schemas import LensSearch, LibraryLens, SchemaError, library_lenses

_RANGE = re.compile(r"(?P<least>\d+(?:\.\d+)?)?(?P<dash>-)?(?P<most>\d+(?:\.\d+)?)?")


def add_lens_search(parser: argparse.ArgumentParser) -> None:
    """Declare the options of a search."""
    search = parser.add_argument_group("search", "a lens has to be all of them")
    search.add_argument(
        "--focal-length",
        dest="focal_lengths",
        metavar="MM",
        type=_range,
        help="in mm: one, as engraved, a range such as 40-60, or 200-",
    )
    search.add_argument(
        "--faster-than", metavar="N", type=float, default=math.inf, help="f-number wide open, at most this"
    )
    search.add_argument(
        "--family", metavar="WORD", default="", help="what it is or how it draws, such as petzval, wide, 'soft focus'"
    )
    search.add_argument(
        "--year",
        metavar="YEAR",
        type=_range,
        help="of its patent or publication: one, a range such as 1950-1969, or 2000-",
    )
    search.add_argument(
        "--search", metavar="WORDS", default="", help="words of its name, maker, description and source"
    )


def search_options(arguments: argparse.Namespace) -> list[str]:
    """Options of a search that are given."""
    given = {
        "--focal-length": arguments.focal_lengths is not None,
        "--faster-than": arguments.faster_than != math.inf,
        "--family": arguments.family != "",
        "--year": arguments.year is not None,
        "--search": arguments.search != "",
    }
    return [option for option, is_given in given.items() if is_given]


def found_lenses(arguments: argparse.Namespace) -> list[LibraryLens]:
    """Lenses of the library that are searched for, in its order.

    Args:
        arguments: as `add_lens_search` declares them.

    Raises:
        SettingsError: a range ends before it begins, or nothing is of that family.
    """
    least, most = arguments.focal_lengths or (0.0, math.inf)
    if least == most:  # 58 finds 58.3: as engraved
        least, most = least - 0.5, most + 0.5
    try:
        search = LensSearch(
            focal_length_mm=(least, most),
            faster_than=arguments.faster_than,
            family=arguments.family,
            years=arguments.year or LensSearch.years,
            words=arguments.search,
        )
    except SchemaError as error:
        raise SettingsError(str(error)) from error
    return [lens for lens in library_lenses() if search.finds(lens)]


def _range(typed: str) -> tuple[float, float]:
    match = _RANGE.fullmatch(typed.strip())
    if match is None or not (match["least"] or match["most"]):
        raise argparse.ArgumentTypeError(f"a number, or a range such as 40-60, got {typed[:40]!r}")
    least = float(match["least"] or 0)
    if match["dash"]:
        return least, float(match["most"] or math.inf)
    return least, least
