"""A contact sheet as a picture: every frame pixel for pixel on a dark table, with what it was taken with below."""

from __future__ import annotations

import math
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from render.drawing.page import DPI, file_of, style
from render.optics.report.data_sheet import metres
from render.output.encode import to_8_bit
from render.shot.contact_sheet import ContactPicture, ContactSheet

TABLE, TITLE, DATA, RULE = "#161616", "#e4e4e4", "#9a9a9a", "#3a3a3a"
"""Neutral, and darker than middle grey, so that pictures are judged by themselves."""
_MOST_COLUMNS = 4  # where rows have no meaning of their own
_USUAL_PX = 320  # width of a picture that letters are 1 of
_LETTER = 0.62  # width of a letter over its height, at most on average


@dataclass(frozen=True)
class _Layout:
    """Where everything is, in pixels from the upper left corner."""

    width_px: int
    height_px: int
    columns: int
    rows: int
    scale: float

    @property
    def margin(self) -> int:
        return round(22 * self.scale)

    @property
    def gap(self) -> int:
        return round(14 * self.scale)

    @property
    def head(self) -> int:
        return round(62 * self.scale)

    @property
    def label(self) -> int:
        """Height of a picture's name and numbers below it."""
        return round(50 * self.scale)

    @property
    def size(self) -> tuple[int, int]:
        wide = 2 * self.margin + self.columns * self.width_px + (self.columns - 1) * self.gap
        high = self.head + self.margin + self.rows * (self.height_px + self.label) + (self.rows - 1) * self.gap
        return wide, high

    def corner(self, index: int) -> tuple[int, int]:
        """Upper left corner of a picture."""
        row, column = divmod(index, self.columns)
        return (
            self.margin + column * (self.width_px + self.gap),
            self.head + row * (self.height_px + self.label + self.gap),
        )


def draw_contact_sheet(sheet: ContactSheet, suffix: str) -> bytes:
    """Draw a sheet.

    Args:
        sheet: with its pictures, which are all of one size.
        suffix: ``png`` or ``svg``.

    Returns:
        The file.
    """
    layout = _layout(sheet)
    wide, high = layout.size
    with style():
        figure = Figure(figsize=(wide / DPI, high / DPI), dpi=DPI, facecolor=TABLE)
        _write_head(figure, sheet, layout)
        for index, picture in enumerate(sheet.pictures):
            x, y = layout.corner(index)
            figure.figimage(to_8_bit(picture.graded), xo=x, yo=high - y - layout.height_px)
            _write_label(figure, layout, (x, y + layout.height_px), _title(sheet, index), _data(picture))
        return file_of(figure, suffix)


def _layout(sheet: ContactSheet) -> _Layout:
    height, width, _ = sheet.pictures[0].graded.shape
    count = len(sheet.pictures)
    columns = len(sheet.axes[0].choices)
    if len(sheet.axes) == 1 and count > _MOST_COLUMNS:
        rows = math.ceil(count / _MOST_COLUMNS)
        columns = math.ceil(count / rows)
    return _Layout(width, height, columns, math.ceil(count / columns), min(max(width / _USUAL_PX, 0.75), 4.0))


def _write_head(figure: Figure, sheet: ContactSheet, layout: _Layout) -> None:
    wide, _ = layout.size
    compared = " and ".join(f"{len(axis.choices)} {_PLURALS[axis.name]}" for axis in sheet.axes)
    times = sorted({picture.time for picture in sheet.pictures})
    films = {picture.film for picture in sheet.pictures}
    told = [sheet.stage, sheet.camera, *([f"frame {times[0]:g}"] if len(times) == 1 else [])]
    if len(films) == 1 and sheet.axes[0].name != "stock":
        told += films - {""}
    room = wide - 2 * layout.margin
    middle, line = layout.head * 0.40, layout.head * 0.72
    _text(figure, layout, layout.margin, middle, _fitted(compared, room, 15 * layout.scale), TITLE, 15, weight="bold")
    _text(figure, layout, layout.margin, line, _fitted("   ".join(told), room, 9 * layout.scale), DATA, 9)


def _write_label(figure: Figure, layout: _Layout, corner: tuple[int, int], title: str, data: list[str]) -> None:
    """A picture's name in one line, its numbers in two, a hairline above."""
    x, y = corner
    wide, high = layout.size
    rule = [1 - (y + 0.5 * layout.scale) / high] * 2
    figure.add_artist(Line2D([x / wide, (x + layout.width_px) / wide], rule, color=RULE, linewidth=0.6 * layout.scale))
    _text(figure, layout, x, y + 12 * layout.scale, _fitted(title, layout.width_px, 11 * layout.scale), TITLE, 11)
    for i, line in enumerate(data):
        below = y + (26.5 + 12.5 * i) * layout.scale
        _text(figure, layout, x, below, _fitted(line, layout.width_px, 9 * layout.scale), DATA, 9)


def _text(
    figure: Figure, layout: _Layout, x: float, y: float, text: str, color: str, height_px: float, weight: str = "normal"
) -> None:
    """Letters around a line, at places in pixels from the upper left corner."""
    wide, high = layout.size
    points = height_px * layout.scale * 72 / DPI
    figure.text(x / wide, 1 - y / high, text, color=color, fontsize=points, weight=weight, va="center", ha="left")


def _fitted(text: str, width_px: float, height_px: float) -> str:
    """As much of a text as there is room for."""
    most = max(4, int(width_px / (_LETTER * height_px)))
    return text if len(text) <= most else f"{text[: most - 1].rstrip()}…"


def _title(sheet: ContactSheet, index: int) -> str:
    row, column = divmod(index, len(sheet.axes[0].choices))
    parts = [sheet.axes[0].choices[column].label]
    if len(sheet.axes) > 1:
        parts.append(sheet.axes[1].choices[row].label)
    return "  ·  ".join(parts)


def _data(picture: ContactPicture) -> list[str]:
    """What the lens and the exposure are set to, in two lines."""
    lens, exposure = picture.readout, picture.exposure
    told = [f"{lens.focal_length_mm:.3g} mm"]
    if lens.f_stop > 0:
        told.append(f"f/{lens.f_stop:.3g}")
    if exposure.path is not None and exposure.path.transmittance not in (0.0, 1.0):
        told.append(f"T{exposure.path.t_stop:.3g}")
    told.append(f"EV {exposure.ev100:.1f}")
    if exposure.nd_stops > 0:
        told.append(f"ND {exposure.nd_stops:.1f} stops")
    if exposure.settings.compensation_stops:
        told.append(f"{exposure.settings.compensation_stops:+.2g} stops".replace("-", "−"))
    if lens.f_stop > 0:
        sharp = f"focus {metres(lens.focus_distance_m)}, sharp {lens.near_m:.3g} to {metres(lens.far_m)}"
    else:
        sharp = "all is sharp"
    return ["   ".join(told), sharp]


_PLURALS = {
    "stock": "stocks",
    "stop": "stops",
    "lens": "lenses",
    "push": "developments",
    "exposure": "exposures",
    "frame": "frames",
}
