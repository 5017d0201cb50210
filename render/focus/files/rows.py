"""A focus curve's file taken apart: what its rows say, before anyone asks whether that makes a curve."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from render.focus.solve import STATES, PointState


class BadRowError(ValueError):
    """A row cannot be used; the message is the end of a sentence that begins with the row's name."""


LEAST_RATE, MOST_RATE = 1e-6, 1e6
"""Frame rates and time-code rates that a file may have, 1/s."""


def are_rates(*rates: float) -> bool:
    """Whether numbers can be frame rates or time-code rates, 1/s."""
    return all(LEAST_RATE <= rate <= MOST_RATE for rate in rates)


@dataclass(frozen=True)
class Rates:
    """Frame rate and time-code rate.

    Attributes:
        frames_per_second: frames per second.
        time_codes_per_second: USD time codes per second.
    """

    frames_per_second: float
    time_codes_per_second: float

    @property
    def time_codes_per_frame(self) -> float:
        """Time codes that one frame takes."""
        return self.time_codes_per_second / self.frames_per_second


@dataclass(frozen=True)
class PointCell:
    """One focus point in one row."""

    state: PointState
    depth_m: float
    weight: float
    share: float
    coc_mm: float


@dataclass(frozen=True)
class Row:
    """One frame of a file.

    Attributes:
        place: where in the file it is, such as ``row 7``.
        time_code: time code at the file's own rate; NaN where it cannot be read.
        numbers: numbers by the names of `FocusCurve`'s columns, in their units; missing ones are absent.
        problem: why it cannot be used, or empty.
        limited: whether the lens could not reach the requested focus.
        source: whose focus it is.
        reason: reason in one sentence.
        points: the focus points by name.
    """

    place: str
    time_code: float
    numbers: dict[str, float] = field(default_factory=dict)
    problem: str = ""
    limited: bool = False
    source: str = "camera"
    reason: str = ""
    points: dict[str, PointCell] = field(default_factory=dict)


@dataclass(frozen=True)
class Rows:
    """A file, taken apart.

    Attributes:
        what: name of the source for messages, such as ``the CSV``.
        rates: its rates.
        rows: in the order of the file.
        camera: prim path, or empty.
        lens_name: or empty.
        gate_mm: width and height of the film gate, if given.
        on_shot_time: whether its times are those of a shot, and not of a clock that ran beside it.
        notes: findings beside the rows.
    """

    what: str
    rates: Rates
    rows: tuple[Row, ...]
    camera: str = ""
    lens_name: str = ""
    gate_mm: tuple[float, float] | None = None
    on_shot_time: bool = True
    notes: tuple[str, ...] = ()


def json_number(value: Any, name: str) -> float:
    """A number of a JSON file.

    Args:
        value: value in the file.
        name: its name, for the message.

    Raises:
        BadRowError: the value is not a number.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise BadRowError(f"{name} must be a number, but it is {quote_value(value)}")
    try:
        return float(value)
    except OverflowError as error:  # JSON's whole numbers have no end
        raise BadRowError(f"{name} is beyond all numbers") from error


def known_state(value: Any) -> PointState:
    """A focus point's state.

    Raises:
        BadRowError: there is no such state.
    """
    for state in STATES:
        if state == value:
            return state
    raise BadRowError(f"a focus point's state must be one of {', '.join(STATES)}, but it is {quote_value(value)}")


def quote_value(value: Any) -> str:
    """Value of a file quoted for a message, shortened."""
    text = repr(value)
    return text if len(text) <= 40 else f"{text[:37]}..."


def given_numbers(numbers: dict[str, float]) -> dict[str, float]:
    """Numbers without missing ones (NaN)."""
    return {name: value for name, value in numbers.items() if not math.isnan(value)}
