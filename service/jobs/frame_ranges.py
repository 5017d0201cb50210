"""Ranges of frames as text, in the grammar of Open Job Description's integer ranges: ``1-10:2,15``.

A range is a list of parts, separated by commas: a frame, ``FIRST-LAST``, or ``FIRST-LAST:STEP``. Frames may be negative, and so
may the step of a range that goes down. No frame may come twice (OpenJD Template Schemas 2023-09, ``IntRangeExpr``).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from render.errors import SettingsError

MAX_FRAMES = 10_000
MAX_FRAME = 10**9
_PART = re.compile(r"\s*(-?[0-9]{1,10})\s*(?:-\s*(-?[0-9]{1,10})\s*(?::\s*(-?[0-9]{1,10})\s*)?)?")


def parse_frames(text: str) -> list[int]:
    """Return the frames of a range in rising order.

    Raises:
        SettingsError: the text is no range, a frame comes twice, or there are too many.
    """
    ranges = [_part(part, text) for part in text.split(",")]
    count = sum(len(frames) for frames in ranges)
    if count > MAX_FRAMES:
        raise SettingsError(f"a render has {MAX_FRAMES:,} frames at most, got {count:,}", path="frames")
    frames = sorted(frame for part in ranges for frame in part)
    twice = next((one for one, other in pairwise(frames) if one == other), None)
    if twice is not None:
        raise SettingsError(f"frame {twice} comes twice in {text!r}", path="frames")
    return frames


def format_frames(frames: Sequence[int]) -> str:
    """Return frames in rising order as a short range."""
    parts: list[str] = []
    start = 0
    while start < len(frames):
        end = start + 1
        step = frames[end] - frames[start] if end < len(frames) else 1
        while end < len(frames) and frames[end] - frames[end - 1] == step:
            end += 1
        if step > 1 and end - start < 3:  # two frames are no row with a step
            end, step = start + 1, 1
        first, last = frames[start], frames[end - 1]
        parts.append(f"{first}" if first == last else f"{first}-{last}" if step == 1 else f"{first}-{last}:{step}")
        start = end
    return ",".join(parts)


def _part(part: str, text: str) -> range:
    found = _PART.fullmatch(part)
    if not found:
        raise SettingsError(f"frames are expected like 1-10:2,15, got {text[:80]!r}", path="frames")
    first = int(found[1])
    last = first if found[2] is None else int(found[2])
    step = 1 if found[3] is None else int(found[3])
    if max(abs(first), abs(last)) > MAX_FRAME:
        raise SettingsError(f"frames lie between -{MAX_FRAME:,} and {MAX_FRAME:,}, got {part.strip()!r}", path="frames")
    if step == 0 or (last - first) * step < 0:
        raise SettingsError(
            f"the step of {part.strip()!r} does not lead from its first frame to its last", path="frames"
        )
    return range(first, last + (1 if step > 0 else -1), step)
