"""Rule of the validators: a check of a camera, a prim or a stage, and perhaps a safe fix."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Literal

from pxr import Sdf, Usd

from usd_schemas.keys import keys
from usd_schemas.values import is_animated, read_value

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong.

    Attributes:
        path: the prim or property.
        message: one sentence: what was expected, what was got.
    """

    path: Sdf.Path
    message: str


@dataclass(frozen=True)
class Fix:
    """A repair that cannot lose authored intent.

    Attributes:
        name: a short word for programs.
        description: what it does.
        possible: whether it can be done, given the stage and the fault's path, in the stage's edit target.
        apply: does it there.
    """

    name: str
    description: str
    possible: Callable[[Usd.Stage, Sdf.Path], bool]
    apply: Callable[[Usd.Stage, Sdf.Path], None]


@dataclass(frozen=True)
class Rule:
    """One thing that must hold.

    Attributes:
        name: of the validator and of its error.
        doc: what must hold.
        severity: error where a renderer cannot do what is asked, warning where it may surprise.
        subject: what is checked: each camera, each prim, or the stage.
        check: yields the faults of one of these.
        fix: the repair, if one is safe.
    """

    name: str
    doc: str
    severity: Severity
    subject: Literal["camera", "prim", "stage"]
    check: Callable[[Any], Iterator[Fault]]
    fix: Fix | None = None


def authored_values(attribute: Usd.Attribute) -> Iterator[tuple[str, Any]]:
    """Each value that an attribute has, with words for where: its default, or each of its keys."""
    if is_animated(attribute):
        for key in keys(attribute):
            yield f" at time {key.time:g}", key.value
    elif attribute.HasAuthoredValue() and (value := read_value(attribute)) is not None:
        yield "", value
