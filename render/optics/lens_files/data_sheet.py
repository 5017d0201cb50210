"""Reads and writes `.lens` files: a lens by its data sheet, in a format of our own that people can type (docs/guide/lenses.md).

    # Lines of `name = value` first, then one table or more; what follows a # is a remark.
    name         = Zeiss Planar T* 1.4/50
    focal length = 50               # mm
    f-stops      = 1.4 16           # wide open and closed down
    close focus  = 0.45             # m, from the film
    measured at  = 1.4              # the f-number of the tables
    source       = read off the maker's sheet

    height_mm  distortion_%  light_%  sagittal_blur_um  tangential_blur_um
    0          0             100      8                 8
    21.6       -1.5          40       14                21

Each table begins with the names of its columns, the first of which is height_mm, and ends with an empty line or the file. Tables
may have heights of their own, as they are read off one curve after another.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from render.errors import SettingsError
from render.model.data_sheet import MAX_F_STOP, DataSheet
from render.optics.data_sheet import at_heights
from render.optics.lens_files.lens_text import LensText

SUFFIX = ".lens"
_COLUMNS = {
    "distortion_%": ("distortion", 0.01),
    "light_%": ("light", 0.01),
    "sagittal_blur_um": ("sagittal_blur_mm", 0.001),
    "tangential_blur_um": ("tangential_blur_mm", 0.001),
    "spherical": ("spherical", 1.0),
    "coma_um": ("coma_mm", 0.001),
    "field_curvature_mm": ("field_curvature_mm", 1.0),
    "lateral_color_um": ("lateral_color_mm", 0.001),
    "axial_color_mm": ("axial_color_mm", 1.0),
}
_HEIGHT = "height_mm"
_KEYS = ("name", "focal length", "f-stops", "close focus", "measured at", "source")
_MAX_ROWS = 1000
_MAX_CLOSE_FOCUS_M = 1000.0  # the longest telescopes focus nearer

Table = dict[str, list[float]]


@dataclass(frozen=True)
class MeasuredLens:
    """A lens by its data sheet.

    Attributes:
        name: for people.
        focal_length_mm: of the lens.
        sheet: what was measured of it.
        f_stops: wide open, and closed down as far as it goes; 0 where that end is unknown.
        close_focus_m: nearest distance from the film that is marked on it; 0 where none is.
        sources: where the numbers are from, one sentence each.
    """

    name: str
    focal_length_mm: float
    sheet: DataSheet
    f_stops: tuple[float, float] = (0.0, 0.0)
    close_focus_m: float = 0.0
    sources: tuple[str, ...] = ()


def read_data_sheet(text: LensText) -> MeasuredLens:
    """The lens of a `.lens` file.

    Raises:
        InputError: it is no such file, or no lens has such numbers; the message names the line.
    """
    entries: dict[str, tuple[int, str]] = {}
    tables: list[Table] = []
    sources: list[str] = []
    table: Table | None = None
    for line, raw in enumerate(text.lines, 1):
        words = raw.partition("#")[0].split()
        if not words:
            table = None if not raw.strip() else table
        elif words[0] == _HEIGHT:
            table = _begin_table(text, line, words)
            tables.append(table)
        elif table is not None:
            _add_row(text, line, words, table)
        else:
            name, value = _pair(text, line, raw)
            if name == "source":
                sources.append(value)
            elif name in entries:
                raise text.error(f"{name} was said already on line {entries[name][0]}", line)
            else:
                entries[name] = line, value
    return _lens(text, entries, tables, tuple(sources))


def data_sheet_text(lens: MeasuredLens) -> str:
    """The `.lens` file of a lens; to be read again it loses nothing but digits beyond the seventh."""
    sheet, numbers = lens.sheet, [("focal length", lens.focal_length_mm, "mm")]
    numbers += [("close focus", lens.close_focus_m, "m, from the film")] if lens.close_focus_m else []
    numbers += [("measured at", sheet.f_stop, "the f-number of the tables")] if sheet.f_stop else []
    lines = [f"name = {lens.name}"]
    lines += [f"{name} = {value:.7g}  # {unit}" for name, value, unit in numbers]
    if any(lens.f_stops):
        lines.append("f-stops = {:.7g} {:.7g}  # wide open and closed down".format(*lens.f_stops))
    lines += [f"source = {source}" for source in lens.sources]
    columns = [(_HEIGHT, np.array(sheet.heights_mm))]
    for column, (field, unit) in _COLUMNS.items():
        if values := getattr(sheet, field):
            columns.append((column, np.array(values) / unit))
    texts = [[name, *(f"{value + 0.0:.7g}" for value in values)] for name, values in columns]
    widths = [max(map(len, column)) for column in texts]
    lines.append("")
    for row in zip(*texts, strict=True):
        lines.append("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    return "\n".join(lines) + "\n"


def _pair(text: LensText, line: int, raw: str) -> tuple[str, str]:
    name, found, value = raw.partition("=")
    name = " ".join(name.lower().split())
    remark = " # " if name in ("name", "source") else "#"  # in words a #1 may stand
    value = value.partition(remark)[0]
    if not found or name not in _KEYS:
        raise text.error(
            f"expected one of {', '.join(_KEYS)} with = behind it, or a table that begins with {_HEIGHT},"
            f" got {raw.strip()[:40]!r}",
            line,
        )
    if not value.strip():
        raise text.error(f"{name} has nothing behind the =", line)
    return name, value.strip()


def _begin_table(text: LensText, line: int, words: list[str]) -> Table:
    for word in words[1:]:
        if word not in _COLUMNS:
            raise text.error(f"there is no column {word!r}: expected {', '.join(_COLUMNS)}", line)
    if len(set(words)) < len(words) or len(words) < 2:
        raise text.error("a table has height_mm and each other column once, and at least one", line)
    return {word: [] for word in words}


def _add_row(text: LensText, line: int, words: list[str], table: Table) -> None:
    if len(words) != len(table):
        raise text.error(f"a row of this table has {len(table)} numbers, got {len(words)} words", line)
    if len(table[_HEIGHT]) >= _MAX_ROWS:
        raise text.error(f"a table has at most {_MAX_ROWS} rows", line)
    for (name, values), word in zip(table.items(), words, strict=True):
        values.append(text.number(word, name, line))


def _lens(
    text: LensText, entries: dict[str, tuple[int, str]], tables: list[Table], sources: tuple[str, ...]
) -> MeasuredLens:
    def numbers(name: str, count: int = 1) -> list[float]:
        if name not in entries:
            return [0.0] * count
        line, value = entries[name]
        words = value.split()
        if len(words) != count:
            raise text.error(f"{name} takes {count} numbers, got {value!r}", line)
        return [text.number(word, name, line, at_least=0) for word in words]

    if "focal length" not in entries or not tables:
        missing = "focal length" if "focal length" not in entries else f"table that begins with {_HEIGHT}"
        raise text.error(f"it has no {missing}")
    (focal,) = numbers("focal length")
    if not 0.1 <= focal <= 1e5:
        raise text.error(f"the focal length must be from 0.1 to 100000 mm, got {focal:g}", entries["focal length"][0])
    widest, closed = numbers("f-stops", 2)
    if 0 < closed < widest or max(widest, closed) > MAX_F_STOP:
        raise text.error(
            f"f-stops go from wide open to closed down, 0 for an end that is unknown and {MAX_F_STOP:g} at most, "
            f"got {widest:g} and {closed:g}",
            entries["f-stops"][0],
        )
    (measured_at,), (close_focus,) = numbers("measured at"), numbers("close focus")
    if close_focus > _MAX_CLOSE_FOCUS_M:
        line = entries["close focus"][0]
        raise text.error(f"the close focus must be at most {_MAX_CLOSE_FOCUS_M:g} m, got {close_focus:g}", line)
    try:
        sheet = _join_tables(text, tables, measured_at or widest)
    except SettingsError as error:
        raise text.error(error.detail) from error
    name = entries["name"][1] if "name" in entries else text.name.rsplit(".", 1)[0]
    return MeasuredLens(name, focal, sheet, (widest, closed), close_focus, sources)


def _join_tables(text: LensText, tables: list[Table], f_stop: float) -> DataSheet:
    """One sheet of all tables, over all of their heights."""
    parts: list[DataSheet] = []
    for table in tables:
        fields: dict[str, Any] = {
            _COLUMNS[name][0]: tuple(_COLUMNS[name][1] * value for value in values)
            for name, values in _given_columns(table)
        }
        if any(name in fields for part in parts for name in _fields_of(part)):
            raise text.error("two tables have the same column")
        parts.append(DataSheet(tuple(table[_HEIGHT]), **fields))
    if len(parts) == 1:
        return DataSheet(**(vars(parts[0]) | {"f_stop": f_stop}))
    heights = np.unique(np.concatenate([part.heights_mm for part in parts]))
    fields = {name: tuple(at_heights(part, name, heights).tolist()) for part in parts for name in _fields_of(part)}
    return DataSheet(tuple(heights.tolist()), **fields, f_stop=f_stop)


def _given_columns(table: Table) -> Iterator[tuple[str, list[float]]]:
    return ((name, values) for name, values in table.items() if name != _HEIGHT)


def _fields_of(sheet: DataSheet) -> list[str]:
    return [field for field, _ in _COLUMNS.values() if getattr(sheet, field)]
