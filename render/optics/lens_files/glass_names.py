"""Media by the names and codes that lens files give them.

Names are those of the makers' catalogues (`glasses.csv`: Schott, Ohara, Hoya, Hikari, Sumita, CDGM) by index and Abbe number;
those in `render.optics.glass.CATALOGUE` have Sellmeier coefficients, and win. Codes are those of MIL-G-174: 517642 is the
glass of n_d 1.517 and V_d 64.2.
"""

from __future__ import annotations

import csv
import re
from functools import cache
from pathlib import Path

from render.model.lens import AIR, Glass
from render.optics.glass import CATALOGUE

_CODE = re.compile(r"(\d{3})[.:]?(\d{3})", re.ASCII)
_FINE_CODE = re.compile(r"(\d{3,7})\.(\d{2,7})", re.ASCII)


def find_glass(name: str) -> Glass | None:
    """The medium of a name or of a code, or None.

    Hyphens, blanks, case and a maker's name behind an underscore do not count: N-BK7, NBK7 and nbk7_SCHOTT are one. Where the
    lead-free N- glass alone is still made, it stands for the older one, and the other way round.

    Args:
        name: such as ``SF10``, ``NBK7_SCHOTT``, ``517642`` or ``516800.6417``.
    """
    if name.upper() in ("AIR", "VACUUM"):
        return AIR
    return glass_of_code(name) or _find(_plain(name))


def glass_of_code(code: str) -> Glass | None:
    """The medium of a six-digit code, or of one with more digits on either side of a point; None for anything else."""
    short = _CODE.fullmatch(code)
    if short:
        return Glass(1 + int(short[1]) / 1000, int(short[2]) / 10, name=code)
    fine = _FINE_CODE.fullmatch(code)
    if fine:  # as many digits as are given, the point of V_d behind the second
        return Glass(1 + int(fine[1]) / 10 ** len(fine[1]), int(fine[2]) / 10 ** (len(fine[2]) - 2), name=code)
    return None


def _find(plain: str) -> Glass | None:
    if not plain:
        return None
    known = _known_glasses()
    related = plain[1:] if plain.startswith("N") else f"N{plain}"
    return known.get(plain) or known.get(related)


@cache
def _known_glasses() -> dict[str, Glass]:
    """All glasses by their plain names; of two makers' glasses of one name, the one that stands first in the table."""
    known = {_plain(glass.name): glass for glass in CATALOGUE.values()}
    with (Path(__file__).parent / "glasses.csv").open(encoding="ascii", newline="") as table:
        for row in csv.DictReader(line for line in table if not line.startswith("#")):
            glass = Glass(float(row["nd"]), float(row["vd"]), name=row["name"])
            known.setdefault(_plain(glass.name), glass)
    return known


def _plain(name: str) -> str:
    return re.sub(r"[-\s]", "", name.split("_")[0]).upper()
