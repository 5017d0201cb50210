"""Numbers of the sets of lights that leave surfaces out, which the colour pass keeps and the lighting looks up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.scene import MAX_LINK_SETS, Batch

_BITS = 128
_DOME = _BITS - 1


class LinkSets:
    """Sets of lights that do not shine on some of a scene's surfaces. Set 0 is empty.

    Args:
        batches: all that is drawn; those beyond `MAX_LINK_SETS` sets are lit by all lights.
    """

    def __init__(self, batches: Sequence[Batch]) -> None:
        sets = dict.fromkeys([frozenset[str](), *(batch.links.unlit_by for batch in batches)])
        self._numbers = {unlit_by: number for number, unlit_by in enumerate(list(sets)[:MAX_LINK_SETS])}

    @property
    def is_linked(self) -> bool:
        """Whether any light leaves a surface out."""
        return len(self._numbers) > 1

    @property
    def options(self) -> dict[str, int | float | str]:
        """Defines of the shaders that light surfaces."""
        return {"LINKED": 1, "LINK_SETS": MAX_LINK_SETS} if self.is_linked else {}

    def number(self, batch: Batch) -> int:
        """Number of a batch's set."""
        return self._numbers.get(batch.links.unlit_by, 0)

    def pack(self, rows: Sequence[str], dome: str) -> bytes:
        """The std140 bytes of ``LinkBlock``; empty where nothing is linked.

        Args:
            rows: path of each light of ``LightBlock``.
            dome: path of the dome; empty for none.
        """
        if not self.is_linked:
            return b""
        bits = np.zeros((MAX_LINK_SETS, _BITS), np.uint8)
        for unlit_by, number in self._numbers.items():
            bits[number, : len(rows)] = [path in unlit_by for path in rows]
            bits[number, _DOME] = dome in unlit_by
        return np.packbits(bits, axis=1, bitorder="little").tobytes()
