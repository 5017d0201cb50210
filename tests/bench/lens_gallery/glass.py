"""Real glass with its own errors taken away, as they are, and exaggerated."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from render.model.camera import Camera
from render.model.lens import AberrationScales
from tests.bench.lens_gallery.entries import BLURRED_LIGHTS, SHARP_LIGHTS, Entry, Section

_CORNER = (0.12, 0.14)
_MIDDLE = (0.42, 0.5)
_EVERY_SHAPE = ("spherical", "coma", "astigmatism", "field_curvature", "distortion")


def glass_sections() -> tuple[Section, ...]:
    """Errors of prescriptions, scaled."""
    return (_colour(), _shape())


def with_scales(**factors: float) -> Callable[[Camera], Camera]:
    """Scale the errors of the camera's lens."""
    return lambda camera: replace(camera, lens=replace(camera.lens, scales=AberrationScales(**factors)))


def _colour() -> Section:
    notes = {
        0: "Colour errors taken away, all others kept.",
        1: "As the glass has them.",
        3: "Three times as strong.",
    }

    def singlet(factor: int) -> Entry:
        return Entry(
            f"chromatic-{factor}",
            f"Chromatic × {factor}",
            notes[factor],
            BLURRED_LIGHTS,
            lens="singlet_50",
            change=with_scales(chromatic=factor),
            detail=_MIDDLE,
            wavelengths=9,
        )

    return Section(
        "Colour errors of real glass, scaled",
        "One biconvex lens of BK7 glass, from none of its colour to three times as much of it; nine wavelengths.",
        tuple(singlet(factor) for factor in notes),
    )


def _shape() -> Section:
    def gauss(slug: str, title: str, note: str, **factors: float) -> Entry:
        return Entry(
            f"scaled-{slug}",
            title,
            note,
            SHARP_LIGHTS,
            lens="double_gauss_50",
            change=with_scales(**factors),
            detail=_CORNER,
        )

    return Section(
        "Errors of real glass, scaled one by one",
        "The double Gauss of the fifties wide open at f/2, focused on the lights.",
        (
            gauss(
                "none",
                "None",
                "Every error but colour × 0: an ideal lens in the barrel of this one.",
                **dict.fromkeys(_EVERY_SHAPE, 0.0),
            ),
            gauss("own", "Its own", "As Tronnier drew it."),
            gauss("spherical", "Spherical × 5", "A glow about each light, the same over the frame.", spherical=5.0),
            gauss("coma", "Coma × 12", "Comets in the corners.", coma=12.0),
            gauss("astigmatism", "Astigmatism × 12", "Dashes in the corners.", astigmatism=12.0),
            gauss("field-curvature", "Field curvature × 12", "Soft corners.", field_curvature=12.0),
            gauss("distortion", "Distortion × 5", "Lines bend.", distortion=5.0),
        ),
    )
