"""Aberrations one at a time: a thin lens with one wavefront error, as strong as in real lenses and exaggerated.

The errors are stated at f/1.4 and 21.6 mm from the axis, a little beyond the corner. There one wavelength of error turns a ray
by 33 µrad for each power of the pupil, which lands it 1.6 µm off on the film: a tenth of a pixel at 2160 pixels across the gate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from render.model.camera import Camera
from render.model.lens import Lens, SeidelErrors
from tests.bench.lens_gallery.entries import BLURRED_LIGHTS, SHARP_LIGHTS, STREET, Entry, Section, View

_CORNER = (0.12, 0.14)
_MIDDLE = (0.42, 0.5)
_FACE = (0.34, 0.55)


def aberration_sections() -> tuple[Section, ...]:
    """Every error of a lens, by itself."""
    return (
        _spherical(),
        _coma(),
        _astigmatism(),
        _field_curvature(),
        _distortion(),
        _axial_colour(),
        _lateral_colour(),
    )


def with_errors(f_stop: float = 1.4, **errors: float) -> Callable[[Camera], Camera]:
    """Put a thin lens with these wavefront errors on the camera."""
    lens = Lens("seidel", seidel=SeidelErrors(reference_f_stop=1.4, **errors))
    return lambda camera: replace(camera, lens=lens, f_stop=f_stop)


def with_f_stop(f_stop: float) -> Callable[[Camera], Camera]:
    """Set the f-number."""
    return lambda camera: replace(camera, f_stop=f_stop)


def ideal(slug: str, view: View, detail: tuple[float, float], f_stop: float = 1.4) -> Entry:
    """The ideal lens, to hold others against."""
    note = "No errors: what the others are to be held against."
    return Entry(slug, f"Ideal lens, f/{f_stop:g}", note, view, change=with_f_stop(f_stop), detail=detail)


def _spherical() -> Section:
    def entry(slug: str, title: str, note: str, w040: float, view: View = BLURRED_LIGHTS) -> Entry:
        detail = _FACE if view is STREET else _CORNER
        return Entry(f"spherical-{slug}", title, note, view, change=with_errors(w040=w040), detail=detail)

    return Section(
        "Spherical aberration",
        "The rim of the pupil focuses elsewhere than its middle. Behind the focus an undercorrected lens gives disks that "
        "fade outward, an overcorrected one soap bubbles with bright rims; in focus there is a glow about a sharp core.",
        (
            ideal("spherical-none", BLURRED_LIGHTS, _CORNER),
            entry("under", "Undercorrected", "W040 = +25 λ, as of a portrait lens: disks fade a little outward.", 25),
            entry("under-strong", "Undercorrected, strongly", "W040 = +80 λ: disks melt away.", 80),
            entry("over", "Overcorrected", "W040 = −25 λ, as of some fast lenses: disks with a rim.", -25),
            entry("over-strong", "Overcorrected, strongly", "W040 = −60 λ: soap bubbles.", -60),
            ideal("spherical-none-focus", STREET, _FACE),
            entry("focus", "Undercorrected, in focus", "W040 = +25 λ: a veil on what is bright.", 25, STREET),
            entry("focus-strong", "Strongly, in focus", "W040 = +80 λ: soft focus, a glow about all.", 80, STREET),
        ),
    )


def _coma() -> Section:
    def entry(slug: str, title: str, note: str, w131: float) -> Entry:
        return Entry(f"coma-{slug}", title, note, SHARP_LIGHTS, change=with_errors(w131=w131), detail=_CORNER)

    return Section(
        "Coma",
        "Lights in focus become comets whose tails grow in proportion to the distance from the middle of the picture.",
        (
            ideal("coma-none", SHARP_LIGHTS, _CORNER),
            entry("weak", "Coma", "W131 = +60 λ: small tails in the corners.", 60),
            entry("strong", "Coma, strong", "W131 = +350 λ: comets all along the spokes of a wheel.", 350),
            entry("inward", "Coma of the other sign", "W131 = −350 λ: the same comets turned about.", -350),
        ),
    )


def _astigmatism() -> Section:
    def entry(slug: str, title: str, note: str, w222: float, w220: float = 0.0) -> Entry:
        change = with_errors(w222=w222, w220=w220)
        return Entry(f"astigmatism-{slug}", title, note, SHARP_LIGHTS, change=change, detail=_CORNER)

    return Section(
        "Astigmatism",
        "Spokes and rims of a wheel about the middle focus at different distances, with the square of the distance from it.",
        (
            ideal("astigmatism-none", SHARP_LIGHTS, _CORNER),
            entry("weak", "Astigmatism", "W222 = +60 λ: corner lights are drawn out along the spokes.", 60),
            entry("spokes", "Astigmatism, strong", "W222 = +350 λ, sagittal focus: dashes along the spokes.", 350),
            entry(
                "rims",
                "Astigmatism, the other focus",
                "W222 = +350 λ with W220 = −350 λ, tangential focus: dashes along the rim of the wheel, the swirl.",
                350,
                -350,
            ),
        ),
    )


def _field_curvature() -> Section:
    def entry(slug: str, title: str, note: str, w220: float) -> Entry:
        return Entry(
            f"field-curvature-{slug}", title, note, SHARP_LIGHTS, change=with_errors(w220=w220), detail=_CORNER
        )

    return Section(
        "Field curvature",
        "What is sharp lies on a bowl, not on a plane: middle and corners are never sharp on one wall.",
        (
            ideal("field-curvature-none", SHARP_LIGHTS, _CORNER),
            entry("weak", "Field curvature", "W220 = +60 λ: corners a little soft.", 60),
            entry("strong", "Field curvature, strong", "W220 = +350 λ: sharp in the middle, round blurs outside.", 350),
        ),
    )


def _distortion() -> Section:
    def entry(slug: str, title: str, note: str, w311: float) -> Entry:
        return Entry(f"distortion-{slug}", title, note, STREET, change=with_errors(8.0, w311=w311), detail=(0.88, 0.2))

    return Section(
        "Distortion",
        "Straight lines bend, nothing blurs. Stopped down to f/8, so that the houses' edges can be followed.",
        (
            ideal("distortion-none", STREET, (0.88, 0.2), 8.0),
            entry("barrel", "Barrel", "W311 = +270 λ, 2 % in the corner: lines bulge outward a little.", 270),
            entry("barrel-strong", "Barrel, strong", "W311 = +1600 λ, 12 % in the corner.", 1600),
            entry("pincushion-strong", "Pincushion, strong", "W311 = −1600 λ: lines bend in toward the middle.", -1600),
        ),
    )


def _axial_colour() -> Section:
    def entry(slug: str, title: str, note: str, shift_mm: float) -> Entry:
        change = with_errors(axial_color_mm=shift_mm)
        return Entry(f"axial-colour-{slug}", title, note, BLURRED_LIGHTS, change=change, detail=_MIDDLE, wavelengths=9)

    return Section(
        "Axial colour",
        "Colours focus at different distances: rims of one colour on everything behind the focus, of the other before it.",
        (
            ideal("axial-colour-none", BLURRED_LIGHTS, _MIDDLE),
            entry(
                "weak", "Blue short", "Blue focuses 0.15 mm before red, as in a fast old lens: faint cool rims.", -0.15
            ),
            entry(
                "strong",
                "Blue short, strongly",
                "1 mm, as in a single piece of glass: blue rims behind the focus.",
                -1.0,
            ),
            entry("long", "Blue long", "Blue focuses 1 mm behind red: red rims.", 1.0),
        ),
    )


def _lateral_colour() -> Section:
    def entry(slug: str, title: str, note: str, shift_mm: float) -> Entry:
        change = with_errors(5.6, lateral_color_mm=shift_mm)
        return Entry(f"lateral-colour-{slug}", title, note, SHARP_LIGHTS, change=change, detail=_CORNER)

    return Section(
        "Lateral colour",
        "Colours are magnified differently: fringes along the spokes of a wheel, none in the middle, at any f-number.",
        (
            ideal("lateral-colour-none", SHARP_LIGHTS, _CORNER, 5.6),
            entry("weak", "Blue outside", "The blue picture is 0.06 mm larger in the corner than the red one.", 0.06),
            entry("strong", "Blue outside, strongly", "0.5 mm: blue outer edges, red inner ones.", 0.5),
            entry("other", "Red outside", "The red picture is 0.5 mm larger: red outer edges, blue inner ones.", -0.5),
        ),
    )
