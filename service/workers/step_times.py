"""Times of the steps of a call, as a worker tells them. A hostile file may have taken control of it."""

from __future__ import annotations

from render.steps import MAX_STEPS, Step

MAX_NAME = 100
MAX_TIME_NS = 1 << 63


def checked_steps(steps: object) -> tuple[Step, ...]:
    """Return the steps of an answer; none where they are not what `render.steps` makes."""
    if type(steps) is not tuple or len(steps) > MAX_STEPS:
        return ()
    return steps if all(_is_step(entry, index) for index, entry in enumerate(steps)) else ()


def _is_step(entry: object, index: int) -> bool:
    match entry:
        case (str(name), int(begun_ns), int(ended_ns), int(outer)):
            return len(name) <= MAX_NAME and 0 < begun_ns <= ended_ns < MAX_TIME_NS and -1 <= outer < index
    return False
