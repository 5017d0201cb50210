"""Focus curves as JSON, for programs.

Version 2. Keys are camelCase; lengths end in their unit, and angles in degrees. JSON has no infinity, so ``null`` stands for an
infinite ``focusDistanceM`` or ``farM``, and for a ``depthM`` or ``cocMm`` that does not exist (a point without a place,
or behind the camera; its ``state`` says which). In a curve that came from a tool which knows no depth of field, ``nearM`` is
``null``, and then so are ``farM``, ``hyperfocalM`` and, where it is not known either, ``cocLimitMm``::

    {"format": "pullfocus.focusCurve", "version": 2, "camera": "/World/cam", "lens": "Summicron", "gateMm": [36.0, 20.25],
     "framesPerSecond": 24.0, "timeCodesPerSecond": 24.0,
     "samples": [{"frame": 1.0, "timeCode": 1.0, "seconds": 0.0417,
                  "focusDistanceM": 2.5, "fStop": 2.0, "focalLengthMm": 50.0,
                  "nearM": 2.4, "farM": 2.6, "hyperfocalM": 43.3, "cocLimitMm": 0.0289,
                  "tiltDeg": 0.0, "swingDeg": 0.0, "limited": false,
                  "source": "points", "reason": "focused by hero", "sharp": ["hero"],
                  "points": [{"name": "hero", "state": "used", "depthM": 2.5, "weight": 1.0, "share": 1.0,
                              "cocMm": 0.0}]}]}

Version 1, which is read too, has no ``lens``, ``gateMm``, ``tiltDeg``, ``swingDeg`` and ``limited``.
"""

from __future__ import annotations

import json
import math
from typing import Any

from render.errors import InputError
from render.focus.curve import FocusCurve, PointTrack
from render.focus.files.columns import COLUMNS, FOCUS_DISTANCE, POINT_COLUMNS, Column
from render.focus.files.rows import (
    LEAST_RATE,
    MOST_RATE,
    BadRowError,
    PointCell,
    Rates,
    Row,
    Rows,
    are_rates,
    given_numbers,
    json_number,
    known_state,
    quote_value,
)

FORMAT = "pullfocus.focusCurve"
VERSION = 2
READ_VERSIONS = (1, 2)

_INFINITE_IF_NULL = ("focusDistanceM", "farM")


def curve_to_json(curve: FocusCurve, *, indent: int | None = 2) -> str:
    """A focus curve as JSON text (see the head of this module).

    Args:
        curve: the curve.
        indent: spaces for each level, or None for one line.
    """
    return json.dumps(curve_to_dict(curve), indent=indent, allow_nan=False) + "\n"


def curve_to_dict(curve: FocusCurve) -> dict[str, Any]:
    """A focus curve as plain JSON values (see the head of this module).

    Args:
        curve: the curve.
    """
    return {
        "format": FORMAT,
        "version": VERSION,
        "camera": curve.camera,
        "lens": curve.lens_name,
        "gateMm": None if curve.gate_mm is None else list(curve.gate_mm),
        "framesPerSecond": curve.frames_per_second,
        "timeCodesPerSecond": curve.time_codes_per_second,
        "samples": [sample_to_dict(curve, index) for index in range(len(curve.time_codes))],
    }


def sample_to_dict(curve: FocusCurve, index: int) -> dict[str, Any]:
    """One frame of a curve as plain JSON values.

    Args:
        curve: the curve.
        index: of the frame in the columns.
    """
    return {
        "frame": float(curve.frames[index]),
        "timeCode": float(curve.time_codes[index]),
        "seconds": float(curve.seconds[index]),
        **{column.json: _finite(getattr(curve, column.attribute)[index] / column.factor) for column in COLUMNS},
        "limited": bool(curve.limited[index]),
        "source": curve.sources[index],
        "reason": curve.reasons[index],
        "sharp": list(curve.sharp_points(index)),
        "points": [_point(point, index) for point in curve.points],
    }


def rows_of_json(text: str) -> Rows:
    """Take a JSON file apart.

    Args:
        text: its content.

    Raises:
        InputError: it is no JSON, or no focus curve of a version that is known.
    """
    return rows_of_dict(load_json(text), "the JSON")


