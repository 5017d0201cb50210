"""Sections on the shape of the pupil: the barrel, the iris, the anamorphic squeeze."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from tests.bench.lens_gallery.aberrations import with_f_stop
from tests.bench.lens_gallery.entries import BLURRED_LIGHTS, Entry, Section
from tests.bench.lens_gallery.glass import with_scales

_CORNER = (0.12, 0.14)
_MIDDLE = (0.42, 0.5)


def pupil_sections() -> tuple[Section, ...]:
    """The barrel, irises and anamorphic lenses."""
    return (_vignetting(), _irises(), _anamorphic())


def _vignetting() -> Section:
    def planar(slug: str, title: str, note: str, change: Callable[[Camera], Camera]) -> Entry:
        return Entry(slug, title, note, BLURRED_LIGHTS, lens="planar_50", change=change, detail=_CORNER)

    return Section(
        "Vignetting and cat's eyes",
        "The Planar's front and rear rims cut the pupil as the corners see it. Details from the upper left corner.",
        (
            planar(
                "vignetting-on",
                "f/1.4",
                "Cat's eyes whose long axes circle the middle; darker corners.",
                with_f_stop(1.4),
            ),
            planar(
                "vignetting-off",
                "f/1.4, its fall-off made up for",
                "Vignetting × 0: the same cat's eyes, and corners as bright as the middle.",
                with_scales(vignetting=0),
            ),
            planar(
                "vignetting-stopped",
                "f/2.8",
                "Stopped down: the iris is what cuts, and nearly everywhere.",
                with_f_stop(2.8),
            ),
        ),
    )


def _irises() -> Section:
    def iris(slug: str, title: str, note: str, shape: IrisShape) -> Entry:
        def closed(camera: Camera) -> Camera:
            return replace(camera, iris=shape)

        return Entry(f"iris-{slug}", title, note, BLURRED_LIGHTS, change=closed, detail=_MIDDLE)

    soft = tuple(float(x) for x in np.cos(np.linspace(0, np.pi / 2, 12)) ** 2)
    hard = tuple(float(x) for x in 0.4 + np.linspace(0, 1, 12) ** 4)
    return Section(
        "Irises",
        "An ideal lens, and openings of other shapes. The light is the same through all of them.",
        (
            iris("round", "Round", "Wide open.", IrisShape()),
            iris("5", "5 blades", "Pentagons, a corner up.", IrisShape(blades=5, rotation_rad=np.pi / 2)),
            iris("6", "6 blades", "Hexagons.", IrisShape(blades=6)),
            iris("6-turned", "6 blades, turned", "By 30 degrees.", IrisShape(blades=6, rotation_rad=np.pi / 6)),
            iris("8", "8 blades", "Octagons.", IrisShape(blades=8)),
            iris(
                "8-rounded", "8 blades, rounded", "Roundness 0.7: edges that bulge.", IrisShape(blades=8, roundness=0.7)
            ),
            iris("mask", "Image mask", "A heart cut out of card.", IrisShape(mask=heart())),
            iris("hard", "Hard edge", "Weights that grow outward: disks with rims.", IrisShape(radial_weights=hard)),
            iris(
                "ring",
                "Ring",
                "A mirror lens's middle: doughnuts.",
                IrisShape(radial_weights=(0, 0, 0, 0, 0.5, 1, 1, 1, 1)),
            ),
            iris("soft", "Soft edge", "An apodising filter: disks without rims.", IrisShape(radial_weights=soft)),
        ),
    )


def heart(side: int = 128) -> DoubleArray:
    """A heart, upright: ``(side, side)``, 1 inside."""
    line = (np.arange(side) + 0.5) / side * 2 - 1
    x, y = np.meshgrid(line * 1.3, -line * 1.3 + 0.1)
    return np.asarray(((x**2 + y**2 - 1) ** 3 <= x**2 * y**3).astype(np.float64))


def _anamorphic() -> Section:
    def squeezed(squeeze: float) -> Entry:
        def change(camera: Camera) -> Camera:
            return replace(camera, lens=replace(camera.lens, squeeze=squeeze))

        note = "Spherical: round." if squeeze == 1 else f"Upright ovals, {squeeze:g} times higher than wide."
        return Entry(f"anamorphic-{squeeze:g}", f"{squeeze:g}×", note, BLURRED_LIGHTS, change=change, detail=_MIDDLE)

    return Section(
        "Anamorphic squeeze",
        "The picture as it is shown, unsqueezed.",
        tuple(squeezed(factor) for factor in (1.0, 1.33, 2.0)),
    )
