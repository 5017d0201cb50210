"""Contact sheet of frames that were drawn before: small pictures in the order of their frames, each with its number."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from render.drawing.contact_sheet import DATA, TABLE, TITLE
from render.drawing.page import DPI, encode_figure, style
from render.errors import one_line

MOST_PICTURES = 96
"""Pictures on a sheet."""
_MARGIN_PX, _GAP_PX, _HEAD_PX, _LABEL_PX = 22, 10, 56, 22
_LETTER_PX = 7.0  # average width of a letter of the head line


def choose_frames(frames: Sequence[int]) -> list[int]:
    """Choose the frames of a sheet: all, or `MOST_PICTURES` at even distances, the first and the last one among them.

    Args:
        frames: in rising order.
    """
    count = len(frames)
    if count <= MOST_PICTURES:
        return list(frames)
    return [frames[round(index * (count - 1) / (MOST_PICTURES - 1))] for index in range(MOST_PICTURES)]


def draw_frame_sheet(title: str, pictures: Sequence[tuple[int, NDArray[np.uint8]]], count: int) -> bytes:
    """Draw a sheet as PNG.

    Args:
        title: head line.
        pictures: numbers of the frames and their pictures, all of one size, ``(height, width, 3)``.
        count: number of frames that they were chosen from.
    """
    height, width, _ = pictures[0][1].shape
    cell = max(width, 48)
    columns = _columns(len(pictures), cell / (height + _LABEL_PX))
    rows = math.ceil(len(pictures) / columns)
    wide = 2 * _MARGIN_PX + columns * (cell + _GAP_PX) - _GAP_PX
    high = _HEAD_PX + rows * (height + _LABEL_PX + _GAP_PX) - _GAP_PX + _MARGIN_PX
    with style():
        figure = Figure(figsize=(wide / DPI, high / DPI), dpi=DPI, facecolor=TABLE)

        def write(x: float, y: float, text: str, size_px: float, colour: str) -> None:
            room = max(4, int((wide - _MARGIN_PX - x) / (_LETTER_PX * size_px / 11)))
            shown = text if len(text) <= room else f"{text[: room - 1]}…"
            figure.text(x / wide, 1 - y / high, shown, color=colour, fontsize=size_px * 72 / DPI, va="center")

        write(_MARGIN_PX, 22, one_line(title), 13, TITLE)
        chosen = f"{len(pictures)} of {count} frames" if len(pictures) < count else f"{count} frames"
        write(_MARGIN_PX, 40, "1 frame" if count == 1 else chosen, 9, DATA)
        for index, (frame, pixels) in enumerate(pictures):
            row, column = divmod(index, columns)
            x, y = _MARGIN_PX + column * (cell + _GAP_PX), _HEAD_PX + row * (height + _LABEL_PX + _GAP_PX)
            figure.figimage(pixels, xo=x, yo=high - y - height)
            write(x, y + height + 0.5 * _LABEL_PX, str(frame), 10, TITLE)
        return encode_figure(figure, "png")


def _columns(count: int, aspect: float) -> int:
    """Number of columns of a sheet about as wide as a screen: 16 to 9."""
    return min(count, max(1, round(math.sqrt(count * 16 / 9 / aspect))))
