"""Pictures of shots some of whose materials the device refuses."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from render.errors import RefusedProgramError
from render.model.refused_programs import REFUSED

_Drawn = TypeVar("_Drawn")


def draw_accepted(draw: Callable[[], _Drawn]) -> _Drawn:
    """Read and draw a scene, and once more where the device refuses networks of nodes; again, if it refuses more then.

    Args:
        draw: reads the scene anew each time, and draws it.

    Raises:
        RefusedProgramError: what was refused before is drawn nevertheless.
    """
    while True:
        known = REFUSED.count
        try:
            return draw()
        except RefusedProgramError:
            if REFUSED.count == known:
                raise
