"""The glasses of the makers' catalogues, from `glasses.csv`, which scripts/glass_catalogue writes."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from render.model.lens import Dispersion, Glass
from render.optics.dispersion.formulas import index_and_abbe

OPTICAL_GLASS = ("Schott", "Ohara", "Hoya", "Hikari", "CDGM", "Sumita")
"""Makers of glass for lenses; Hikari is Nikon's."""


@dataclass(frozen=True)
class CatalogueGlass:
    """A glass of a maker's catalogue.

    Attributes:
        name: the maker's, such as N-BK7.
        maker: such as Schott; ``plastics`` and ``others`` for what many make.
        source: ``sheet``, ``database``, ``agf`` or ``1983``; scripts/glass_catalogue names them.
        index: at the d line, as listed.
        abbe: Abbe number V_d, as listed.
        partials: relative partial dispersions P_hg, P_gF, P_Fd and P_Cr, such as (n_h − n_g) / (n_F − n_C), of the formula.
        range_nm: shortest and longest wavelength that the source vouches for.
        formula: of its dispersion, a name in `render.optics.dispersion.formulas`.
        coefficients: of the formula, as text: few of the catalogue's glasses are ever asked for.
    """

    name: str
    maker: str
    source: str
    index: float
    abbe: float
    partials: tuple[float, float, float, float]
    range_nm: tuple[float, float]
    formula: str
    coefficients: str

    @property
    def dispersion(self) -> Dispersion:
        """The maker's formula."""
        return Dispersion(self.formula, tuple(map(float, self.coefficients.split())))

    @cached_property
    def glass(self) -> Glass:
        """The medium, with index and Abbe number as the formula gives them. Its name is the maker's alone."""
        dispersion = self.dispersion
        index, abbe = index_and_abbe(dispersion)
        c = dispersion.coefficients
        if self.formula == "sellmeier" and c[:2] == (1.0, 0.0) and len(c) == 8:
            return Glass(index, abbe, (c[2], c[4], c[6]), (c[3], c[5], c[7]), self.name)
        return Glass(index, abbe, name=self.name, dispersion=dispersion)


@cache
def catalogue() -> tuple[CatalogueGlass, ...]:
    """All glasses, by makers and then by names."""
    path = Path(__file__).parent / "glasses.csv"
    with path.open(encoding="utf-8", newline="") as table:
        rows = csv.reader(line for line in table if not line.startswith("#"))
        next(rows)
        return tuple(_glass_of(row) for row in rows)


def _glass_of(row: list[str]) -> CatalogueGlass:
    name, maker, source, *numbers, formula, coefficients = row
    index, abbe, phg, pgf, pfd, pcr, low, high = map(float, numbers)
    return CatalogueGlass(name, maker, source, index, abbe, (phg, pgf, pfd, pcr), (low, high), formula, coefficients)
