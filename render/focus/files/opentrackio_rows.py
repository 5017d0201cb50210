"""Reading of OpenTrackIO samples, of any origin, as a focus curve.

Read: such an array, one sample, an object with a list ``samples``, or one sample on each line, of versions 0.9 to 1.0 (whose
older ones say ``focalLength`` for ``pinholeFocalLength`` and ``timecode.format.frameRate`` for ``timecode.frameRate``). What the
protocol's own fields say wins over ``custom.pullfocus``, as other tools change these. Time is the first of these clocks that most
samples have and that runs: ``custom.pullfocus.timeCode``, ``timing.timecode``, ``timing.sampleTimestamp``,
``timing.sequenceNumber``.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from render.errors import InputError
from render.focus.curve import FAR_AWAY_M
from render.focus.files.json_file import load_json, numbers_of, points_of, rates_of
from render.focus.files.opentrackio_file import NAMESPACE, PROTOCOL
from render.focus.files.rows import BadRowError, Rates, Row, Rows, are_rates, given_numbers, json_number, quote_value
from render.focus.files.timing import Timecode, frames_a_day

_WHAT = "the OpenTrackIO"
_SAME = 1e-9
"""Relative: two numbers that differ by less are one number in two files."""

_MOST_OF_RATIO = 2**32
"""The protocol's numerators and denominators are below it."""

_FOLLOWING = ("near_m", "far_m", "hyperfocal_m")
_FIELDS = {
    "focus_distance_m": ("focusDistance",),
    "f_stop": ("fStop",),
    "focal_length_mm": ("pinholeFocalLength", "focalLength"),
}


def rows_of_opentrackio(text: str, rates: Rates) -> Rows:
    """Take a file of OpenTrackIO samples apart.

    Args:
        text: its content.
        rates: rates where the samples give none.

    Raises:
        InputError: it holds no OpenTrackIO samples.
    """
    samples = _samples(text)
    first = next((s for s in samples if isinstance(s, dict)), {})
    protocol = first.get("protocol")
    if not isinstance(protocol, dict) or protocol.get("name") != PROTOCOL["name"]:
        raise InputError(f"{_WHAT} file has no samples whose protocol is {PROTOCOL['name']}", code="bad_curve")
    own = [_own_numbers(sample) for sample in samples]
    counted = _rates(samples, own) or rates
    clock = _choose_clock(samples, own, counted)
    rows = tuple(
        _row(sample, ours, f"sample {number}", time_code, clock.name)
        for number, (sample, ours, time_code) in enumerate(zip(samples, own, clock.time_codes, strict=True), 1)
    )
    static = _part(first, "static")
    camera, lens, gate = _part(static, "camera"), _part(static, "lens"), None
    size = _part(camera, "activeSensorPhysicalDimensions")
    width, height = _finite(size.get("width")), _finite(size.get("height"))
    if width is not None and height is not None:
        gate = width, height
    return Rows(
        what=_WHAT,
        rates=counted,
        rows=rows,
        camera=str(own[0].get("camera", "")),
        lens_name=str(lens.get("model", "")),
        gate_mm=gate,
        on_shot_time=clock.is_shot_time,
    )


@dataclass(frozen=True)
class _Clock:
    """Clock of the samples.

    Attributes:
        name: for messages.
        time_codes: time code of each sample; NaN where it has none.
        is_shot_time: whether it counts as the shot does.
    """

    name: str
    time_codes: tuple[float, ...]
    is_shot_time: bool


def _samples(text: str) -> list[Any]:
    """The samples of a file, however they are strung together."""
    try:
        data = load_json(text)
    except InputError:
        lines = [line for line in text.splitlines() if line.strip()]
        if len(lines) < 2 or not all(line.lstrip().startswith("{") for line in lines):
            raise
        data = [load_json(line) for line in lines]
    if isinstance(data, dict):
        data = data["samples"] if isinstance(data.get("samples"), list) else [data]
    if not isinstance(data, list) or not data:
        raise InputError(f"{_WHAT} file has no samples, but {quote_value(data)}", code="bad_curve")
    return data


def _row(sample: Any, ours: dict[str, Any], place: str, time_code: float, clock: str) -> Row:
    try:
        if not isinstance(sample, dict):
            raise BadRowError(f"expected an object, got {quote_value(sample)}")
        if math.isnan(time_code):
            raise BadRowError(f"it has no {clock}")
        protocol = _protocol_numbers(_part(sample, "lens"))
        extra = numbers_of(ours) if ours else {}
        return Row(
            place=place,
            time_code=time_code,
            numbers=_merge(protocol, extra),
            limited=bool(ours.get("limited", False)),
            source=str(ours.get("source", "camera")),
            reason=str(ours.get("reason", "")),
            points=points_of(ours),
        )
    except BadRowError as error:
        return Row(place, time_code, problem=str(error))


def _protocol_numbers(lens: dict[str, Any]) -> dict[str, float]:
    """Lens numbers from the protocol's own fields."""
    numbers = {}
    for attribute, names in _FIELDS.items():
        name = next((name for name in names if lens.get(name) is not None), None)
        if name is not None:
            numbers[attribute] = json_number(lens[name], f"lens.{name}")
    return numbers


