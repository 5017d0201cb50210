"""What all drawings share: colours, letters, and how a figure becomes a file."""

from __future__ import annotations

import io
import warnings
from contextlib import AbstractContextManager
from typing import Any

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, FAINT, HAIRLINE = "#222222", "#777777", "#cccccc"
BEAMS = ("#1f5fa8", "#2f8f4e", "#c8442c")
"""Of the beams in a section: axis, middle and edge of the picture."""
LIGHTS = ("#d62718", "#1f9d3a", "#2340d0")
"""Of red, green and blue light."""
SMALL, TINY = 7.5, 6.5
DPI = 120
"""Of a PNG, and of pictures inside an SVG."""
_LETTERS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.6,
    "axes.labelsize": SMALL,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "xtick.labelsize": SMALL,
    "ytick.labelsize": SMALL,
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.fontsize": SMALL,
    "legend.frameon": False,
    "svg.hashsalt": "pullfocus",
    "text.parse_math": False,  # a dollar sign in a lens's name is one
}


def style() -> AbstractContextManager[None]:
    """The context to make and save a figure in: whatever the user's own matplotlib says."""
    return matplotlib.style.context(["default", _LETTERS])


def file_of(figure: Figure, suffix: str) -> bytes:
    """The figure as a file's bytes; the same figure always gives the same bytes.

    Args:
        figure: the drawing.
        suffix: ``png`` or ``svg``.
    """
    FigureCanvasAgg(figure)
    sink = io.BytesIO()
    metadata = {"Date": None} if suffix == "svg" else {"Software": "Pullfocus"}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # in names that other scripts write: boxes stand for them
        figure.savefig(sink, format=suffix, dpi=DPI, metadata=metadata, facecolor="auto")
    return sink.getvalue()


def say_instead(axes: Axes, text: str) -> None:
    """Words where there is nothing to draw."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, ha="center", va="center", color=FAINT, wrap=True, transform=axes.transAxes)
