"""Contact sheet as a picture: every frame pixel for pixel on a dark background, with lens and exposure below it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from render.drawing.page import DPI, encode_figure, style
from render.optics.report.data_sheet import metres
from render.output.encode import to_8_bit
from render.pictures.contact_sheet import ContactPicture, ContactSheet

TABLE, TITLE, DATA, RULE = "#161616", "#e4e4e4", "#9a9a9a", "#3a3a3a"
"""Neutral colours with a background darker than middle grey, so that they do not affect how pictures look."""
_MAX_COLUMNS = 4  # of a sheet with one axis
_REFERENCE_PX = 320  # width of a picture at scale 1
_TITLE_PX, _DATA_PX = 11, 9  # heights of letters at scale 1
_MAX_TEXT_PX = 420  # widest cell that a text makes, at scale 1
_SEPARATOR = "  ·  "
_LETTER = 0.62  # width of a letter over its height, an upper bound of the average


@dataclass(frozen=True)
class _Layout:
    """Layout of a sheet, in pixels from the upper left corner.

    Attributes:
        width_px: of a picture.
        height_px: of a picture.
        cell_px: width of a picture with the text below it, which may be wider than a small picture.
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
        sheet: its pictures are all of one size.
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
        return encode_figure(figure, suffix)


def _layout(sheet: ContactSheet) -> _Layout:
    height, width, _ = sheet.pictures[0].graded.shape
    count = len(sheet.pictures)
    columns = len(sheet.axes[0].choices)
    if len(sheet.axes) == 1 and count > _MAX_COLUMNS:
        rows = math.ceil(count / _MAX_COLUMNS)
        columns = math.ceil(count / rows)
    scale = min(max(width / _REFERENCE_PX, 0.75), 4.0)
    titles = [_width_px(_SEPARATOR.join(_title(sheet, index)), _TITLE_PX) for index in range(count)]
    data = [_width_px(line, _DATA_PX) for picture in sheet.pictures for line in _data(picture)]
    cell = max(width, math.ceil(min(max(*titles, *data), _MAX_TEXT_PX) * scale))
    return _Layout(width, height, cell, columns, math.ceil(count / columns), scale)


def _write_head(figure: Figure, sheet: ContactSheet, layout: _Layout) -> None:
    wide, _ = layout.size
    compared = " and ".join(f"{len(axis.choices)} {_PLURALS[axis.name]}" for axis in sheet.axes)
    times = sorted({picture.metadata.time for picture in sheet.pictures})
    films = {picture.film for picture in sheet.pictures}
    details = [sheet.stage, sheet.camera_path, *([f"frame {times[0]:g}"] if len(times) == 1 else [])]
    if len(films) == 1 and sheet.axes[0].name != "stock":
        details += films - {""}
    room = wide - 2 * layout.margin
    middle, line = layout.head * 0.40, layout.head * 0.72
    _text(figure, layout, layout.margin, middle, _shorten(compared, room, 15 * layout.scale), TITLE, 15, weight="bold")
    _text(figure, layout, layout.margin, line, _shorten("   ".join(details), room, 9 * layout.scale), DATA, 9)


def _write_label(figure: Figure, layout: _Layout, corner: tuple[int, int], title: list[str], data: list[str]) -> None:
    """Write a picture's name in one line and its numbers in two, with a hairline above."""
    x, y = corner
    wide, high = layout.size
    rule = [1 - (y + 0.5 * layout.scale) / high] * 2
    figure.add_artist(Line2D([x / wide, (x + layout.cell_px) / wide], rule, color=RULE, linewidth=0.6 * layout.scale))
    name = _shorten_title(title, layout.cell_px, _TITLE_PX * layout.scale)
    _text(figure, layout, x, y + 12 * layout.scale, name, TITLE, _TITLE_PX)
    for i, line in enumerate(data):
        below = y + (26.5 + 12.5 * i) * layout.scale
        _text(figure, layout, x, below, _shorten(line, layout.cell_px, _DATA_PX * layout.scale), DATA, _DATA_PX)


def _text(
    figure: Figure, layout: _Layout, x: float, y: float, text: str, color: str, height_px: float, weight: str = "normal"
) -> None:
    """Write text, vertically centred, at a position in pixels from the upper left corner."""
    wide, high = layout.size
    points = height_px * layout.scale * 72 / DPI
    figure.text(x / wide, 1 - y / high, text, color=color, fontsize=points, weight=weight, va="center", ha="left")


def _shorten(text: str, width_px: float, height_px: float) -> str:
    """Shorten a text to the room there is."""
    most = max(4, int(width_px / (_LETTER * height_px) + 1e-6))
    return text if len(text) <= most else f"{text[: most - 1].rstrip()}…"


def _shorten_title(parts: list[str], width_px: float, height_px: float) -> str:
    """Shorten a title part by part, so that columns and rows can still be told apart."""
    whole = _SEPARATOR.join(parts)
    if _width_px(whole, height_px) <= width_px or len(parts) == 1:
        return _shorten(whole, width_px, height_px)
    room = (width_px - _width_px(_SEPARATOR, height_px)) / len(parts)
    return _SEPARATOR.join(_shorten(part, room, height_px) for part in parts)


def _width_px(text: str, height_px: float) -> float:
    """Largest width of a text."""
    return len(text) * _LETTER * height_px


def _title(sheet: ContactSheet, index: int) -> list[str]:
    """Labels of a picture: of its column, and of its row on a sheet with two axes."""
    row, column = divmod(index, len(sheet.axes[0].choices))
    parts = [sheet.axes[0].choices[column].label]
    if len(sheet.axes) > 1:
        parts.append(sheet.axes[1].choices[row].label)
    return parts


def _data(picture: ContactPicture) -> list[str]:
    """Settings of lens and exposure in two lines."""
    lens, exposure = picture.readout, picture.exposure
    settings = [f"{lens.focal_length_mm:.3g} mm"]
    if lens.f_stop > 0:
        settings.append(f"f/{lens.f_stop:.3g}")
    if exposure.path is not None and exposure.path.transmittance not in (0.0, 1.0):
        settings.append(f"T{exposure.path.t_stop:.3g}")
    metered = picture.metered_ev100
    settings.append(f"EV {exposure.ev100:.1f}" if metered is None else f"EV {metered:.1f} metered".replace("-", "−"))
    if exposure.nd_stops > 0:
        settings.append(f"ND {exposure.nd_stops:.1f} stops")
    if exposure.settings.compensation_stops and metered is None:
        settings.append(f"{exposure.settings.compensation_stops:+.2g} stops".replace("-", "−"))
    if lens.f_stop > 0:
        sharp = f"focus {metres(lens.focus_distance_m)}, sharp {lens.near_m:.3g} to {metres(lens.far_m)}"
    else:
        sharp = "all is sharp"
    return ["   ".join(settings), sharp]


_PLURALS = {
    "stock": "stocks",
    "stop": "stops",
    "lens": "lenses",
    "push": "developments",
    "exposure": "exposures",
    "frame": "frames",
}