def _merge(protocol: dict[str, float], extra: dict[str, float]) -> dict[str, float]:
    """Merge the protocol's fields with our own extension. Where they differ, the protocol wins and numbers that depend
    on it become NaN.
    """
    merged = dict(extra)
    for name, value in protocol.items():
        ours = extra.get(name, math.nan)
        if name == "focus_distance_m" and math.isinf(ours) and value >= FAR_AWAY_M:
            continue
        if not math.isclose(value, ours, rel_tol=_SAME):
            merged[name] = value
            merged |= dict.fromkeys(_FOLLOWING, math.nan) if extra else {}
    return given_numbers(merged)


def _own_numbers(sample: Any) -> dict[str, Any]:
    """Our own part of a sample, or an empty one."""
    return _part(_part(sample, "custom"), NAMESPACE)


def _part(data: Any, name: str) -> dict[str, Any]:
    part = data.get(name) if isinstance(data, dict) else None
    return part if isinstance(part, dict) else {}


def _rates(samples: Sequence[Any], own: Sequence[dict[str, Any]]) -> Rates | None:
    """Rates of the samples: those that we wrote, or else the rate that most of them give."""
    try:
        return rates_of(own[0])
    except BadRowError:
        pass
    timings = [_part(sample, "timing") for sample in samples]
    sampled = [rate for timing in timings if (rate := _ratio(timing.get("sampleRate"))) is not None]
    coded = [rate for timing in timings if (rate := _timecode_rate(_part(timing, "timecode"))) is not None]
    given = sampled or coded
    if not given:
        return None
    [(text, _)] = Counter(map(str, given)).most_common(1)  # hashes of numbers can be made to collide
    most_common = float(Fraction(text))
    return Rates(most_common, most_common)


def _choose_clock(samples: Sequence[Any], own: Sequence[dict[str, Any]], rates: Rates) -> _Clock:
    """The first clock that most samples have and that runs.

    Raises:
        InputError: there is no usable clock.
    """
    timings = [_part(sample, "timing") for sample in samples]
    per_second, per_frame = rates.time_codes_per_second, rates.time_codes_per_frame
    candidates: tuple[tuple[str, float, list[float | None]], ...] = (
        ("custom.pullfocus.timeCode", 1.0, [_finite(part.get("timeCode")) for part in own]),
        ("timing.timecode", per_second, _over_midnight(timings)),
        ("timing.sampleTimestamp", per_second, _since_first([_timestamp(timing) for timing in timings])),
        ("timing.sequenceNumber", per_frame, [_finite(timing.get("sequenceNumber")) for timing in timings]),
    )
    for name, scale, times in candidates:
        if _runs(times):
            time_codes = [math.nan if time is None else time * scale for time in times]
            usable = tuple(time_code if math.isfinite(time_code) else math.nan for time_code in time_codes)
            return _Clock(name, usable, is_shot_time=name == candidates[0][0])
    names = ", ".join(name for name, *_ in candidates)
    raise InputError(f"{_WHAT} samples say no time that runs: none of {names}", code="bad_curve")


def _runs(times: Sequence[float | None]) -> bool:
    """Whether most samples have a time and most steps go forward."""
    known = [time for time in times if time is not None]
    if 2 * len(known) < len(times) or not known:
        return False
    forward = sum(b > a for a, b in pairwise(known))
    return len(times) == 1 or 2 * forward >= len(known) - 1 > 0


def _over_midnight(timings: Sequence[dict[str, Any]]) -> list[float | None]:
    """Seconds from timecode, which wraps around after a day: passed days are added."""
    days, last, passed = 0, -math.inf, list[float | None]()
    for timing in timings:
        time = _timecode_seconds(timing)
        if time is not None:
            code = _part(timing, "timecode")
            rate = _timecode_rate(code) or Fraction(24)
            day = float(frames_a_day(rate, drop_frame=code.get("dropFrame") is True) / rate)
            days += time + days * day < last - day / 2
            time = last = time + days * day
        passed.append(time)
    return passed


def _timecode_seconds(timing: dict[str, Any]) -> float | None:
    code = _part(timing, "timecode")
    rate = _timecode_rate(code)
    parts = [code.get(name) for name in ("hours", "minutes", "seconds", "frames")]
    hours, minutes, seconds, frames = (part if type(part) is int and 0 <= part < 1000 else None for part in parts)
    if rate is None or hours is None or minutes is None or seconds is None or frames is None:
        return None
    return float(Timecode(hours, minutes, seconds, frames, code.get("dropFrame") is True).frame(rate) / rate)


def _timecode_rate(code: dict[str, Any]) -> Fraction | None:
    return _ratio(code.get("frameRate")) or _ratio(_part(code, "format").get("frameRate"))


def _since_first(times: Sequence[float | None]) -> list[float | None]:
    """Times of a clock that counts since 1970, from the first of them."""
    first = next((time for time in times if time is not None), 0.0)
    return [None if time is None else time - first for time in times]


def _timestamp(timing: dict[str, Any]) -> float | None:
    stamp = _part(timing, "sampleTimestamp")
    seconds, nanoseconds = _finite(stamp.get("seconds")), _finite(stamp.get("nanoseconds"))
    return None if seconds is None or nanoseconds is None else seconds + nanoseconds * 1e-9


def _ratio(value: Any) -> Fraction | None:
    if not isinstance(value, dict):
        return None
    num, denom = value.get("num"), value.get("denom")
    if type(num) is int and type(denom) is int and 0 < num < _MOST_OF_RATIO and 0 < denom < _MOST_OF_RATIO:
        rate = Fraction(num, denom)
        return rate if are_rates(float(rate)) else None
    return None


def _finite(value: Any) -> float | None:
    try:
        number = json_number(value, "")
    except BadRowError:
        return None
    return number if math.isfinite(number) else None
