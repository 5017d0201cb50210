"""Numbers of a glass as a table and as JSON."""

from __future__ import annotations

from typing import Any

from rich import box
from rich.table import Table

from render.model.lens import Glass
from render.optics.dispersion.catalogue import CatalogueGlass
from render.optics.dispersion.lines import C_LINE_NM, D_LINE_NM, F_LINE_NM, G_LINE_NM, H_LINE_NM, R_LINE_NM
from render.optics.glass import refractive_index

_LINES_NM = {"h": H_LINE_NM, "g": G_LINE_NM, "F": F_LINE_NM, "d": D_LINE_NM, "C": C_LINE_NM, "r": R_LINE_NM}


def glass_json(medium: Glass, found: CatalogueGlass | None) -> dict[str, Any]:
    """Convert a glass to JSON.

    Args:
        medium: the glass.
        found: its entry of the catalogue; None for a code.
    """
    n_f, n_c, n_g = (refractive_index(medium, line) for line in (F_LINE_NM, C_LINE_NM, G_LINE_NM))
    return {
        "name": medium.name,
        "maker": found.maker if found else None,
        "index": medium.index,
        "abbe": medium.abbe,
        "partialDispersionGF": (n_g - n_f) / (n_f - n_c) if n_f != n_c else None,
        "formula": found.formula if found else None,
        "coefficients": list(found.dispersion.coefficients) if found else None,
        "rangeNm": list(found.range_nm) if found else None,
        "indices": {line: refractive_index(medium, nm) for line, nm in _LINES_NM.items()},
    }


def glass_table(medium: Glass, found: CatalogueGlass | None) -> Table:
    """Lay out the numbers of a glass.

    Args:
        medium: the glass.
        found: its entry of the catalogue; None for a code.
    """
    numbers = glass_json(medium, found)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column()
    model = f"{medium.name}, a model glass" if medium.name else "air"
    table.add_row("glass", f"{found.name} of {found.maker}" if found else model)
    table.add_row("n_d, V_d", f"{medium.index:.5f}, {medium.abbe:.2f}")
    if numbers["partialDispersionGF"] is not None:
        table.add_row("P_gF", f"{numbers['partialDispersionGF']:.4f}")
    for line, nm in _LINES_NM.items():
        table.add_row(f"n_{line}", f"{numbers['indices'][line]:.5f} at {nm:.2f} nm")
    if found:
        table.add_row("formula", f"{found.formula}: {found.coefficients}")
        table.add_row("range", f"{found.range_nm[0]:g} to {found.range_nm[1]:g} nm")
    return table
