"""Focus curves in OpenTimelineIO, for editorial: a clip as long as the curve, a marker for each time that something is sharp.

A timeline with one video track and one clip of missing media, as only the shot's own frames are known. Its source range counts
frames at the shot's rate. The markers are named after what is sharp over their range, and are green where focus points decide,
yellow where the camera's own focus is kept and nothing is sharp, and red where the lens could not do what was asked. The whole
curve stands in the clip's metadata as ``pullfocus.focusCurve``, as `render.focus.files.json_file` writes it, and is read from
there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby
from typing import Any

import opentimelineio as otio
from opentimelineio.opentime import RationalTime, TimeRange

from render.errors import InputError
from render.focus.curve import FocusCurve
from render.focus.files.json_file import curve_to_dict, load_json, rows_of_dict
from render.focus.files.rows import Rows

NAMESPACE = "pullfocus"
KEY = "focusCurve"

_NOTHING_SHARP = "nothing sharp"


def curve_to_otio(curve: FocusCurve) -> str:
    """A focus curve as OpenTimelineIO's JSON text (see the head of this module).

    Args:
        curve: the curve.
    """
    name = curve.camera.rpartition("/")[2] or "camera"
    clip = otio.schema.Clip(
        name=name,
        source_range=_range(curve, 0, len(curve.time_codes)),
        metadata={NAMESPACE: {KEY: curve_to_dict(curve)}},
    )
    clip.markers.extend(_markers(curve))
    track = otio.schema.Track(name="focus", kind=otio.schema.TrackKind.Video, children=[clip])
    timeline = otio.schema.Timeline(name=f"focus of {name}", tracks=[track])
    return f"{otio.core.serialize_json_to_string(timeline, indent=2)}\n"


def rows_of_otio(text: str) -> Rows:
    """Take the first focus curve out of a timeline.

    Args:
        text: OpenTimelineIO's JSON.

    Raises:
        InputError: the text is not OTIO, or no clip in it has a focus curve.
    """
    # Not by the library, whose reader goes as deep as a file is nested, beyond the end of the stack.
    root = load_json(text)
    curves = [curve for clip in _clips(root) if (curve := _curve_of(clip)) is not None]
    if not curves:
        raise InputError(f"no clip of the timeline has a focus curve ({NAMESPACE}.{KEY})", code="bad_curve")
    return rows_of_dict(curves[0], "the clip's focus curve")


def _clips(value: Any) -> Iterator[dict[str, Any]]:
    """All clips, in the order of the file."""
    waiting = [value]
    while waiting:
        value = waiting.pop()
        if isinstance(value, dict):
            if str(value.get("OTIO_SCHEMA", "")).startswith("Clip."):
                yield value
            waiting += reversed(value.values())
        elif isinstance(value, list):
            waiting += reversed(value)


def _curve_of(clip: dict[str, Any]) -> Any:
    for name in ("metadata", NAMESPACE, KEY):
        if not isinstance(clip, dict):
            return None
        clip = clip.get(name, {})
    return clip or None


def _markers(curve: FocusCurve) -> Iterator[otio.schema.Marker]:
    """One for each run of frames over which the same points are sharp and the lens is limited or not."""
    keys = [(curve.sharp_points(i), curve.sources[i], bool(curve.limited[i])) for i in range(len(curve.time_codes))]
    for (sharp, source, limited), run in groupby(range(len(keys)), key=keys.__getitem__):
        frames = list(run)
        first, last = frames[0], frames[-1]
        yield otio.schema.Marker(
            name=f"sharp: {', '.join(sharp)}" if sharp else _NOTHING_SHARP,
            marked_range=_range(curve, first, len(frames)),
            color=_color(bool(sharp), source, limited),
            metadata={
                NAMESPACE: {
                    "sharp": list(sharp),
                    "source": source,
                    "limited": limited,
                    "focusDistanceM": [_finite(curve.focus_distance_m[i]) for i in (first, last)],
                    "fStop": [_finite(curve.f_stop[i]) for i in (first, last)],
                }
            },
            comment=curve.reasons[first],
        )


def _color(is_sharp: bool, source: str, limited: bool) -> str:
    colors = otio.schema.MarkerColor
    if limited:
        return str(colors.RED)
    return str(colors.GREEN if is_sharp or source == "points" else colors.YELLOW)


def _range(curve: FocusCurve, first: int, count: int) -> TimeRange:
    """The range of some frames of a curve, each of which lasts until the next; the last one lasts one frame."""
    frames, rate = curve.frames, curve.frames_per_second
    start, beyond = frames[first], first + count
    end = frames[beyond] if beyond < len(frames) else frames[-1] + 1
    return TimeRange(RationalTime(float(start), rate), RationalTime(float(end - start), rate))


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
