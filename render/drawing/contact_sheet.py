"""A contact sheet as a picture: every frame pixel for pixel on a dark table, with what it was taken with below."""

from __future__ import annotations

import math
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from render.drawing.page import DPI, file_of, style
from render.optics.report.data_sheet import metres
from render.output.encode import to_8_bit
from render.pictures.contact_sheet import ContactPicture, ContactSheet

TABLE, TITLE, DATA, RULE = "#161616", "#e4e4e4", "#9a9a9a", "#3a3a3a"
"""Neutral, and darker than middle grey, so that pictures are judged by themselves."""
_MOST_COLUMNS = 4  # where rows have no meaning of their own
_USUAL_PX = 320  # width of a picture that letters are 1 of
_TITLE_PX, _DATA_PX = 11, 9  # height of letters
_WIDEST_WORDS = 420  # the most that a cell widens for its words
_PARTED = "  ·  "
_LETTER = 0.62  # width of a letter over its height, at most on average


@dataclass(frozen=True)
class _Layout:
    """Where everything is, in pixels from the upper left corner.

    Attributes:
        width_px: of a picture.
        height_px: of a picture.
        cell_px: width of a picture with its words below it, which may need more than a small picture has.
        columns: of pictures.
        rows: of pictures.
        scale: of letters and gaps.
    """

    width_px: int
    height_px: int
    cell_px: int
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
        wide = 2 * self.margin + self.columns * self.cell_px + (self.columns - 1) * self.gap
        high = self.head + self.margin + self.rows * (self.height_px + self.label) + (self.rows - 1) * self.gap
        return wide, high

    def corner(self, index: int) -> tuple[int, int]:
        """Upper left corner of a picture."""
        row, column = divmod(index, self.columns)
        return (
            self.margin + column * (self.cell_px + self.gap),
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
    scale = min(max(width / _USUAL_PX, 0.75), 4.0)
    titles = [_width_px(_PARTED.join(_title(sheet, index)), _TITLE_PX) for index in range(count)]
    data = [_width_px(line, _DATA_PX) for picture in sheet.pictures for line in _data(picture)]
    cell = max(width, math.ceil(min(max(*titles, *data), _WIDEST_WORDS) * scale))
    return _Layout(width, height, cell, columns, math.ceil(count / columns), scale)


def _write_head(figure: Figure, sheet: ContactSheet, layout: _Layout) -> None:
    wide, _ = layout.size
    compared = " and ".join(f"{len(axis.choices)} {_PLURALS[axis.name]}" for axis in sheet.axes)
    times = sorted({picture.time for picture in sheet.pictures})
    films = {picture.film for picture in sheet.pictures}
    told = [sheet.stage, sheet.camera_path, *([f"frame {times[0]:g}"] if len(times) == 1 else [])]
    if len(films) == 1 and sheet.axes[0].name != "stock":
        told += films - {""}
    room = wide - 2 * layout.margin
    middle, line = layout.head * 0.40, layout.head * 0.72
    _text(figure, layout, layout.margin, middle, _fitted(compared, room, 15 * layout.scale), TITLE, 15, weight="bold")
    _text(figure, layout, layout.margin, line, _fitted("   ".join(told), room, 9 * layout.scale), DATA, 9)


def _write_label(figure: Figure, layout: _Layout, corner: tuple[int, int], title: list[str], data: list[str]) -> None:
    """A picture's name in one line, its numbers in two, a hairline above."""
    x, y = corner
    wide, high = layout.size
    rule = [1 - (y + 0.5 * layout.scale) / high] * 2
    figure.add_artist(Line2D([x / wide, (x + layout.cell_px) / wide], rule, color=RULE, linewidth=0.6 * layout.scale))
    name = _fitted_title(title, layout.cell_px, _TITLE_PX * layout.scale)
    _text(figure, layout, x, y + 12 * layout.scale, name, TITLE, _TITLE_PX)
    for i, line in enumerate(data):
        below = y + (26.5 + 12.5 * i) * layout.scale
        _text(figure, layout, x, below, _fitted(line, layout.cell_px, _DATA_PX * layout.scale), DATA, _DATA_PX)


def _text(
    figure: Figure, layout: _Layout, x: float, y: float, text: str, color: str, height_px: float, weight: str = "normal"
) -> None:
    """Letters around a line, at places in pixels from the upper left corner."""
    wide, high = layout.size
    points = height_px * layout.scale * 72 / DPI
    figure.text(x / wide, 1 - y / high, text, color=color, fontsize=points, weight=weight, va="center", ha="left")


def _fitted(text: str, width_px: float, height_px: float) -> str:
    """As much of a text as there is room for."""
    most = max(4, int(width_px / (_LETTER * height_px) + 1e-6))
    return text if len(text) <= most else f"{text[: most - 1].rstrip()}…"


def _fitted_title(parts: list[str], width_px: float, height_px: float) -> str:
    """A title with room for something of each part, so that columns and rows can still be told apart."""
    whole = _PARTED.join(parts)
    if _width_px(whole, height_px) <= width_px or len(parts) == 1:
        return _fitted(whole, width_px, height_px)
    room = (width_px - _width_px(_PARTED, height_px)) / len(parts)
    return _PARTED.join(_fitted(part, room, height_px) for part in parts)


def _width_px(text: str, height_px: float) -> float:
    """Room that a text needs, at most."""
    return len(text) * _LETTER * height_px


def _title(sheet: ContactSheet, index: int) -> list[str]:
    """What a picture is of: its column, and its row where rows have a meaning."""
    row, column = divmod(index, len(sheet.axes[0].choices))
    parts = [sheet.axes[0].choices[column].label]
    if len(sheet.axes) > 1:
        parts.append(sheet.axes[1].choices[row].label)
    return parts


def _data(picture: ContactPicture) -> list[str]:
    """What the lens and the exposure are set to, in two lines."""
    lens, exposure = picture.readout, picture.exposure
    told = [f"{lens.focal_length_mm:.3g} mm"]
    if lens.f_stop > 0:
        told.append(f"f/{lens.f_stop:.3g}")
    if exposure.path is not None and exposure.path.transmittance not in (0.0, 1.0):
        told.append(f"T{exposure.path.t_stop:.3g}")
    metered = picture.metered_ev100
    told.append(f"EV {exposure.ev100:.1f}" if metered is None else f"EV {metered:.1f} metered".replace("-", "−"))
    if exposure.nd_stops > 0:
        told.append(f"ND {exposure.nd_stops:.1f} stops")
    if exposure.settings.compensation_stops and metered is None:
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
