"""Section of a lens: glass, stop, film, and rays to three places of the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from render.drawing.page import BEAMS, FAINT, INK, SMALL, TINY, encode_figure, style
from render.model.camera import Camera
from render.optics.prescription.focusing import FocusedLens
from render.optics.report import LensReport
from render.optics.report.section import LensSection, lens_section

_LOW_INDEX, _HIGH_INDEX = 1.45, 1.9
_ROOM = 0.04  # margin on both sides, as a share of the length
_HEADROOM = 1.22  # height of the drawing over the taller of glass and film
_SMALL_INCHES = (3.6, 1.5)
_ABOVE = 0.027  # height of the rows of names, as a share of the sheet
_ROWS = 3
_LETTER_WIDTH = 0.6  # as a share of its height


@dataclass(frozen=True)
class Palette:
    """Colours of a section.

    Attributes:
        paper: background.
        ink: of outlines, stop and film.
        glass: of glass of low index.
        dense_glass: of glass of high index.
        beams: of the rays.
    """

    paper: str
    ink: str
    glass: str
    dense_glass: str
    beams: tuple[str, str, str]


_ON_WHITE = Palette("white", INK, "#e3eef8", "#a9c6e0", BEAMS)
_ON_DARK = Palette("#2b2b2b", "#d8d8d8", "#35495c", "#4d7192", ("#74b0f4", "#6cc98c", "#f4907a"))


def draw_section(axes: Axes, report: LensReport, *, sideways: bool = False) -> None:
    """Draw and label a lens's section; z and y have one scale, in millimetres.

    Args:
        axes: to draw into.
        report: of the lens.
        sideways: cut a lens with cylinders from side to side.
    """
    section = lens_section(report.camera, sideways=sideways)
    _draw(axes, section, _ON_WHITE, width=0.7)
    _label_beams(axes, section)
    if report.focused is not None and not sideways:
        _mark_points(axes, report.focused)
    axes.text(
        section.film_mm[0], 1.02 * section.film_mm[1], "film", ha="center", va="bottom", fontsize=SMALL, color=INK
    )
    axes.set_xlabel("mm along the axis, from the front vertex at infinity focus" if section.glasses else "mm")
    axes.set_ylabel("mm")
    axes.set_anchor("W")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_section_svg(camera: Camera) -> bytes:
    """Draw the section of a camera's lens as a small SVG without words, for a dark page.

    Raises:
        InputError: the lens has no focal length.
        SettingsError: it does not reach the focus distance.
    """
    section = lens_section(camera)
    with style():
        figure = Figure(figsize=_SMALL_INCHES, facecolor=_ON_DARK.paper)
        axes = figure.add_axes((0, 0, 1, 1))
        _draw(axes, section, _ON_DARK, width=0.5)
        axes.set_axis_off()
        return encode_figure(figure, "svg")


def _draw(axes: Axes, section: LensSection, colours: Palette, width: float) -> None:
    lead = min(float(ray.points_mm[0, 0]) for beam in section.beams for ray in beam.rays)
    film, lit = section.film_mm
    room = _ROOM * (film - lead)
    tall = _HEADROOM * max(section.rim_mm, lit, section.stop_mm[1])
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(lead, film + room)
    axes.set_ylim(-tall, tall)
    axes.axhline(0, color=FAINT, linewidth=0.5, dashes=(12, 3, 2, 3))
    edge_width = 0.8 * width + 0.2
    for outline, index in section.glasses:
        tint = _tint(index, colours)
        axes.add_patch(Polygon(outline, facecolor=tint, edgecolor=colours.ink, linewidth=edge_width, zorder=2))
    for beam, colour in zip(section.beams, colours.beams, strict=True):
        for ray in beam.rays:
            faint = 0.35 if ray.blocked else 0.9
            axes.plot(*ray.points_mm.T, color=colour, linewidth=width, alpha=faint, zorder=3, solid_joinstyle="round")
            if ray.blocked:
                axes.plot(*ray.points_mm[-1], "x", color=colour, markersize=4 * width, markeredgewidth=width, zorder=4)
    if not section.glasses:
        _draw_thin_lens(axes, section, colours.ink, width)
    _draw_stop(axes, section, colours.ink, tall, width)
    axes.plot([film, film], [-lit, lit], color=colours.ink, linewidth=2.5 * width, solid_capstyle="butt", zorder=4)


def _tint(index: float, colours: Palette) -> tuple[float, float, float]:
    """Colour of a glass, darker for a higher index."""
    share = np.clip((index - _LOW_INDEX) / (_HIGH_INDEX - _LOW_INDEX), 0, 1)
    red, green, blue = (1 - share) * np.array(to_rgb(colours.glass)) + share * np.array(to_rgb(colours.dense_glass))
    return float(red), float(green), float(blue)


def _draw_thin_lens(axes: Axes, section: LensSection, ink: str, width: float) -> None:
    z, radius = section.stop_mm
    if radius:
        ends = {"arrowstyle": "<->", "color": ink, "linewidth": 2 * width, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (z, radius * 1.04), (z, -radius * 1.04), arrowprops=ends, zorder=4)


def _draw_stop(axes: Axes, section: LensSection, ink: str, tall: float, width: float) -> None:
    """Draw the stop as two bars beside the opening, with feet along the axis as in technical drawings."""
    z, radius = section.stop_mm
    if not section.glasses and radius:
        return
    outer = max(min(1.25 * radius + 0.05 * section.rim_mm, tall), radius + 0.08 * tall)
    foot = 0.012 * (section.film_mm[0] - z)
    for sign in (-1, 1):
        axes.plot(
            [z, z], [sign * radius, sign * outer], color=ink, linewidth=3 * width, solid_capstyle="butt", zorder=5
        )
        axes.plot([z - foot, z + foot], [sign * radius] * 2, color=ink, linewidth=1.5 * width, zorder=5)


def _label_beams(axes: Axes, section: LensSection) -> None:
    lines = [
        axes.plot(
            [], [], color=colour, linewidth=1.2, label=f"{beam.height_mm:.1f} mm off the axis, {beam.angle_deg:.1f}°"
        )[0]
        for beam, colour in zip(section.beams, BEAMS, strict=True)
    ]
    lines[0].set_label("on the axis")
    if any(ray.blocked for beam in section.beams for ray in beam.rays):
        lines.append(axes.plot([], [], "x", color=FAINT, markersize=4, label="blocked by a rim")[0])
    room = axes.get_position(original=True)
    axes.figure.legend(
        handles=lines, loc="lower right", bbox_to_anchor=(room.x1, room.y1 + _ABOVE), ncols=4, handlelength=1.4
    )


def _letter_mm(axes: Axes) -> float:
    """Width of a letter in millimetres of the drawing."""
    room, sheet = axes.get_position(original=True), axes.get_figure(root=True)
    width, height = sheet.get_size_inches() if sheet is not None else (1.0, 1.0)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    mm_per_inch = max((right - left) / (room.width * width), (high - low) / (room.height * height))
    return float(mm_per_inch * _LETTER_WIDTH * TINY / 72)


def _mark_points(axes: Axes, lens: FocusedLens) -> None:
    """Mark principal planes and pupils within the drawing, with names above it, in rows where they are close."""
    left, right = axes.get_xlim()
    front = float(lens.vertices_mm[0])
    planes = {
        "H": front + lens.first.front_principal_mm,
        "H′": front + lens.first.rear_principal_mm,
        "entrance pupil": lens.entrance_pupil_mm,
        "exit pupil": lens.exit_pupil_mm,
    }
    ends = [-math.inf] * _ROWS  # of the last name in each row
    for z, name in sorted((z, name) for name, z in planes.items() if math.isfinite(z) and left < z < right):
        half = (0.5 + len(name) / 2) * _letter_mm(axes)
        row = next((row for row in range(_ROWS) if z - half > ends[row]), _ROWS - 1)
        ends[row] = z + half
        axes.plot(
            [z, z], [0, 1], color=FAINT, linewidth=0.5, dashes=(2, 2), zorder=1, transform=axes.get_xaxis_transform()
        )
        axes.annotate(
            name, (z, 1.0), xycoords=axes.get_xaxis_transform(), xytext=(0, 1 + 8 * row), textcoords="offset points",
            ha="center", va="bottom", fontsize=TINY, color=INK,
        )  # fmt: skip
