"""Layout of a file: its parts, and where the picture lies in a larger one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from render.model.aovs import Kind, file_order
from render.model.framing import WHOLE, Framing

COLOR_PART = "rgba"
"""Name of the part with the colour of the picture, where nobody names it."""


@dataclass(frozen=True)
class FilePart:
    """Part of an EXR file.

    Attributes:
        name: of the part.
        aov: AOV that it holds, or ``color``.
        kind: type of its samples; None for that of the AOV, half for the colour.
        channels: number of channels at most; None for all.
    """

    name: str
    aov: str
    kind: Kind | None = None
    channels: int | None = None


@dataclass(frozen=True)
class FileLayout:
    """Layout of a file.

    Attributes:
        parts: parts of an EXR file, in order; empty for the colour and each AOV of the frame.
        framing: place of the picture in the whole one, and the shape of its pixels.
        is_deep: whether an EXR holds samples in depth (`render.output.deep_exr`), in place of parts.
    """

    parts: tuple[FilePart, ...] = ()
    framing: Framing = WHOLE
    is_deep: bool = False

    def parts_for(self, aovs: Sequence[str]) -> list[FilePart]:
        """Parts of a file for a frame with these AOVs."""
        if not self.parts:
            return [FilePart(COLOR_PART, "color"), *(FilePart(name, name) for name in file_order(aovs))]
        return list(self.parts)


PLAIN_LAYOUT = FileLayout()
