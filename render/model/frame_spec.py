"""Frame specifications as usdrecord has them, and file names with a place for the frame number.

``1:48`` is every frame from 1 to 48, both ends included; ``1:9x2`` is 1, 3, 5, 7, 9; ``9:1`` counts down; ``1,5:9x2``
is several of them. In a file name a run of ``#`` holds the frame number: ``shot.####.exr`` is ``shot.0012.exr`` at
frame 12, and ``shot.####.##.exr`` holds frame 12.5 as ``shot.0012.50.exr``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from render.errors import SettingsError

MAX_FRAMES = 100_000
"""More than an hour at 24 frames a second. A request for more is a slip, and is refused before anything is done."""

_STEP_SLACK = 1e-6
"""So that 1:2x0.1 includes 2, which is no multiple of 0.1 in binary; the slack that usdrecord allows."""

_NUMBER = r"([+-]?(?:\d+\.?\d*|\.\d+))"
_RANGE = re.compile(rf"{_NUMBER}(?::{_NUMBER}(?:x{_NUMBER})?)?")
_NUMBER_HOLDER = re.compile(r"(#+)(?:\.(#+))?")


def parse_frames(spec: str) -> list[float]:
    """The USD time codes that a frame specification names, in its order.

    Args:
        spec: such as ``1:48`` or ``1,5:9x2``.

    Returns:
        At least one and at most `MAX_FRAMES` time codes, each once.

    Raises:
        SettingsError: it cannot be read, or names no frame, or one frame twice, or too many.
    """
    frames: list[float] = []
    for part in spec.split(","):
        start, stride, count = _read_range(part.strip(), spec)
        if len(frames) + count > MAX_FRAMES:
            raise SettingsError(f"frames {spec!r} are more than the {MAX_FRAMES:,} that one command takes")
        frames += [start + i * stride for i in range(count)]
    if len(set(frames)) < len(frames):
        raise SettingsError(f"frames {spec!r} name a frame more than once")
    return frames


def every_frame(start: float, end: float) -> list[float]:
    """The time codes of a shot from its first frame to its last, both included.

    Args:
        start: time code of the first frame.
        end: time of the last frame; where it lies before the first, only the first frame is returned.

    Raises:
        SettingsError: they are too many.
    """
    steps = max(0.0, end - start)
    if not steps < MAX_FRAMES:
        raise SettingsError(
            f"the shot's frames {start:g} to {end:g} are more than {MAX_FRAMES:,}; name some with --frames"
        )
    return [start + i for i in range(int(steps + _STEP_SLACK) + 1)]


def _read_range(part: str, spec: str) -> tuple[float, float, int]:
    """First frame, stride and number of frames of one range.

    Not by UsdUtils.TimeCodeRange, whose CreateFromFrameSpec of usd-core 26.11 crashes on "1:".
    """
    match = _RANGE.fullmatch(part)
    if match is None:
        raise SettingsError(f"frames {spec!r} cannot be read at {part!r}: expected such as 1:48 or 1,5:9x2")
    start = float(match[1])
    end = float(match[2] or start)
    stride = float(match[3]) if match[3] else math.copysign(1.0, end - start)
    if not all(map(math.isfinite, (start, end, stride))):
        raise SettingsError(f"frames {spec!r} are beyond all numbers at {part!r}")
    if stride == 0 or (end - start) * stride < 0:
        raise SettingsError(f"frames {spec!r} never arrive at {part!r}: from {start:g} to {end:g} by {stride:g}")
    steps = (end - start) / stride
    return start, stride, int(min(steps + _STEP_SLACK, MAX_FRAMES)) + 1


def frame_file_name(pattern: str, time: float) -> str:
    """The file name of one frame.

    Args:
        pattern: a file name, with or without a run of ``#``.
        time: USD time code.
    """

    def number(holder: re.Match[str]) -> str:
        whole, fraction = len(holder[1]), len(holder[2] or "")
        width = whole + fraction + 1 if fraction else whole
        return f"{time:0{width}.{fraction}f}"

    return _NUMBER_HOLDER.sub(number, pattern)


def frame_file_names(pattern: str, frames: Sequence[float]) -> list[str]:
    """The file names of several frames, no two alike.

    Args:
        pattern: a file name, with or without a run of ``#``.
        frames: USD time codes.

    Raises:
        SettingsError: two frames would be written to one file.
    """
    names = [frame_file_name(pattern, time) for time in frames]
    if len(set(names)) == len(names):
        return names
    if not _NUMBER_HOLDER.search(pattern):
        raise SettingsError(
            f"{len(frames)} frames need a place for the frame number in {pattern!r}, such as shot.####.exr"
        )
    raise SettingsError(f"frames with fractions need a place for them in {pattern!r}, such as shot.####.##.exr")
