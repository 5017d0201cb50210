"""Focus curves as CSV, for spreadsheets and for tools that read nothing else.

Written: one row for each frame under a header, ``inf`` for infinity, an empty cell for what does not exist; after the lens
columns come five for each focus point, named ``<point>.state``, ``<point>.depth_m`` and so on. Line ends are CR LF (RFC 4180).

Read: that, and less of it. A header row is needed, with one column of time (``frame``, ``time_code`` or ``seconds``) and
``focus_distance_m``. Case, spaces and brackets do not matter (``Focus Distance (m)``), and other units are named by the ending:
``_m``, ``_cm``, ``_mm``, ``_ft`` or ``_in`` for distances, ``_deg`` or ``_rad`` for angles. Semicolons or tabs may stand in
place of commas, as spreadsheets write them where the comma is the decimal point. Unknown columns are reported and ignored.
"""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from render.errors import InputError
from render.focus.curve import FocusCurve
from render.focus.files.columns import COLUMNS, FOCAL_LENGTH, FOCUS_DISTANCE, POINT_COLUMNS, Column
from render.focus.files.rows import BadRowError, PointCell, Rates, Row, Rows, are_rates, known_state, quote_value
from render.focus.files.timing import snapped_rate

TIMES = ("frame", "time_code", "seconds")
_WORDS = ("limited", "source", "reason", "sharp")
_BLANK = ("", "nan", "none", "null", "-")
_TRUE, _FALSE = ("true", "1", "yes"), ("false", "0", "no", "")
_NEED_UNITS = (FOCUS_DISTANCE.stem, FOCAL_LENGTH.stem)
_WHAT = "the CSV"


def curve_to_csv(curve: FocusCurve) -> str:
    """A focus curve as CSV text with a header row (see the head of this module).

    Args:
        curve: the curve.
    """
    text = io.StringIO()
    writer = csv.writer(text)
    point_columns = [f"{p.name}.{name}" for p in curve.points for name in ("state", *(c.csv for c in POINT_COLUMNS))]
    writer.writerow([*TIMES, *(column.csv for column in COLUMNS), *_WORDS, *point_columns])
    for index in range(len(curve.time_codes)):
        times = (curve.frames[index], curve.time_codes[index], curve.seconds[index])
        lens = (getattr(curve, column.attribute)[index] / column.factor for column in COLUMNS)
        words = (
            str(bool(curve.limited[index])).lower(),
            curve.sources[index],
            curve.reasons[index],
            " ".join(curve.sharp_points(index)),
        )
        points = (
            cell
            for point in curve.points
            for cell in (point.states[index], *(_cell(getattr(point, c.attribute)[index]) for c in POINT_COLUMNS))
        )
        writer.writerow([*map(_cell, times), *map(_cell, lens), *words, *points])
    return text.getvalue()


def rows_of_csv(text: str, rates: Rates) -> Rows:
    """Take a CSV apart.

    Args:
        text: its content.
        rates: rates where the file does not give them by two columns of time.

    Raises:
        InputError: there is no header, no time or no focus distance in it, or a column's unit is missing or unknown.
    """
    delimiter = _delimiter(text)
    lines = _lines(text, delimiter)
    if not lines:
        raise InputError(f"{_WHAT} is empty", code="bad_curve")
    layout = _Layout.from_header(lines[0][1])
    body = [(number, cells) for number, cells in lines[1:] if any(cell.strip() for cell in cells)]
    comma = delimiter != ","
    own = _own_rates(layout, [cells for _, cells in body], comma)
    rows = tuple(_row(layout, number, cells, own or rates, comma) for number, cells in body)
    return Rows(_WHAT, own or rates, rows, notes=layout.notes)


@dataclass(frozen=True)
class _Layout:
    """Which cell is what.

    Attributes:
        width: number of cells in a row.
        times: index of each column of time that there is.
        numbers: index, column and factor of each column of numbers.
        words: index of each column of words that there is.
        points: for each focus point, its columns' indices by name.
        notes: about columns that are not used.
    """

    width: int
    times: dict[str, int]
    numbers: tuple[tuple[int, Column, float], ...]
    words: dict[str, int]
    points: dict[str, dict[str, int]]
    notes: tuple[str, ...]

    @classmethod
    def from_header(cls, header: Sequence[str]) -> _Layout:
        """Read a header."""
        times: dict[str, int] = {}
        words: dict[str, int] = {}
        points: dict[str, dict[str, int]] = {}
        numbers: list[tuple[int, Column, float]] = []
        unused = []
        for index, title in enumerate(header):
            name = _plain(title)
            point, _, part = title.strip().rpartition(".")
            found = _numbers_column(name)
            if point and part in ("state", *(c.csv for c in POINT_COLUMNS)):
                points.setdefault(point, {})[part] = index
            elif name in TIMES:
                times.setdefault(name, index)
            elif name in _WORDS:
                words.setdefault(name, index)
            elif found is not None and all(column is not found[0] for _, column, _ in numbers):
                numbers.append((index, *found))
            elif title.strip():
                unused.append(title.strip())
        if not times:
            raise InputError(f"{_WHAT} needs a column of time: {', '.join(TIMES)}", code="bad_curve")
        if all(column is not FOCUS_DISTANCE for _, column, _ in numbers):
            raise InputError(f"{_WHAT} needs a column {FOCUS_DISTANCE.csv}", code="bad_curve")
        points = {name: parts for name, parts in points.items() if len(parts) == 1 + len(POINT_COLUMNS)}
        notes = (f"columns that are not used: {', '.join(unused)}",) if unused else ()
        return cls(len(header), times, tuple(numbers), words, points, notes)


