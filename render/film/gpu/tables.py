"""A stock's curves as rows of a texture, for the device."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

import moderngl
import numpy as np

from render.errors import SettingsError
from render.film.curve import Knots
from render.film.settings import FilmSettings
from render.film.stock import Stock
from render.model.arrays import DoubleArray

_KEPT = 8  # stocks: a session goes between few
_NO_GRAIN: Knots = ((0.0, 0.0), (1.0, 0.0))


Rows = list[tuple[DoubleArray, DoubleArray]]
"""Places at even steps, and the values there."""


@dataclass(frozen=True, eq=False)
class Tables:
    """Curves of a film.

    Attributes:
        texture: a row for each record of each kind: density over log exposure (``curve``), granularity over density (``grain``),
            and where there is a print its density over log exposure (``print``).
        ranges: by kind, first value of the records' rows, and steps per unit.
    """

    texture: moderngl.Texture
    ranges: dict[str, tuple[list[float], list[float]]]


class TableCache:
    """The tables of the films that were used lately."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._tables: OrderedDict[tuple[Stock | None, Stock | None], Tables] = OrderedDict()

    def tables_of(self, film: FilmSettings) -> Tables:
        """The tables of a film with a stock."""
        key = film.stock, film.print_stock
        if key not in self._tables:
            self._tables[key] = self._build(film)
            if len(self._tables) > _KEPT:
                self._tables.popitem(last=False)[1].texture.release()
        self._tables.move_to_end(key)
        return self._tables[key]

    def release(self) -> None:
        """Release the memory on the device."""
        while self._tables:
            self._tables.popitem()[1].texture.release()

    def _build(self, film: FilmSettings) -> Tables:
        kinds = _kinds(film)
        values = np.stack([density for rows in kinds.values() for _, density in rows]).astype(np.float32)
        texture = self._ctx.texture(values.shape[::-1], 1, values.tobytes(), dtype="f4")
        return Tables(texture, {kind: _range(rows) for kind, rows in kinds.items()})


def _kinds(film: FilmSettings) -> dict[str, Rows]:
    stock, printed = film.stock, film.print_stock
    if stock is None:
        raise SettingsError(f"film process {film.process} has no stock, so it has no density")
    curves = [curve.table for curve in stock.curves]
    grain = [_granularity(knots, len(curves[0][0])) for knots in stock.granularity or (_NO_GRAIN,) * len(curves)]
    kinds = {"curve": curves, "grain": grain}
    return kinds if printed is None else {**kinds, "print": [curve.table for curve in printed.curves]}


def _range(rows: Rows) -> tuple[list[float], list[float]]:
    return [float(x[0]) for x, _ in rows], [(len(x) - 1) / float(x[-1] - x[0]) for x, _ in rows]


def _granularity(knots: Knots, count: int) -> tuple[DoubleArray, DoubleArray]:
    densities, deviations = np.array(knots, np.float64).T
    x = np.linspace(densities[0], densities[-1], count)
    return x, np.interp(x, densities, deviations)
