"""Facts about a picture, burnt into its corners: white on a dark strip, line by line."""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Iterator

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from matplotlib.transforms import IdentityTransform

from render.drawing.page import style
from render.model.arrays import FloatArray
from render.model.burn_in import BurnIn
from render.output.burn_in import Corner, burnt_lines
from render.output.metadata import FrameMetadata

LINE_PX = 20.0
"""Height of a line in a picture that is 540 px high."""

_REFERENCE_HEIGHT_PX = 540.0
_DPI = 100
_TEXT_PX, _BASELINE_PX, _MARGIN_PX = 12.0, 14.0, 6.0
_WIDEST = 0.48  # share of the picture's width
_DARKNESS = 0.6
_MOST_CHARACTERS = 300  # of a line


def draw_burn_in(graded: FloatArray, burn_in: BurnIn, metadata: FrameMetadata) -> FloatArray:
    """Burn facts into a graded picture.

    Args:
        graded: ``(height, width, 3)`` encoded for a display, from 0 to 1.
        burn_in: what is burnt in.
        metadata: of the picture.

    Returns:
        The same shape, another array; only the lines at its upper and lower edge differ.
    """
    height, width = graded.shape[:2]
    lines, burnt = burnt_lines(burn_in, metadata), graded.copy()
    scale = max(0.75, height / _REFERENCE_HEIGHT_PX)
    sides: tuple[tuple[Corner, Corner], ...] = (("top_left", "top_right"), ("bottom_left", "bottom_right"))
    for edge, (left, right) in zip(("top", "bottom"), sides, strict=True):
        columns = lines.get(left, ()), lines.get(right, ())
        deep = min(math.ceil(max(map(len, columns)) * LINE_PX * scale), height)
        if deep > 0:
            strip = burnt[:deep] if edge == "top" else burnt[height - deep :]
            drawn = _draw_strip(width, deep, scale, columns, hangs=edge == "top")
            alpha = drawn[..., 3:]
            strip[:] = strip * (1 - alpha) + drawn[..., :3] * alpha
    return burnt


def _draw_strip(
    width: int, height: int, scale: float, columns: tuple[tuple[str, ...], tuple[str, ...]], *, hangs: bool
) -> FloatArray:
    """Draw the lines at the left and right end of a strip, from its top on where it hangs, else down to its bottom.

    Returns:
        ``(height, width, 4)``, from 0 to 1.
    """
    line = LINE_PX * scale
    with style():
        figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
        figure.patch.set_alpha(0.0)
        canvas = FigureCanvasAgg(figure)
        for is_right, lines in enumerate(columns):
            tops = [at * line if hangs else height - (len(lines) - at) * line for at in range(len(lines))]
            for top, said in zip(tops, lines, strict=True):
                for artist in _draw_line(figure, said, top, scale, is_right=bool(is_right)):
                    figure.add_artist(artist)
        canvas.draw()  # type: ignore[no-untyped-call]
        return np.asarray(canvas.buffer_rgba(), np.float32) / np.float32(255)  # type: ignore[no-untyped-call]


def _draw_line(figure: Figure, said: str, top: float, scale: float, *, is_right: bool) -> Iterator[Rectangle | Text]:
    """Yield a line's dark strip and its text, which is shortened to what there is room for."""
    width, height = figure.bbox.width, figure.bbox.height
    margin, line = _MARGIN_PX * scale, LINE_PX * scale
    text = Text(
        width - margin if is_right else margin,
        height - top - _BASELINE_PX * scale,
        said,
        color="#ffffff",
        fontsize=72 / _DPI * _TEXT_PX * scale,
        ha="right" if is_right else "left",
        va="baseline",
        figure=figure,
        transform=IdentityTransform(),  # pixels
    )
    room = _WIDEST * width - 2 * margin
    if len(said) > _MOST_CHARACTERS or text.get_window_extent().width > room:
        # the most characters that fit, found in a few steps: names come from files
        fitting = bisect(range(min(len(said), _MOST_CHARACTERS)), room, key=lambda count: _width(text, said, count))
        _width(text, said, max(fitting - 1, 0))
    wide = text.get_window_extent().width + 2 * margin
    left = width - wide if is_right else 0.0
    corner, pixels = (left, height - top - line), IdentityTransform()
    yield Rectangle(corner, wide, line, facecolor="#000000", alpha=_DARKNESS, linewidth=0, transform=pixels)
    yield text


def _width(text: Text, said: str, count: int) -> float:
    """Shorten a text to so many of the characters that it is to say, and return its width, px."""
    text.set_text(said[:count] + "…")
    return text.get_window_extent().width
