"""Focus curves as files, written and read: JSON for programs, CSV for spreadsheets, OpenTimelineIO for editorial and
OpenTrackIO for tools of the set.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, get_args

from render.errors import InputError, SettingsError
from render.focus.curve import FocusCurve
from render.focus.files.assembly import GAPS, CurveFinding, Gaps, ReadCurve, assemble_curve
from render.focus.files.csv_file import curve_to_csv, rows_of_csv
from render.focus.files.json_file import FORMAT, curve_to_dict, curve_to_json, rows_of_json
from render.focus.files.opentrackio_file import curve_to_opentrackio
from render.focus.files.opentrackio_rows import rows_of_opentrackio
from render.focus.files.rows import Rates, Rows

__all__ = [
    "FORMATS",
    "GAPS",
    "MEDIA_TYPES",
    "CurveFinding",
    "CurveFormat",
    "Gaps",
    "Rates",
    "ReadCurve",
    "curve_to_csv",
    "curve_to_dict",
    "curve_to_json",
    "curve_to_text",
    "read_curve",
    "retime",
]

CurveFormat = Literal["json", "csv", "otio", "opentrackio"]
FORMATS: tuple[CurveFormat, ...] = get_args(CurveFormat)
MEDIA_TYPES: dict[CurveFormat, str] = {
    "json": "application/json",
    "csv": "text/csv; charset=utf-8",
    "otio": "application/json",
    "opentrackio": "application/json",
}


def curve_to_text(curve: FocusCurve, format: CurveFormat) -> str:
    """A focus curve as the text of a file.

    Args:
        curve: the curve.
        format: which kind of file.

    Raises:
        SettingsError: there is no such format.
    """
    writers: dict[CurveFormat, Callable[[FocusCurve], str]] = {
        "json": curve_to_json,
        "csv": curve_to_csv,
        "otio": _curve_to_otio,
        "opentrackio": curve_to_opentrackio,
    }
    return writers[_check_format(format)](curve)


def read_curve(
    content: bytes | str, rates: Rates, *, format: CurveFormat | None = None, gaps: Gaps = "refuse"
) -> ReadCurve:
    """Read a focus curve from the content of a file.

    Args:
        content: UTF-8.
        rates: rates where the file gives none, such as the shot's.
        format: which kind of file it is; None looks at it.
        gaps: whether rows that are missing or cannot be used are refused, held or interpolated; see
            `render.focus.files.assembly`.

    Returns:
        The curve, in the file's own time, with what was found.

    Raises:
        InputError: it is no such file, has no row that can be used, or has gaps and these are refused.
        SettingsError: there is no such format, or no such way to treat gaps.
    """
    text = _decode(content)
    readers: dict[CurveFormat, Callable[[], Rows]] = {
        "json": lambda: rows_of_json(text),
        "csv": lambda: rows_of_csv(text, rates),
        "otio": lambda: _rows_of_otio(text),
        "opentrackio": lambda: rows_of_opentrackio(text, rates),
    }
    return assemble_curve(readers[_parse(text) if format is None else _check_format(format)](), gaps)


def retime(read: ReadCurve, rates: Rates, first_time_code: float | None = None) -> ReadCurve:
    """Convert a curve to the time of a shot. Seconds stay, as with a USD layer of another rate.

    Args:
        read: the curve.
        rates: of the shot.
        first_time_code: where its first frame comes to lie; None leaves it.

    Returns:
        The curve, with a finding where its frame rate was another.
    """
    curve, found = read.curve, read.findings
    times = curve.seconds * rates.time_codes_per_second
    if curve.time_codes_per_second == rates.time_codes_per_second:
        times = curve.time_codes  # and no rounding
    if first_time_code is not None:
        times = times + (first_time_code - times[0])
    if abs(curve.frames_per_second / rates.frames_per_second - 1) > 1e-6:
        message = (
            f"the file has {curve.frames_per_second:g} frames in a second and the shot {rates.frames_per_second:g}:"
            " its seconds are kept"
        )
        found = (*found, CurveFinding("other_rate", "", message))
    moved = replace(
        curve,
        time_codes=times,
        frames_per_second=rates.frames_per_second,
        time_codes_per_second=rates.time_codes_per_second,
    )
    return replace(read, curve=moved, findings=found)


def _check_format(format: CurveFormat) -> CurveFormat:
    if format not in FORMATS:
        raise SettingsError(f"a focus curve's format must be one of {', '.join(FORMATS)}, but it is {format!r}")
    return format


def _decode(content: bytes | str) -> str:
    if isinstance(content, str):
        return content.removeprefix("\ufeff")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"the file is no UTF-8 text: {error}", code="bad_curve") from error


def _parse(text: str) -> CurveFormat:
    """Which kind of file a text is."""
    if not text.lstrip().startswith(("{", "[")):
        return "csv"
    if "OTIO_SCHEMA" in text:
        return "otio"
    return "json" if FORMAT in text else "opentrackio"


def _curve_to_otio(curve: FocusCurve) -> str:
    # Imported where it is used: its library takes longer to load than all the rest of this package.
    from render.focus.files.otio_file import curve_to_otio

    return curve_to_otio(curve)


def _rows_of_otio(text: str) -> Rows:
    from render.focus.files.otio_file import rows_of_otio

    return rows_of_otio(text)
