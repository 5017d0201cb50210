"""Chart of a pull: the focus and its depth of field over the frames, and for each focus point when it is sharp."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from render.drawing.page import FAINT, HAIRLINE, INK, SMALL, encode_figure, style
from render.model.arrays import BoolArray, DoubleArray, LongArray

SHARP, SOFT = "#2f8f4e", "#c8442c"
"""Colours of frames in which a point that has to be sharp is so, and is not."""
FOCUS, BAND = "#1f5fa8", "#dce8f5"
MOST_STRIPS = 40
"""Focus points that have a strip."""
_POINTS = ("#b8860b", "#7b4fa3", "#008b8b", "#c2568c", "#5a6b2f", "#8c564b")
_MARKS_M = (
    0.1,
    0.2,
    0.3,
    0.4,
    0.5,
    0.6,
    0.8,
    1.0,
    1.2,
    1.5,
    2.0,
    2.5,
    3.0,
    4.0,
    5.0,
    7.0,
    10.0,
    15.0,
    20.0,
    30.0,
    50.0,
    100.0,
    1e3,
)
_LEAST_GAP = 0.05  # between two marks of the scale, as a share of its height
_NEAREST_M = 1e-3
_WIDE, _TALL, _STRIP, _HEAD, _FOOT = 11.0, 3.6, 0.24, 0.3, 0.55  # inches


@dataclass(frozen=True)
class PointTrack:
    """A focus point over the frames of a chart.

    Attributes:
        name: of the point.
        depths_m: ``(n,)`` along the view axis; NaN, or not positive, where there is none.
        judged: ``(n,)`` whether it has to be sharp.
        sharp: ``(n,)`` whether it is.
    """

    name: str
    depths_m: DoubleArray
    judged: BoolArray
    sharp: BoolArray


@dataclass(frozen=True)
class FocusTrack:
    """The focus over the frames of a chart.

    Attributes:
        frames: ``(n,)`` in rising order.
        focus_m: ``(n,)`` depth of the plane of focus; may be infinite.
        near_m: ``(n,)`` nearest depth that is sharp.
        far_m: ``(n,)`` farthest; may be infinite.
        points: the focus points.
    """

    frames: LongArray
    focus_m: DoubleArray
    near_m: DoubleArray
    far_m: DoubleArray
    points: Sequence[PointTrack]


def draw_focus_chart(track: FocusTrack, suffix: str) -> bytes:
    """Draw the chart of a pull. Its distances are even in their inverses, as on the barrel of a lens, with infinity on top.

    Args:
        track: the pull. Of more than `MOST_STRIPS` points the first ones have a strip.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    strips = track.points[:MOST_STRIPS]
    high = _HEAD + _TALL + _FOOT + _STRIP * len(strips)
    with style():
        figure = Figure(figsize=(_WIDE, high), facecolor="white")
        left, wide = 0.11, 0.87
        curve = figure.add_axes((left, 1 - (_HEAD + _TALL) / high, wide, _TALL / high))
        _draw_curve(curve, track)
        if strips:
            curve.tick_params(labelbottom=False)
            beneath = figure.add_axes((left, _FOOT / high, wide, _STRIP * len(strips) / high), sharex=curve)
            _draw_strips(beneath, track.frames, strips)
            beneath.set_xlabel("frame")
        else:
            curve.set_xlabel("frame")
        return encode_figure(figure, suffix)


def runs(chosen: BoolArray) -> Iterator[tuple[int, int]]:
    """Yield the first and the last index of each run of chosen ones.

    Args:
        chosen: ``(n,)``.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], chosen, [False]]).astype(np.int8)))
    yield from ((int(first), int(end) - 1) for first, end in zip(edges[::2], edges[1::2], strict=True))


def _inverse(distances_m: DoubleArray) -> DoubleArray:
    """1/m; NaN for what is behind the camera."""
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse: DoubleArray = np.where(distances_m > _NEAREST_M, 1 / distances_m, np.nan)
    return inverse


def _draw_curve(axes: Axes, track: FocusTrack) -> None:
    frames = track.frames
    near, far, focus = _inverse(track.near_m), _inverse(track.far_m), _inverse(track.focus_m)
    axes.fill_between(frames, near, far, color=BAND, linewidth=0, label="depth of field")
    depths = [_inverse(point.depths_m) for point in track.points]
    for index, (point, inverse) in enumerate(zip(track.points, depths, strict=True)):
        colour = _POINTS[index % len(_POINTS)]
        axes.plot(frames, inverse, color=colour, linewidth=1.0, linestyle=(0, (1, 1.5)))
        seen = np.flatnonzero(np.isfinite(inverse))
        if len(seen):
            place = (frames[seen[-1]], inverse[seen[-1]])
            axes.annotate(
                point.name, place, (-3, 3), textcoords="offset points", fontsize=SMALL, color=colour, ha="right"
            )
    axes.plot(frames, focus, color=FOCUS, linewidth=1.8, label="focus")
    axes.legend(loc="best")
    shown = np.concatenate([focus, *depths])
    shown = shown[np.isfinite(shown)]
    most = float(shown.max()) if len(shown) else 1.0
    least = float(shown.min()) if len(shown) else 0.0
    room = max(0.08 * (most - least), 0.05 * most, 1e-6)
    axes.set_ylim(most + room, max(least - room, 0.0 if least > 0 else -room))
    _mark_scale(axes)
    margin = max(0.5, 0.01 * (frames[-1] - frames[0]))
    axes.set_xlim(frames[0] - margin, frames[-1] + margin)
    axes.set_ylabel("distance, m")
    axes.grid(color=HAIRLINE, linewidth=0.4)
    axes.set_title("Focus and depth of field", color=INK)


def _mark_scale(axes: Axes) -> None:
    """Mark distances that are far enough from each other, nearest first, and infinity."""
    bottom, top = axes.get_ylim()
    places: list[tuple[float, str]] = [(0.0, "∞")] if top <= 0.0 else []
    for distance in reversed(_MARKS_M):
        inverse = 1 / distance
        if top <= inverse <= bottom and all(abs(inverse - other) > _LEAST_GAP * (bottom - top) for other, _ in places):
            places.append((inverse, f"{distance:g}"))
    axes.set_yticks([place for place, _ in places], [text for _, text in places])


def _draw_strips(axes: Axes, frames: LongArray, points: Sequence[PointTrack]) -> None:
    for row, point in enumerate(points):
        axes.axhline(row, color=HAIRLINE, linewidth=0.5)
        for chosen, colour in ((point.judged & point.sharp, SHARP), (point.judged & ~point.sharp, SOFT)):
            spans = [(frames[first] - 0.5, frames[last] - frames[first] + 1) for first, last in runs(chosen)]
            axes.broken_barh(spans, (row - 0.35, 0.7), facecolors=colour)
    axes.set_ylim(len(points) - 0.5, -0.5)
    axes.set_yticks(range(len(points)), [_short(point.name) for point in points])
    axes.tick_params(left=False)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)
    axes.spines["bottom"].set_color(FAINT)


def _short(name: str) -> str:
    return name if len(name) <= 18 else f"{name[:17]}…"
