"""Focus curves as files: JSON for programs, CSV for spreadsheets.

JSON, version 1. Keys are camelCase; lengths end in their unit. JSON has no infinity, so ``null`` stands for an
infinite ``focusDistanceM`` or ``farM``, and for a ``depthM`` or ``cocMm`` that does not exist (a point without a place,
or behind the camera; its ``state`` says which)::

    {"format": "pullfocus.focusCurve", "version": 1, "camera": "/World/cam",
     "framesPerSecond": 24.0, "timeCodesPerSecond": 24.0,
     "samples": [{"frame": 1.0, "timeCode": 1.0, "seconds": 0.0417,
                  "focusDistanceM": 2.5, "fStop": 2.0, "focalLengthMm": 50.0,
                  "nearM": 2.4, "farM": 2.6, "hyperfocalM": 43.3, "cocLimitMm": 0.0289,
                  "source": "points", "reason": "focused by hero", "sharp": ["hero"],
                  "points": [{"name": "hero", "state": "used", "depthM": 2.5, "weight": 1.0, "share": 1.0,
                              "cocMm": 0.0}]}]}

CSV: one row for each frame under a header, ``inf`` for infinity, an empty cell for what does not exist; after the lens
columns come five for each focus point, named ``<point>.state``, ``<point>.depth_m`` and so on.
"""

from __future__ import annotations

import csv
import io
import json
import math
from typing import Any

from render.focus.curve import LENS_COLUMNS, FocusCurve, PointTrack

FORMAT = "pullfocus.focusCurve"
VERSION = 1

_POINT_COLUMNS = ("depth_m", "weight", "share", "coc_mm")


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
        "framesPerSecond": curve.frames_per_second,
        "timeCodesPerSecond": curve.time_codes_per_second,
        "samples": [_sample(curve, index) for index in range(len(curve.time_codes))],
    }


def curve_to_csv(curve: FocusCurve) -> str:
    """A focus curve as CSV text with a header row (see the head of this module; line ends are CR LF, as RFC 4180).

    Args:
        curve: the curve.
    """
    text = io.StringIO()
    writer = csv.writer(text)
    point_columns = [f"{p.name}.{column}" for p in curve.points for column in ("state", *_POINT_COLUMNS)]
    writer.writerow(["frame", "time_code", "seconds", *LENS_COLUMNS, "source", "sharp", *point_columns])
    for index in range(len(curve.time_codes)):
        times = (curve.frames[index], curve.time_codes[index], curve.seconds[index])
        lens = (getattr(curve, name)[index] for name in LENS_COLUMNS)
        points = (
            cell
            for point in curve.points
            for cell in (point.states[index], *(_cell(getattr(point, name)[index]) for name in _POINT_COLUMNS))
        )
        whose = (curve.sources[index], " ".join(curve.sharp_points(index)))
        writer.writerow([*map(_cell, times), *map(_cell, lens), *whose, *points])
    return text.getvalue()


def _sample(curve: FocusCurve, index: int) -> dict[str, Any]:
    return {
        "frame": float(curve.frames[index]),
        "timeCode": float(curve.time_codes[index]),
        "seconds": float(curve.seconds[index]),
        **{_camel(name): _finite(getattr(curve, name)[index]) for name in LENS_COLUMNS},
        "source": curve.sources[index],
        "reason": curve.reasons[index],
        "sharp": list(curve.sharp_points(index)),
        "points": [_point(point, index) for point in curve.points],
    }


def _point(point: PointTrack, index: int) -> dict[str, Any]:
    numbers = {_camel(name): _finite(getattr(point, name)[index]) for name in _POINT_COLUMNS}
    return {"name": point.name, "state": point.states[index], **numbers}


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _cell(value: float) -> str:
    return "" if math.isnan(value) else repr(float(value))


def _camel(name: str) -> str:
    head, *rest = name.split("_")
    return head + "".join(word.capitalize() for word in rest)
