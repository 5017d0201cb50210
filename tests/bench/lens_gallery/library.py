"""The library's lenses: on the shot, and on its lights."""

from __future__ import annotations

from dataclasses import replace

from render.model.camera import Camera
from tests.bench.lens_gallery.entries import BLURRED_LIGHTS, FACE, FAR_LIGHTS, STREET, Entry, Section
from usd_schemas import LibraryLens, library_lenses

LONG_MM = 200.0
"""From here on a lens sees nothing of the shot's own framing but a wall."""


def library_sections() -> tuple[Section, ...]:
    """Every lens of the library wide open, in two views."""
    lenses = library_lenses()
    return (
        Section(
            "The library on the shot",
            "Every lens wide open, mounted as on a set: a wider lens sees more and a longer one less. Frame 48, the focus on "
            "the near robot; the longest are turned to the far one.",
            tuple(_on_the_shot(lens) for lens in lenses),
        ),
        Section(
            "The library's bokeh",
            "The same lenses under the string lights, focused before them, so that each bulb "
            "draws the pupil as seen from its place: round in the middle, cut to cat's eyes or bent to comets in the corners.",
            tuple(_on_the_lights(lens) for lens in lenses),
        ),
    )


def _on_the_shot(lens: LibraryLens) -> Entry:
    view = FACE if lens.focal_length_mm >= LONG_MM else STREET
    return _wide_open(lens, Entry(f"shot-{lens.name}", lens.lens.name, lens.description, view, detail=(0.66, 0.16)))


def _on_the_lights(lens: LibraryLens) -> Entry:
    view = FAR_LIGHTS if lens.focal_length_mm >= LONG_MM else BLURRED_LIGHTS
    return _wide_open(lens, Entry(f"lights-{lens.name}", lens.lens.name, lens.description, view, detail=(0.12, 0.14)))


def _wide_open(lens: LibraryLens, entry: Entry) -> Entry:
    def opened(camera: Camera) -> Camera:
        return replace(camera, f_stop=lens.f_stop)

    return replace(entry, lens=lens.name, change=opened)
