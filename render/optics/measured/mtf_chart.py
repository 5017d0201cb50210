"""MTF charts of makers, typed as tables of image height, line pairs per millimetre, sagittal and tangential contrast.

A file is CSV with commas, semicolons or tabs. Its first line may name the columns: ``height_mm``, ``lp_mm``, ``sagittal``,
``tangential``, in any order; without names they stand in this one. Contrast is from 0 to 1, or in per cent where any is above
1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.data_sheet import MAX_SHEET_MM
from render.optics.lens_files.lens_text import LensText

_COLUMNS = ("height_mm", "lp_mm", "sagittal", "tangential")
_MAX_ROWS = 5000
_MAX_HEIGHTS = 200
_MAX_PER_MM = 2000.0  # the cut-off of f/0.9 in green light


@dataclass(frozen=True, eq=False)
class MtfChart:
    """A chart.

    Attributes:
        heights_mm: ``(h,)`` image heights, rising.
        rows: for each row the index of its height.
        per_mm: ``(n,)`` line pairs per millimetre of each row.
        contrast: ``(n, 2)`` sagittal and tangential, from 0 to 1.
    """

    heights_mm: DoubleArray
    rows: NDArray[np.int64]
    per_mm: DoubleArray
    contrast: DoubleArray


def read_mtf_chart(text: LensText) -> MtfChart:
    """The chart of a CSV file.

    Args:
        text: of the file.

    Raises:
        InputError: it is no such table, or no lens has such contrast; the message names the line.
    """
    order: list[int] | None = None
    rows: list[list[float]] = []
    for line, raw in enumerate(text.lines, 1):
        words = [word.strip() for word in raw.partition("#")[0].replace(";", ",").replace("\t", ",").split(",")]
        if not any(words):
            continue
        if order is None:
            order = _order(text, words, line)
            if words[0].lower() in _COLUMNS:
                continue
        if len(words) != len(_COLUMNS):
            raise text.error(f"a row has 4 numbers ({', '.join(_COLUMNS)}), got {len(words)}", line)
        if len(rows) >= _MAX_ROWS:
            raise text.error(f"a chart has at most {_MAX_ROWS} rows", line)
        numbers = [
            text.number(words[place], name, line, at_least=0) for name, place in zip(_COLUMNS, order, strict=True)
        ]
        if numbers[0] > MAX_SHEET_MM or not 0 < numbers[1] <= _MAX_PER_MM:
            expected = f"a height up to {MAX_SHEET_MM:g} mm and above 0 and up to {_MAX_PER_MM:g} lp/mm"
            raise text.error(f"expected {expected}, got {numbers[0]:g} and {numbers[1]:g}", line)
        rows.append(numbers)
    if not rows:
        raise text.error("it has no rows of height_mm, lp_mm, sagittal, tangential")
    return _chart(text, np.array(rows))


def _order(text: LensText, words: list[str], line: int) -> list[int]:
    named = [word.lower() for word in words]
    if named[0] not in _COLUMNS:
        return list(range(len(_COLUMNS)))
    if sorted(named) != sorted(_COLUMNS):
        raise text.error(f"the columns are {', '.join(_COLUMNS)}, got {', '.join(words)[:80]}", line)
    return [named.index(name) for name in _COLUMNS]


def _chart(text: LensText, table: DoubleArray) -> MtfChart:
    contrast = table[:, 2:]
    if contrast.max() > 1:
        contrast = contrast / 100
    if contrast.max() > 1:
        raise text.error(f"contrast is at most 1, or 100 %, got {100 * contrast.max():g}")
    heights, rows = np.unique(table[:, 0], return_inverse=True)
    if len(heights) > _MAX_HEIGHTS:
        raise text.error(f"a chart has at most {_MAX_HEIGHTS} image heights, got {len(heights)}")
    return MtfChart(heights, rows.astype(np.int64), table[:, 1], contrast)
