"""Sections on what a camera operator sets, the f-number and the focus, and on the sampling of pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from render.model.camera import Camera
from tests.bench.lens_gallery.aberrations import ideal
from tests.bench.lens_gallery.entries import BLURRED_LIGHTS, STREET, Entry, Section
from tests.bench.lens_gallery.glass import with_scales

_LIGHTS = (0.66, 0.16)
_MIDDLE = (0.42, 0.5)


def setting_sections() -> tuple[Section, ...]:
    """Depth of field, breathing, sampling."""
    return (_depth_of_field(), _breathing(), _rays(), _wavelengths())


def _depth_of_field() -> Section:
    def stopped(f_stop: float) -> Entry:
        return Entry(
            f"f-stop-{f_stop:g}",
            f"f/{f_stop:g}",
            "Wide open." if f_stop == 1.4 else "What is behind the near robot comes into focus.",
            STREET,
            lens="planar_50",
            change=lambda camera: replace(camera, f_stop=f_stop),
            detail=_LIGHTS,
        )

    return Section(
        "Depth of field",
        "The Planar from f/1.4 to f/16, as exposed alike.",
        tuple(stopped(f_stop) for f_stop in (1.4, 2.0, 2.8, 4.0, 5.6, 8.0, 16.0)),
    )


def _breathing() -> Section:
    def focused(slug: str, title: str, note: str, focus_m: float, breathes: bool) -> Entry:
        def change(camera: Camera) -> Camera:
            return replace(camera, focus_distance_m=focus_m, breathing=breathes)

        return Entry(f"breathing-{slug}", title, note, STREET, lens="planar_50", change=change, detail=_LIGHTS)

    return Section(
        "Breathing",
        "A rack of the Planar from the end of the street to before the near robot. By default the framing stays; with "
        "breathing the picture grows as the lens moves out.",
        (
            focused("off-far", "Off, 15 m", "The framing that the focal length says.", 15.0, False),
            focused("off-near", "Off, 0.8 m", "The same framing.", 0.8, False),
            focused("on-far", "On, 15 m", "Hardly another framing.", 15.0, True),
            focused("on-near", "On, 0.8 m", "A narrower view: the lens stands farther from the film.", 0.8, True),
        ),
    )


def _rays() -> Section:
    def traced(rays: int) -> Entry:
        entry = ideal(f"rays-{rays}", STREET, _LIGHTS)
        note = "Rays for each pixel: noise gives way to smooth disks."
        return replace(entry, title=f"{rays} rays", note=note, rays=rays)

    return Section("Number of rays", "The ideal lens on the shot.", tuple(traced(rays) for rays in (16, 64, 256)))


def _wavelengths() -> Section:
    notes = {
        1: "The d line alone: no colour errors.",
        3: "One wavelength for each channel, as by default: three rims.",
        9: "Nine through the CIE 1931 matching functions: the rims run into a spectrum.",
    }

    def traced(count: int) -> Entry:
        title = f"{count} wavelength{'s' if count > 1 else ''}"
        change: Callable[[Camera], Camera] = with_scales(chromatic=3)
        return Entry(
            f"wavelengths-{count}",
            title,
            notes[count],
            BLURRED_LIGHTS,
            lens="singlet_50",
            change=change,
            detail=_MIDDLE,
            wavelengths=count,
        )

    return Section(
        "Number of wavelengths",
        "The single lens of BK7 with three times its colour errors.",
        tuple(traced(count) for count in notes),
    )
