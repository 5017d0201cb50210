"""Racks between focus points, as keys: the weights of two points cross, so that the focus goes from the one to the other.

Their sum stays the same, so the focus comes over by just the share that the ease says. Each rack is two keys on each of the
two weights, native splines with the ease in their tangents, which an artist can go on with by hand.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, get_args

from usd_schemas.errors import SchemaError
from usd_schemas.focus_point import FocusPointView
from usd_schemas.keys import Key, Tangents
from usd_schemas.view import LensCamera

Ease = Literal["linear", "smooth", "in", "out"]
EASES: tuple[Ease, ...] = get_args(Ease)
END_SLOPES: dict[Ease, tuple[float, float]] = {"linear": (1, 1), "smooth": (0, 0), "in": (0, 2), "out": (2, 0)}
"""Slopes of each ease where it starts and where it ends, as a cubic from (0, 0) to (1, 1)."""


@dataclass(frozen=True)
class WeightRack:
    """A rack from one focus point to another.

    Attributes:
        from_point: name of the point that is in focus until the start.
        to_point: name of the point that is in focus from the end on.
        start: USD time code.
        end: USD time code.
        ease: ``linear``, ``smooth`` (starts and ends softly), ``in`` (starts softly) or ``out`` (ends softly).
    """

    from_point: str
    to_point: str
    start: float
    end: float
    ease: Ease = "smooth"


def author_rack(camera: LensCamera, rack: WeightRack) -> None:
    """Author a rack in the stage's edit target, and let the points decide the focus where it was set by hand.

    Keys at just its start and end are replaced; all others stay.

    Args:
        camera: the camera.
        rack: what shall be.

    Raises:
        SchemaError: the rack makes no sense, or contradicts keys that are there (`rack_contradictions`); nothing is
            authored then.
    """
    problem = next(rack_contradictions(camera, rack), None)
    if problem is not None:
        raise SchemaError(problem)
    leaving, coming = camera.focus_point(rack.from_point), camera.focus_point(rack.to_point)
    full = leaving.read(rack.start).weight
    _author_crossing(leaving, rack, full, 0.0)
    _author_crossing(coming, rack, 0.0, full)
    settings = camera.focus.read()
    if settings.mode == "manual":
        camera.focus.author(replace(settings, mode="points"))


def rack_contradictions(camera: LensCamera, rack: WeightRack) -> Iterator[str]:
    """Why a rack cannot be, one sentence each; none where it can.

    Raises:
        SchemaError: the camera has no such points.
    """
    leaving, coming = camera.focus_point(rack.from_point), camera.focus_point(rack.to_point)
    name = f"the rack from {rack.from_point} to {rack.to_point}"
    if rack.from_point == rack.to_point:
        yield f"a rack goes from one focus point to another, got {rack.from_point} twice"
        return
    if rack.ease not in EASES:
        yield f"the ease of {name} must be one of {', '.join(EASES)}, got {rack.ease!r}"
    if not (math.isfinite(rack.start) and math.isfinite(rack.end) and rack.start < rack.end):
        yield f"{name} must end after its start, got {rack.start:g} to {rack.end:g}"
        return
    for view, time in ((leaving, rack.start), (coming, rack.end)):
        if not view.read(time).enabled:
            yield f"{name} needs both to count, but {view.name} is switched off at {time:g}"
    for view in (leaving, coming):
        within = [key.time for key in view.keys("weight") if rack.start < key.time < rack.end]
        if within:
            times = ", ".join(f"{time:g}" for time in within)
            yield f"{name} from {rack.start:g} to {rack.end:g} contradicts the keys of {view.name}'s weight at {times}"
    if leaving.read(rack.start).weight <= 0:
        yield f"{name} starts at {rack.start:g}, where {rack.from_point} is not in focus: its weight there is 0"
    before = _last(coming.keys("weight"), rack.start)
    if before is not None and before.value > 0:
        yield (
            f"{name} starts at {rack.start:g}, but {rack.to_point} is in focus by then: its weight has the key "
            f"{before.value:g} at {before.time:g}"
        )


def _author_crossing(view: FocusPointView, rack: WeightRack, start: float, end: float) -> None:
    """Key one weight from a value to another. What runs up to the start and on from the end keeps its shape."""
    mean = (end - start) / (rack.end - rack.start)
    out_slope, in_slope = (mean * slope for slope in END_SLOPES[rack.ease])
    reach = (rack.end - rack.start) / 3
    there, then = (_tangents(view, time) for time in (rack.start, rack.end))
    first = replace(there, out_slope=out_slope, out_width=reach)
    last = replace(then, in_slope=in_slope, in_width=reach)
    view.set_key("weight", rack.start, start, "bezier", first)
    view.set_key("weight", rack.end, end, "bezier", last)


def _tangents(view: FocusPointView, time: float) -> Tangents:
    """Those of a weight's key at a time, level ones where there is none."""
    found = next((key.tangents for key in view.keys("weight") if key.time == time), None)
    return found or Tangents()


def _last(keys: list[Key], before: float) -> Key | None:
    return next((key for key in reversed(keys) if key.time < before), None)
