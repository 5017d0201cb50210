"""Plot of quality and time against the share of changes that is spread: Fearing's figure 4 (1995)."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from render.drawing.page import BEAMS, DPI, FAINT, HAIRLINE, TINY, encode_figure, style
from render.lab.bench.importance.results import ImportanceBench

_ROOM_DB = 4.0


def draw_cutoff(bench: ImportanceBench, suffix: str = "png") -> bytes:
    """Draw quality and time against the share of changes made.

    Args:
        bench: by the bench.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    with style():
        figure = Figure(figsize=(860 / DPI, 400 / DPI), dpi=DPI, layout="constrained")
        quality, time = figure.subplots(1, 2)
        _draw_quality(quality, bench)
        _draw_time(time, bench)
        for axes in (quality, time):
            axes.set_xlabel("M: share of the changed pixels spread anew, %")
            axes.set_xlim(0, 104)
            axes.grid(color=HAIRLINE, linewidth=0.5)
            axes.spines[["top", "right"]].set_visible(False)
        return encode_figure(figure, suffix)


def _draw_quality(axes: Axes, bench: ImportanceBench) -> None:
    finite = [row.psnr_db for row in bench.cutoff if row.psnr_db is not None]
    top = max(finite, default=40.0) + _ROOM_DB
    for name, color, marker, values in (
        ("last frame", BEAMS[0], "o", [row.psnr_db for row in bench.cutoff]),
        ("worst frame", BEAMS[2], "s", [row.worst_psnr_db for row in bench.cutoff]),
    ):
        known = [(row.m, value) for row, value in zip(bench.cutoff, values, strict=True) if value is not None]
        axes.plot(*zip(*known, strict=True), color=color, marker=marker, markersize=3.5, linewidth=1.2, label=name)
    for row in bench.cutoff:
        if row.psnr_db is None:
            axes.annotate(
                "equal",
                (row.m, top),
                color=FAINT,
                fontsize=TINY,
                ha="right",
                va="top",
                xytext=(0, -2),
                textcoords="offset points",
            )
            axes.axvline(row.m, color=FAINT, linewidth=0.8, linestyle=":")
    axes.set_ylim(top=top)
    axes.set_title("Likeness to the linear method")
    axes.set_ylabel("PSNR, dB")
    axes.legend(loc="upper left")


def _draw_time(axes: Axes, bench: ImportanceBench) -> None:
    axes.plot(
        [row.m for row in bench.cutoff],
        [row.seconds for row in bench.cutoff],
        color=BEAMS[0],
        marker="o",
        markersize=3.5,
        linewidth=1.2,
    )
    axes.set_ylim(bottom=0)
    axes.set_title("Time of the whole animation")
    axes.set_ylabel("s")
