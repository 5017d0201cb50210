"""Time and memory of blurs against their radius."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

from render.drawing.page import BEAMS, HAIRLINE, INK, encode_figure, style

_SIZE_INCHES = (9.0, 3.6)
_PLAIN = FuncFormatter(lambda value, _: f"{value:g}")  # powers would be set as formulas, which the page has off


def draw_blur_growth(
    title: str,
    radii: Sequence[float],
    times_ms: Mapping[str, Sequence[float]],
    memory_mb: Sequence[float],
    bound_mb: float,
    suffix: str,
) -> bytes:
    """Draw them.

    Args:
        title: of the drawing.
        radii: in pixels.
        times_ms: times of each blur by its name; each pair of them is one colour, the second dashed.
        memory_mb: that the linear one holds.
        bound_mb: limit on its contributions, unless the fewest rows need more.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    with style():
        figure = Figure(figsize=_SIZE_INCHES, layout="constrained")
        figure.suptitle(title, fontsize=9)
        left, right = figure.subplots(1, 2, width_ratios=(3, 2))
        for index, (name, times) in enumerate(times_ms.items()):
            line = "--" if index % 2 else "-"
            left.plot(radii, times, line, color=BEAMS[index // 2 * 2], marker="o", markersize=3, label=name)
        left.set_yscale("log")
        left.yaxis.set_major_formatter(_PLAIN)
        left.yaxis.set_minor_formatter(NullFormatter())
        _along_radii(left, radii)
        left.set_title("Time")
        left.set_ylabel("ms")
        left.legend(loc="upper left")
        right.plot(radii, memory_mb, color=INK, marker="o", markersize=3, label="held at once")
        right.axhline(bound_mb, color=BEAMS[2], linestyle=":", label="most for piles")
        right.set_ylim(0, 1.25 * max(*memory_mb, bound_mb))
        _along_radii(right, radii)
        right.set_title("Memory of FLAG")
        right.set_ylabel("MB")
        right.legend(loc="upper left")
        return encode_figure(figure, suffix)


def _along_radii(axes: Axes, radii: Sequence[float]) -> None:
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(FixedLocator([float(radius) for radius in radii]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(_PLAIN)
    axes.set_xlabel("radius, px")
    axes.grid(color=HAIRLINE, linewidth=0.4)
