"""Facts that are burnt into the corners of pictures, by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from render.errors import SettingsError
from render.near_names import hint

Fact = Literal[
    "shot", "camera", "lens", "focal", "stop", "focus", "focusFt", "film", "revision", "date", "frame", "timecode"
]
FACTS: tuple[Fact, ...] = get_args(Fact)
"""In the order in which they are listed: ``focus`` in metres, ``focusFt`` in feet and inches."""


@dataclass(frozen=True)
class BurnIn:
    """Facts that are burnt into pictures, and what of them the picture does not know.

    Attributes:
        facts: of `FACTS`.
        shot: name of the shot; empty for that of its file.
        revision: of the shot's edits; empty for none.
        day: of the delivery, as ``YYYY-MM-DD``; empty for none.
    """

    facts: tuple[Fact, ...]
    shot: str = ""
    revision: str = ""
    day: str = ""


def read_facts(names: Sequence[str]) -> tuple[Fact, ...]:
    """Read names of facts.

    Args:
        names: of `FACTS`.

    Raises:
        SettingsError: there is no such fact; the message has the nearest names.
    """
    unknown = [name for name in names if name not in FACTS]
    if unknown:
        raise SettingsError(
            f"there is no burn-in named {unknown[0]!r}: {hint(unknown[0], FACTS)}; there are {', '.join(FACTS)}",
            code="unknown_burn_in",
        )
    return tuple(fact for fact in FACTS if fact in names)
