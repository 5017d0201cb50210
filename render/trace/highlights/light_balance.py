"""Light of a table's rays as the tracer has it: in the mean over a pixel's rays it is what the table states."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from render.disk_cache import ArrayCache
from render.model.arrays import DoubleArray
from render.trace.lens_fit import mean_light
from render.trace.lens_table import LIGHT, REGION, WEIGHT, PolynomialTable

_FINER = 4
"""Rows for each row of the table: between two of them, the open part of the pupil is not in proportion to the field height."""
_cache = ArrayCache("pupil-light", ("model", "trace"))


@lru_cache(maxsize=2)  # live pictures ask for the same again and again
def balance_light(table: PolynomialTable) -> PolynomialTable:
    """Scale the weights of the rows that a rim clips, so that through a round iris their mean is the row's light."""
    rows = table.rows.astype(np.float64)
    if not (rows[..., REGION + 3] > 0).any():
        return table
    last = rows.shape[1] - 1
    at = np.arange(_FINER * last + 1) / _FINER
    low = np.minimum(at.astype(int), last - 1)
    part = (at - low)[:, None]
    fine = rows[:, low] * (1 - part) + rows[:, low + 1] * part
    light = _cache.get(lambda: {"light": _mean_light(fine)}, fine)["light"]
    is_clipped = (fine[..., REGION + 3] > 0) & (light > 0)
    fine[..., WEIGHT:REGION] *= np.where(is_clipped, fine[..., LIGHT] / np.where(is_clipped, light, 1), 1)[..., None]
    return replace(table, rows=fine.astype(np.float32))


def _mean_light(rows: DoubleArray) -> DoubleArray:
    """Mean weight ``(wavelengths, heights)`` of each row's rays."""
    return np.array([mean_light(some) for some in rows])
