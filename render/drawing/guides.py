"""Framing guides over a graded picture, as on the ground glass of a viewfinder.

Guides are frames of other shapes within the gate (`render.optics.framing`), the areas that are safe for action and for titles
(SMPTE ST 2046-1:2009: 93 % and 90 % of width and height), thirds, and a cross in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke

from render.drawing.page import style
from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.near_names import hint
from render.optics.framing import ASPECTS, Gate, framing_guide, shape

SAFE = {"action": 0.93, "title": 0.90}
MARKS = ("safe", "thirds", "center")
"""Guides other than frames."""

_DPI = 100
_REFERENCE_HEIGHT_PX = 540.0  # of a picture with lines of one pixel
_SHADOW = "#000000"
_COLOURS = ("#ffffff", "#ffd54a", "#7fd7ff", "#ff9a8a", "#a8f08c")
Mark = Literal["frame", "safe", "thirds", "center"]
_Corner = Literal["top", "left", "right"]


@dataclass(frozen=True)
class Guide:
    """A framing guide.

    Attributes:
        mark: kind of guide.
        name: of a frame.
        aspect: width over height of a frame as it is shown; 0 for the other marks.
    """

    mark: Mark
    name: str
    aspect: float = 0.0


def parse_guides(names: tuple[str, ...]) -> tuple[Guide, ...]:
    """Parse names of guides.

    Args:
        names: of `ASPECTS` or `MARKS`, or ratios such as ``2.2:1``.

    Raises:
        SettingsError: there is no such guide; the message has the nearest names.
    """
    return tuple(_parse_guide(name) for name in names)


def draw_guides(graded: FloatArray, camera: Camera, guides: tuple[Guide, ...]) -> FloatArray:
    """Draw guides over a graded picture.

    Args:
        graded: ``(height, width, 3)`` encoded for a display, from 0 to 1.
        camera: whose gate the picture shows.
        guides: drawn in this order.

    Returns:
        The same shape, another array.
    """
    height, width = graded.shape[:2]
    gate = Gate(camera.horizontal_aperture_mm / camera.lens.squeeze, camera.vertical_aperture_mm, camera.lens.squeeze)
    with style():
        figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI)
        figure.patch.set_alpha(0.0)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set(xlim=(0, width), ylim=(height, 0))
        for number, guide in enumerate(guides):
            _draw(axes, guide, gate, (width, height), _COLOURS[number % len(_COLOURS)])
        canvas = FigureCanvasAgg(figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        drawn = np.asarray(canvas.buffer_rgba(), np.float32) / 255  # type: ignore[no-untyped-call]
    alpha = drawn[..., 3:]
    return np.asarray(graded * (1 - alpha) + drawn[..., :3] * alpha, np.float32)


def _parse_guide(name: str) -> Guide:
    if name in MARKS:
        return Guide(cast(Mark, name), name)
    try:
        return Guide("frame", name, shape(name))
    except SettingsError as error:
        raise SettingsError(
            f"there is no framing guide named {name!r}: {hint(name, (*ASPECTS, *MARKS))}, or a ratio such as 2.2:1",
            code="unknown_guide",
        ) from error


def _draw(axes: Axes, guide: Guide, gate: Gate, size: tuple[int, int], colour: str) -> None:
    width, height = size
    if guide.mark == "frame":
        frame = framing_guide(gate, guide.aspect, guide.name)
        shares = frame.width_share, frame.height_share
        _frame(axes, size, shares, colour, is_solid=True)
        _name(axes, size, shares, colour, guide.name, "top")
    elif guide.mark == "safe":
        sides: tuple[_Corner, ...] = ("left", "right")  # side by side, or one word lay on the other
        for (name, share), side in zip(SAFE.items(), sides, strict=True):
            _frame(axes, size, (share, share), colour)
            _name(axes, size, (share, share), colour, name, side)
    elif guide.mark == "thirds":
        for part in (1 / 3, 2 / 3):
            axes.plot([width * part] * 2, [0, height], **_line(size, colour))
            axes.plot([0, width], [height * part] * 2, **_line(size, colour))
    else:
        arm = 0.03 * height
        axes.plot([width / 2 - arm, width / 2 + arm], [height / 2] * 2, **_line(size, colour))
        axes.plot([width / 2] * 2, [height / 2 - arm, height / 2 + arm], **_line(size, colour))


def _frame(
    axes: Axes, size: tuple[int, int], shares: tuple[float, float], colour: str, *, is_solid: bool = False
) -> None:
    left, top, across, up = _box(size, shares)
    line = 72 / _DPI * _scale(size)
    inset = 0.5 * _scale(size)  # keeps a frame of the picture's size within it
    axes.add_patch(
        Rectangle(
            (left + inset, top + inset),
            across - 2 * inset,
            up - 2 * inset,
            fill=False,
            edgecolor=colour,
            linewidth=line,
            linestyle="solid" if is_solid else (0, (4, 4)),
            path_effects=[withStroke(linewidth=2 * line, foreground=_SHADOW, alpha=0.5)],
        )
    )


def _name(
    axes: Axes, size: tuple[int, int], shares: tuple[float, float], colour: str, name: str, corner: _Corner
) -> None:
    """Write a frame's name within it: in its top left corner, or at the bottom on the left or right."""
    (left, top, across, up), scale = _box(size, shares), _scale(size)
    axes.text(
        left + across - 6 * scale if corner == "right" else left + 6 * scale,
        top + 5 * scale if corner == "top" else top + up - 5 * scale,
        name,
        color=colour,
        fontsize=72 / _DPI * 11 * scale,
        ha="right" if corner == "right" else "left",
        va="top" if corner == "top" else "bottom",
        path_effects=[withStroke(linewidth=72 / _DPI * 2.5 * scale, foreground=_SHADOW, alpha=0.6)],
    )


def _box(size: tuple[int, int], shares: tuple[float, float]) -> tuple[float, float, float, float]:
    """Left, top, width and height in pixels of a central share of the picture."""
    (width, height), (across, up) = size, shares
    return (1 - across) / 2 * width, (1 - up) / 2 * height, across * width, up * height


def _line(size: tuple[int, int], colour: str) -> dict[str, Any]:
    width = 72 / _DPI * _scale(size)
    shadow = withStroke(linewidth=2 * width, foreground=_SHADOW, alpha=0.5)
    return {"color": colour, "linewidth": width, "alpha": 0.8, "path_effects": [shadow]}


def _scale(size: tuple[int, int]) -> float:
    return max(0.75, size[1] / _REFERENCE_HEIGHT_PX)