def _numbers_column(name: str) -> tuple[Column, float] | None:
    """Column of a title, and the factor on its numbers; None for an unknown title."""
    for column in COLUMNS:
        if not column.units:
            if name == column.stem:
                return column, 1.0
            continue
        units = dict(column.units)
        stem, _, unit = name.rpartition("_")
        if stem == column.stem and unit in units:
            return column, units[unit]
        if (name in _NEED_UNITS and name == column.stem) or (column is FOCUS_DISTANCE and stem == column.stem):
            known = ", ".join(f"{column.stem}_{unit}" for unit in units)
            raise InputError(f"{_WHAT} has a column {name!r} in no known unit: name it {known}", code="bad_units")
    return None


def _row(layout: _Layout, number: int, cells: Sequence[str], rates: Rates, comma: bool) -> Row:
    place, time_code = f"row {number}", math.nan
    try:
        if len(cells) != layout.width:
            raise BadRowError(f"it has {len(cells)} cells, but the header has {layout.width}")
        time_code = _time_code(layout, cells, rates, comma)
        numbers = {}
        for index, column, factor in layout.numbers:
            if cells[index].strip().lower() in _BLANK and not column.drives:
                continue
            numbers[column.attribute] = _number(cells[index], column.csv, comma) * factor
        words = {name: cells[index] for name, index in layout.words.items()}
        return Row(
            place=place,
            time_code=time_code,
            numbers=numbers,
            limited=_truth(words.get("limited", "")),
            source=words.get("source", "camera"),
            reason=words.get("reason", ""),
            points={name: _point(cells, name, parts, comma) for name, parts in layout.points.items()},
        )
    except BadRowError as error:
        return Row(place, time_code, problem=str(error))


def _time_code(layout: _Layout, cells: Sequence[str], rates: Rates, comma: bool) -> float:
    to_time_codes = {
        "time_code": 1.0,
        "frame": rates.time_codes_per_frame,
        "seconds": rates.time_codes_per_second,
    }
    name = next(name for name in to_time_codes if name in layout.times)
    time = _number(cells[layout.times[name]], name, comma)
    if not math.isfinite(time):
        raise BadRowError(f"{name} must be finite, but it is {time}")
    return time * to_time_codes[name]


def _point(cells: Sequence[str], name: str, parts: dict[str, int], comma: bool) -> PointCell:
    numbers = {}
    for column in POINT_COLUMNS:
        cell = cells[parts[column.csv]]
        blank = cell.strip().lower() in _BLANK
        numbers[column.attribute] = math.nan if blank else _number(cell, f"{name}.{column.csv}", comma)
    return PointCell(known_state(cells[parts["state"]].strip()), **numbers)


def _own_rates(layout: _Layout, body: Sequence[Sequence[str]], comma: bool) -> Rates | None:
    """The rates that a file with three columns of time shows, from its rows farthest apart."""
    if set(layout.times) != set(TIMES):
        return None
    times = []
    for cells in body:
        try:
            times.append([_number(cells[layout.times[name]], name, comma) for name in TIMES])
        except (BadRowError, IndexError):
            continue
    times = [row for row in times if all(map(math.isfinite, row))]
    if not times:
        return None
    first, last = times[0] if len(times) > 1 else [0.0, 0.0, 0.0], times[-1]
    frames, time_codes, seconds = (end - start for start, end in zip(first, last, strict=True))
    if not (frames > 0 and time_codes > 0 and seconds > 0 and are_rates(frames / seconds, time_codes / seconds)):
        return None
    return Rates(snapped_rate(frames / seconds), snapped_rate(time_codes / seconds))


def _number(cell: str, name: str, comma: bool) -> float:
    text = cell.strip()
    try:
        return float(text.replace(",", ".") if comma else text)
    except ValueError:
        raise BadRowError(f"{name} must be a number, but it is {quote_value(cell) if text else 'empty'}") from None


def _truth(cell: str) -> bool:
    word = cell.strip().lower()
    if word not in (*_TRUE, *_FALSE):
        raise BadRowError(f"limited must be true or false, but it is {quote_value(cell)}")
    return word in _TRUE


def _lines(text: str, delimiter: str) -> list[tuple[int, list[str]]]:
    """The lines with cells, and where in the file each ends, counted from 1."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, strict=True)
    try:
        return [(reader.line_num, cells) for cells in reader if cells]
    except csv.Error as error:
        raise InputError(f"{_WHAT} cannot be read at line {reader.line_num}: {error}", code="bad_curve") from error


def _delimiter(text: str) -> str:
    header = text.lstrip().partition("\n")[0]
    return next((mark for mark in ("\t", ";") if mark in header), ",")


def _plain(title: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", title.strip().lower()).strip("_")


def _cell(value: float) -> str:
    return "" if math.isnan(value) else repr(float(value))
