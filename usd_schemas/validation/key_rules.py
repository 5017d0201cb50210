"""Rules for keys that contradict each other: each is legal, but together they are surely a mistake."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Usd

from usd_schemas.errors import SchemaError
from usd_schemas.focus_point import FocusPointView
from usd_schemas.validation.rule import Fault, Rule
from usd_schemas.values import is_animated
from usd_schemas.view import LensCamera

_MAX_LISTED = 5  # times that a message names before it stops


def two_drivers(prim: Usd.Prim) -> Iterator[Fault]:
    """The focus is keyed as a distance or found from focus points, and not both."""
    camera = LensCamera(prim)
    attribute = prim.GetAttribute("focusDistance")
    mode = camera.focus.read().mode
    if mode != "manual" and camera.focus_points() and is_animated(attribute):
        yield Fault(
            attribute.GetPath(),
            f"focusDistance has keys, but focus:mode is {mode}: they are used only where no focus point is",
        )


def counting(prim: Usd.Prim) -> Iterator[Fault]:
    """Where weights and switches of focus points are keyed, what counts is switched on, and something counts."""
    views = LensCamera(prim).focus_points()
    keyed = {view.name: [(key.time, key.value) for key in view.keys("weight")] for view in views}
    for view in views:
        off = [time for time, weight in keyed[view.name] if weight > 0 and not _weight_and_switch(view, time)[1]]
        if off:
            yield Fault(
                prim.GetPath().AppendProperty(f"focusPoint:{view.name}:weight"),
                f"focus point {view.name} has keys of its weight where it is switched off: at {_times(off)}",
            )
    times = {time for name in keyed for time, _ in keyed[name]}
    times |= {key.time for view in views for key in view.keys("enabled")}
    empty = [
        time
        for time in sorted(times)
        if not any(weight > 0 and on for weight, on in _weights_and_switches(views, time))
    ]
    if empty:
        yield Fault(
            prim.GetPath().AppendProperty("focus:mode"),
            f"no focus point counts at {_times(empty)}, by the keys of their weights and switches: the camera's own focus "
            "distance is kept there",
        )


def _weights_and_switches(views: list[FocusPointView], time: float) -> list[tuple[float, bool]]:
    return [_weight_and_switch(view, time) for view in views]


def _weight_and_switch(view: FocusPointView, time: float) -> tuple[float, bool]:
    """Read weight and switch of a focus point. Another rule reports a point whose target cannot be read."""
    try:
        point = view.read(time)
    except SchemaError:
        return 1.0, True
    return point.weight, point.enabled


def _times(times: list[float]) -> str:
    listed = ", ".join(f"{time:g}" for time in times[:_MAX_LISTED])
    return f"{listed} and {len(times) - _MAX_LISTED} more times" if len(times) > _MAX_LISTED else listed


KEY_RULES = (
    Rule("FocusDrivers", two_drivers.__doc__ or "", "warning", "camera", two_drivers),
    Rule("FocusPointKeys", counting.__doc__ or "", "warning", "camera", counting),
)
