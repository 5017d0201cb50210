"""Facts about a picture in words, as they are burnt into its corners: those of the page's overlay."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Literal

from render.model.burn_in import BurnIn, Fact
from render.output.metadata import FrameMetadata
from render.output.movie import time_code_of
from usd_schemas import SchemaError, library_film

Corner = Literal["top_left", "top_right", "bottom_left", "bottom_right"]

_LINES: dict[Corner, tuple[tuple[Fact, ...], ...]] = {
    "top_left": (("shot",), ("camera",)),
    "top_right": (("lens",), ("focal", "stop", "focus", "focusFt")),
    "bottom_left": (("film",), ("revision", "date")),
    "bottom_right": (("frame", "timecode"),),
}
"""Facts of each corner, line by line; those of one line stand side by side."""
_SEPARATOR = " · "
_REVISION_DIGITS = 8
_METRES_PER_INCH = 0.0254


def burnt_lines(burn_in: BurnIn, metadata: FrameMetadata) -> dict[Corner, tuple[str, ...]]:
    """Return the lines of each corner that has any.

    Args:
        burn_in: what is burnt in.
        metadata: of the picture.
    """
    words = {fact: _words(fact, burn_in, metadata) for fact in burn_in.facts}
    corners = {}
    for corner, lines in _LINES.items():
        said = [_SEPARATOR.join(filter(None, (words.get(fact, "") for fact in line))) for line in lines]
        if any(said):
            corners[corner] = tuple(filter(None, said))
    return corners


def _words(fact: Fact, burn_in: BurnIn, metadata: FrameMetadata) -> str:
    """Word one fact; empty where the picture has none."""
    camera = metadata.camera
    match fact:
        case "shot":
            return burn_in.shot or metadata.stage
        case "camera":
            return camera.path.rpartition("/")[2] or "framing camera"
        case "lens":
            return camera.lens.name or f"{camera.lens.model} lens"
        case "focal":
            return "" if camera.orthographic else f"{_trimmed(camera.focal_length_mm, 1)} mm"
        case "stop":
            return _stop(metadata)
        case "focus":
            return f"focus {_metres(camera.stated_focus_m)}"
        case "focusFt":
            return f"focus {_feet(camera.stated_focus_m)}"
        case "film":
            return _film(metadata)
        case "revision":
            return burn_in.revision and f"rev {burn_in.revision[:_REVISION_DIGITS]}"
        case "date":
            return burn_in.day
        case "frame":
            return "" if math.isnan(metadata.time) else f"frame {_frame(metadata.time)}"
        case "timecode":
            return "" if math.isnan(metadata.time) else _time_code(metadata)


def _stop(metadata: FrameMetadata) -> str:
    if metadata.camera.f_stop == 0:
        return "pinhole"
    if metadata.t_stop is not None:
        return f"T {_trimmed(metadata.t_stop, 2)}"
    return f"f/{_trimmed(metadata.camera.f_stop, 2)}"


def _film(metadata: FrameMetadata) -> str:
    film = metadata.film
    if film is None or film.stock is None:
        return "digital" if film is not None and film.process == "digital" else ""
    try:
        return library_film(film.stock.name).title
    except SchemaError:  # it is one of the shot's own
        return film.stock.name


def _frame(time: float) -> str:
    return f"{time:.0f}" if time % 1 == 0 else f"{time:.2f}"


def _time_code(metadata: FrameMetadata) -> str:
    """Word the time code of a frame, or of the whole frame before."""
    return time_code_of([float(math.floor(metadata.time + 1e-6))], Fraction(metadata.time_codes_per_second))


def _metres(distance_m: float) -> str:
    """Word a distance in metres with about three digits."""
    if not math.isfinite(distance_m):
        return "∞"
    size = abs(distance_m)
    return f"{distance_m:.{3 if size < 1 else 2 if size < 10 else 1 if size < 100 else 0}f} m"


def _feet(distance_m: float) -> str:
    """Word a distance in feet and inches."""
    if not math.isfinite(distance_m):
        return "∞"
    sign, inches = "−" if distance_m < 0 else "", abs(distance_m) / _METRES_PER_INCH
    if inches >= 12 * 100:
        return f"{sign}{inches / 12:.0f}′"
    places = 1 if inches < 36 else 0
    whole = round(inches, places)
    feet, rest = divmod(whole, 12)
    words = f"{_trimmed(rest, places)}″"
    return f"{sign}{feet:.0f}′ {words}" if feet > 0 else f"{sign}{words}"


def _trimmed(value: float, decimals: int) -> str:
    """Word a number without zeros at its end."""
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text
