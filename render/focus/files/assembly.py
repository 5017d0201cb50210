"""Assembly of a focus curve from a file's rows: unusable rows are reported, and gaps are held, interpolated or refused.

A gap is a row that cannot be used, or a step in time that is longer than the file's own by half. The file's own step is the
middle one of all, the lower where two are: a curve of every second frame has no gaps.

``hold`` repeats the row before the gap. ``interpolate`` goes evenly to the row behind it: in inverse distance for the focus, at
which pace an eye sees blur change, and in its own unit for the rest. Before the first row that can be used and behind the last,
both repeat the nearest. What follows from the lens and the scene (depth of field, who is where) is not known in a gap that is
interpolated, and in no gap is it known of the focus points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from render.errors import InputError, SettingsError
from render.focus.curve import FAR_AWAY_M, FocusCurve, PointTrack
from render.focus.files.columns import COC_LIMIT, COLUMNS, FOCUS_DISTANCE
from render.focus.files.rows import PointCell, Row, Rows
from render.model.arrays import DoubleArray, IndexArray

Gaps = Literal["refuse", "hold", "interpolate"]
GAPS: tuple[Gaps, ...] = get_args(Gaps)

MAX_FRAMES = 100_000
MAX_CELLS = 4_000_000
"""Focus points times frames of a curve."""
"""Frames of one curve: more is a slip, such as one frame number with too many digits."""

MOST = 1e6
"""Upper bound on f-numbers and on focal lengths in mm, within single precision."""

MOST_TIME_CODE = 1e9

FAR_M = 1000.0
"""Half of all focus distances beyond this are not metres but, most likely, millimetres."""

_MOST_NAMED = 5
_LONGER = 1.5
_DEFAULTS = {"tilt_rad": 0.0, "swing_rad": 0.0}
_BETWEEN = "between the rows of the file"


@dataclass(frozen=True)
class CurveFinding:
    """Finding about a file, for its reader.

    Attributes:
        code: a short stable word: ``bad_row``, ``gap``, ``odd_units``, ``not_used`` or ``other_rate``.
        place: which row, sample or frames, or empty for the file.
        message: one sentence.
    """

    code: str
    place: str
    message: str


@dataclass(frozen=True, eq=False)
class ReadCurve:
    """Focus curve from a file.

    Attributes:
        curve: the curve, NaN where the file gives no value.
        given: which of focus_distance_m, f_stop, focal_length_mm, tilt_rad and swing_rad the file gives.
        findings: faults of the file, and their handling.
        on_shot_time: whether its times are those of a shot, and not of a clock that ran beside it.
    """

    curve: FocusCurve
    given: frozenset[str]
    findings: tuple[CurveFinding, ...]
    on_shot_time: bool


def assemble_curve(rows: Rows, gaps: Gaps = "refuse") -> ReadCurve:
    """Make a curve of a file's rows.

    Args:
        rows: the file, taken apart.
        gaps: what to do about gaps.

    Raises:
        InputError: there is no row that can be used, or gaps are refused and there are some.
        SettingsError: ``gaps`` is no known word.
    """
    if gaps not in GAPS:
        raise SettingsError(f"gaps must be one of {', '.join(GAPS)}, but it is {gaps!r}", code="bad_setting")
    if not rows.rows:
        raise InputError(f"{rows.what} has no rows", code="bad_curve")
    given = _given_attributes(rows.rows)
    checked = _check_rows(rows.rows, given)
    good, bad = [row for row in checked if not row.problem], [row for row in checked if row.problem]
    if not good:
        raise InputError(f"{rows.what} has no row that can be used; {bad[0].place}: {bad[0].problem}", code="bad_curve")
    times, missing = _every_time(good, bad)
    found = [CurveFinding("not_used", "", note) for note in rows.notes]
    found += _gap_findings(good, bad, missing, gaps, rows)
    curve = _CurveFill.from_rows(good, times, gaps).curve(rows)
    return ReadCurve(curve, given, (*found, *_odd_units(curve)), rows.on_shot_time)


def _given_attributes(rows: Sequence[Row]) -> frozenset[str]:
    """Attributes that drive a camera and that the file gives. Every focus curve gives a focus distance."""
    drive = [column.attribute for column in COLUMNS if column.drives]
    given = {name for name in drive if any(name in row.numbers for row in rows if not row.problem)}
    return frozenset(given | {FOCUS_DISTANCE.attribute})


def _check_rows(rows: Sequence[Row], given: frozenset[str]) -> list[Row]:
    """Rows, with the fault of each noted in it."""
    checked, last = [], -math.inf
    for row in rows:
        problem = row.problem or _problem(row, given)
        if not problem and not row.time_code > last:
            problem = (
                f"its time does not come after that of the row before (time code {row.time_code:g} after {last:g})"
            )
            row = replace(row, time_code=math.nan)
        last = max(last, row.time_code) if not problem else last
        checked.append(replace(row, problem=problem))
    return checked


def _problem(row: Row, given: frozenset[str]) -> str:
    """Fault of a row; empty for a usable row."""
    if not abs(row.time_code) <= MOST_TIME_CODE:
        return f"it has no time code within {MOST_TIME_CODE:g}" if math.isfinite(row.time_code) else "it has no time"
    for column in COLUMNS:
        name, value = column.attribute, row.numbers.get(column.attribute)
        if name in given and value is None:
            return f"it has no {column.csv}"
        if value is None:
            continue
        expected = _expected_range(name, value)
        if expected:
            return f"{column.csv} must be {expected}, but it is {value / column.factor:g}"
    distance, focal_length = row.numbers.get("focus_distance_m", math.inf), row.numbers.get("focal_length_mm", 0.0)
    if distance * 1000 <= focal_length:
        return f"a focus of {distance:g} m lies within the focal length of {focal_length:g} mm: is it in metres?"
    return ""


def _expected_range(name: str, value: float) -> str:
    """Expected range of a number that is outside it, in words; empty where the number is valid."""
    if name == "focus_distance_m":
        return "" if value > 0 else "above 0, or infinite"
    if name == "focal_length_mm":
        return "" if 0 < value <= MOST else f"above 0 and at most {MOST:g}"
    if name == "f_stop":
        return "" if 0 <= value <= MOST else f"from 0 (a pinhole) to {MOST:g}"
    if name in _DEFAULTS:
        return "" if abs(value) < math.pi / 2 else "within 90 degrees"
    return "" if value >= 0 else "0 or more"


def _every_time(good: Sequence[Row], bad: Sequence[Row]) -> tuple[DoubleArray, list[DoubleArray]]:
    """Times of the curve, and the missing ones, gap by gap.

    Raises:
        InputError: they are too many.
    """
    named = {row.time_code for row in (*good, *bad) if math.isfinite(row.time_code)}
    times = np.array(sorted(named))
    steps = np.diff(times)
    if len(steps) == 0:
        return times, []
    step = np.sort(steps)[(len(steps) - 1) // 2]
    counts = np.where(steps > _LONGER * step, np.rint(steps / step) - 1, 0)
    if len(times) + counts.sum() > MAX_FRAMES:
        raise InputError(
            f"the frames from {times[0]:g} to {times[-1]:g}, by {step:g}, are more than the {MAX_FRAMES:,} of one curve",
            code="bad_curve",
        )
    missing = [
        times[i] + steps[i] * np.arange(1, counts[i] + 1) / (counts[i] + 1) for i in np.flatnonzero(counts).tolist()
    ]
    return np.sort(np.concatenate([times, *missing])), missing


def _gap_findings(
    good: Sequence[Row], bad: Sequence[Row], missing: Sequence[DoubleArray], gaps: Gaps, rows: Rows
) -> list[CurveFinding]:
    """Findings about the gaps and their handling.

    Raises:
        InputError: they are refused.
    """
    per_frame = rows.rates.time_codes_per_frame
    found = [CurveFinding("bad_row", row.place, f"{row.place} cannot be used: {row.problem}") for row in bad]
    for times in missing:
        first, last = times[0] / per_frame, times[-1] / per_frame
        place = f"frame {first:g}" if len(times) == 1 else f"frames {first:g} to {last:g}"
        found.append(CurveFinding("gap", place, f"{rows.what} has no row for {place}"))
    if found and gaps == "refuse":
        named = "; ".join(finding.message for finding in found[:_MOST_NAMED])
        more = f"; and {len(found) - _MOST_NAMED} more" if len(found) > _MOST_NAMED else ""
        raise InputError(
            f"{rows.what} has gaps, which can be held or interpolated if you say so: {named}{more}", code="curve_gaps"
        )
    done = {"hold": "held", "interpolate": "interpolated"}.get(gaps, "")
    return [replace(finding, message=f"{finding.message}; {done}") for finding in found]


def _odd_units(curve: FocusCurve) -> list[CurveFinding]:
    finite = curve.focus_distance_m[np.isfinite(curve.focus_distance_m)]
    if len(finite) == 0 or not FAR_M < np.median(finite) < FAR_AWAY_M:
        return []
    message = f"half of all focus distances are beyond {FAR_M:g} m: are they in metres?"
    return [CurveFinding("odd_units", "focus_distance_m", message)]


@dataclass(frozen=True, eq=False)
class _CurveFill:
    """Good rows spread over all times of a curve.

    Attributes:
        rows: the good rows.
        own_times: ``(r,)`` theirs.
        times: ``(n,)`` of the curve.
        nearest: ``(n,)`` the row whose values hold at each.
        is_own: ``(n,)`` whether it is that row's own time.
        gaps: hold or interpolate.
    """

    rows: Sequence[Row]
    own_times: DoubleArray
    times: DoubleArray
    nearest: IndexArray
    is_own: NDArray[np.bool_]
    gaps: Gaps

    @classmethod
    def from_rows(cls, rows: Sequence[Row], times: DoubleArray, gaps: Gaps) -> _CurveFill:
        """Spread the rows over all times."""
        own = np.array([row.time_code for row in rows])
        nearest = np.clip(np.searchsorted(own, times, side="right") - 1, 0, None)
        return cls(rows, own, times, nearest, own[nearest] == times, gaps)

    def curve(self, rows: Rows) -> FocusCurve:
        """The curve."""
        names = {name: None for row in self.rows for name in row.points}
        if len(names) * len(self.times) > MAX_CELLS:
            counts = f"{len(names):,} focus points over {len(self.times):,} frames"
            raise InputError(f"{rows.what} has {counts}; at most {MAX_CELLS:,} cells can be read", code="bad_curve")
        columns = {c.attribute: self._column(c.attribute, follows=not c.drives and c is not COC_LIMIT) for c in COLUMNS}
        return FocusCurve(
            camera=rows.camera,
            frames_per_second=rows.rates.frames_per_second,
            time_codes_per_second=rows.rates.time_codes_per_second,
            time_codes=self.times,
            **columns,
            sources=tuple(
                "points" if row.source == "points" and own else "camera"
                for row, own in zip(self._rows(), self.is_own.tolist(), strict=True)
            ),
            reasons=self._reasons(),
            points=tuple(self._track(name) for name in names),
            limited=np.array([row.limited for row in self._rows()], np.bool_),
            lens_name=rows.lens_name,
            gate_mm=rows.gate_mm,
            distortion=(),
        )

    def _column(self, name: str, *, follows: bool) -> DoubleArray:
        """One column of numbers; a column that follows from others is NaN between rows."""
        own = np.array([row.numbers.get(name, _DEFAULTS.get(name, math.nan)) for row in self.rows])
        if self.gaps != "interpolate":
            return np.asarray(own[self.nearest])
        if follows:
            return np.where(self.is_own, own[self.nearest], math.nan)
        if name != "focus_distance_m":
            return np.where(self.is_own, own[self.nearest], np.interp(self.times, self.own_times, own))
        with np.errstate(divide="ignore"):
            between = 1 / np.interp(self.times, self.own_times, 1 / own)
        return np.where(self.is_own, own[self.nearest], between)

    def _rows(self) -> list[Row]:
        return [self.rows[i] for i in self.nearest.tolist()]

    def _reasons(self) -> tuple[str, ...]:
        done = "held" if self.gaps == "hold" else "interpolated"
        return tuple(
            row.reason if own else f"{done} {_BETWEEN}"
            for row, own in zip(self._rows(), self.is_own.tolist(), strict=True)
        )

    def _track(self, name: str) -> PointTrack:
        """Track of one focus point; its state is ``lost`` where its row gives none, and in gaps."""
        lost = PointCell("lost", math.nan, math.nan, 0.0, math.nan)
        cells = [
            row.points.get(name, lost) if own else replace(lost, weight=row.points.get(name, lost).weight)
            for row, own in zip(self._rows(), self.is_own.tolist(), strict=True)
        ]
        return PointTrack(
            name=name,
            depth_m=np.array([cell.depth_m for cell in cells]),
            weight=np.array([cell.weight for cell in cells]),
            share=np.array([cell.share for cell in cells]),
            coc_mm=np.array([cell.coc_mm for cell in cells]),
            states=tuple(cell.state for cell in cells),
        )
