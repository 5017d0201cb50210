"""Colours and styles that all drawings share, and the encoding of figures."""

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
"""Colours of the beams in a section: axis, middle and edge of the picture."""
LIGHTS = ("#d62718", "#1f9d3a", "#2340d0")
"""Colours of red, green and blue light."""
SMALL, TINY = 7.5, 6.5
DPI = 120
"""Resolution of a PNG, and of pictures inside an SVG."""
_STYLE: dict[Any, Any] = {
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
    "text.parse_math": False,  # a dollar sign in a lens's name is no formula
}


def style() -> AbstractContextManager[None]:
    """Return a context to make and save figures in, independent of the user's matplotlib settings."""
    return matplotlib.style.context(["default", _STYLE])


def encode_figure(figure: Figure, suffix: str) -> bytes:
    """Encode a figure as a file; the same figure always gives the same bytes.

    Args:
        figure: the drawing.
        suffix: ``png`` or ``svg``.
    """
    FigureCanvasAgg(figure)
    sink = io.BytesIO()
    metadata = {"Date": None} if suffix == "svg" else {"Software": "Pullfocus"}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # in names of other scripts: drawn as boxes
        figure.savefig(sink, format=suffix, dpi=DPI, metadata=metadata, facecolor="auto")
    return sink.getvalue()


def draw_message(axes: Axes, text: str) -> None:
    """Draw a text in place of a diagram."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, ha="center", va="center", color=FAINT, wrap=True, transform=axes.transAxes)
