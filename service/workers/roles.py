"""Roles of worker processes: which functions they run, and within which limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from service.workers.calls import name_of
from service.workers.sandbox import Limits

State = TypeVar("State")


@dataclass(frozen=True)
class Role(Generic[State]):
    """A kind of worker process.

    Attributes:
        name: for logs, metrics and messages.
        state: name of the registered class or function that creates the state passed to every call.
        limits: of a process of this role.
        draws: whether it needs OpenGL.
        niceness: added to its scheduling priority; 19 gives way to everything else.
        is_single: whether a shot has at most one such process, because its state counts.
        keeps_state: whether it holds what cannot be made again; such processes are ended last.
        is_thrown_away: whether a process ends after one call.
    """

    name: str
    state: str
    limits: Limits
    draws: bool = False
    niceness: int = 0
    is_single: bool = False
    keeps_state: bool = False
    is_thrown_away: bool = False


def role(name: str, make_state: Callable[[], State], limits: Limits, **options: Any) -> Role[State]:
    """Make a role.

    Args:
        name: for logs, metrics and messages.
        make_state: registered class or function that creates the worker's state, or a reference to it.
        limits: of a process.
        **options: other fields of `Role`.
    """
    return Role(name, name_of(make_state), limits, **options)
