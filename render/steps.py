"""Times of the main steps of a piece of work, such as opening a shot, peeling and tracing, for those who ask for them.

Graphics devices work behind the processor: a step lasts until the next one needs what it made, or until it was told all.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

MAX_STEPS = 200
"""Steps of one piece of work that are kept; later ones are left out."""

Step = tuple[str, int, int, int]
"""Name; begin and end in ns since 1970, UTC; index of the step that it is a part of, or -1."""


class StepRecorder:
    """Steps of one piece of work.

    Args:
        on_end: told of each step that is kept, when it has ended.

    Attributes:
        steps: in the order of their begin; those that have not ended end with 0.
    """

    def __init__(self, on_end: Callable[[Step], None] = lambda step: None) -> None:
        self.steps: list[Step] = []
        self._on_end = on_end
        self._inside = -1

    @contextmanager
    def record(self, name: str) -> Iterator[None]:
        """Record one step, which the following ones are parts of until it ends."""
        if len(self.steps) >= MAX_STEPS:
            yield
            return
        index, outer, began_ns = len(self.steps), self._inside, time.time_ns()
        self.steps.append((name, began_ns, 0, outer))
        self._inside = index
        try:
            yield
        finally:
            self.steps[index] = name, began_ns, time.time_ns(), outer
            self._inside = outer
            self._on_end(self.steps[index])


recorder: ContextVar[StepRecorder | None] = ContextVar("recorder", default=None)
"""Records the steps of the present piece of work; None where nobody asks for them."""


@contextmanager
def step(name: str) -> Iterator[None]:
    """Run a step of the present piece of work.

    Args:
        name: for people, such as ``peel layers``.
    """
    present = recorder.get()
    if present is None:
        yield
        return
    with present.record(name):
        yield