def rows_of_dict(data: Any, what: str) -> Rows:
    """Take plain JSON values apart.

    Args:
        data: as `curve_to_dict` gives them.
        what: source of the data, for messages.

    Raises:
        InputError: they are no focus curve of a version that is known.
    """
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(
            f'{what} is no focus curve: it must be an object whose "format" is "{FORMAT}"', code="bad_curve"
        )
    if data.get("version") not in READ_VERSIONS:
        known = " and ".join(map(str, READ_VERSIONS))
        raise InputError(f"{what} has version {quote_value(data.get('version'))}, read are {known}", code="bad_curve")
    samples = data.get("samples")
    if not isinstance(samples, list):
        raise InputError(f'{what} must have a list of "samples", but it has {quote_value(samples)}', code="bad_curve")
    try:
        rates = rates_of(data)
        gate_mm = _gate(data.get("gateMm"))
    except BadRowError as error:
        raise InputError(f"{what}: {error}", code="bad_curve") from error
    rows = tuple(_row(sample, f"sample {number}") for number, sample in enumerate(samples, 1))
    return Rows(what, rates, rows, str(data.get("camera", "")), str(data.get("lens", "")), gate_mm)


def rates_of(data: dict[str, Any]) -> Rates:
    """Frame rate and time-code rate of a file, or of a sample of one.

    Raises:
        BadRowError: a rate is missing or out of range.
    """
    rates = [json_number(data.get(name), name) for name in ("framesPerSecond", "timeCodesPerSecond")]
    if not are_rates(*rates):
        raise BadRowError(
            f"framesPerSecond and timeCodesPerSecond must be from {LEAST_RATE:g} to {MOST_RATE:g}, but they are {rates[0]:g} "
            f"and {rates[1]:g}"
        )
    return Rates(*rates)


def numbers_of(sample: dict[str, Any]) -> dict[str, float]:
    """The numbers of one sample, by the names of `FocusCurve`'s columns.

    Raises:
        BadRowError: one is no number, or there is no focus distance.
    """
    if FOCUS_DISTANCE.json not in sample:
        raise BadRowError(f"there is no {FOCUS_DISTANCE.json}")
    numbers = {column.attribute: _number(sample, column) for column in COLUMNS if column.json in sample}
    if math.isnan(numbers.get("near_m", 0.0)):
        numbers["far_m"] = math.nan
    return given_numbers(numbers)


def points_of(sample: dict[str, Any]) -> dict[str, PointCell]:
    """The focus points of one sample by name.

    Raises:
        BadRowError: they are no list of points.
    """
    points = sample.get("points", [])
    if not isinstance(points, list) or not all(isinstance(p, dict) and isinstance(p.get("name"), str) for p in points):
        raise BadRowError(f"points must be a list of points with names, but it is {quote_value(points)}")
    return {point["name"]: _cell(point) for point in points}


def load_json(text: str) -> Any:
    """Parse a JSON text.

    Raises:
        InputError: the text is not valid JSON; NaN and infinity are not valid either.
    """

    def refused(constant: str) -> None:
        raise InputError(f"the file is no JSON: it has {constant}, which JSON does not know", code="bad_curve")

    try:
        return json.loads(text, parse_constant=refused)
    except (ValueError, RecursionError) as error:
        raise InputError(f"the file is no JSON: {error}", code="bad_curve") from error


def _row(sample: Any, place: str) -> Row:
    time_code = math.nan
    try:
        if not isinstance(sample, dict):
            raise BadRowError(f"expected an object, got {quote_value(sample)}")
        time_code = json_number(sample.get("timeCode"), "timeCode")
        return Row(
            place=place,
            time_code=time_code,
            numbers=numbers_of(sample),
            limited=bool(sample.get("limited", False)),
            source=str(sample.get("source", "camera")),
            reason=str(sample.get("reason", "")),
            points=points_of(sample),
        )
    except BadRowError as error:
        return Row(place, time_code, problem=str(error))


def _number(sample: dict[str, Any], column: Column) -> float:
    value = sample[column.json]
    if value is None:
        return math.inf if column.json in _INFINITE_IF_NULL else math.nan
    return json_number(value, column.json) * column.factor


def _cell(point: dict[str, Any]) -> PointCell:
    numbers = {
        column.attribute: math.nan
        if point.get(column.json) is None
        else json_number(point[column.json], f"{column.json} of {point['name']}")
        for column in POINT_COLUMNS
    }
    return PointCell(known_state(point.get("state")), **numbers)


def _gate(value: Any) -> tuple[float, float] | None:
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 2:
        raise BadRowError(f"gateMm must be a width and a height, but it is {quote_value(value)}")
    return json_number(value[0], "gateMm"), json_number(value[1], "gateMm")


def _point(point: PointTrack, index: int) -> dict[str, Any]:
    numbers = {column.json: _finite(getattr(point, column.attribute)[index]) for column in POINT_COLUMNS}
    return {"name": point.name, "state": point.states[index], **numbers}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
