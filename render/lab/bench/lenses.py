"""The lenses of the sweep over surfaces: an ideal one, and some of 2, 7 and 13 surfaces, the stop counted.

Each can be given dispersion that no designer corrected, every glass at one Abbe number, so that each colour has rays of its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from render.model.lens import AIR, THIN_LENS, Glass, Lens, LensModel, Prescription, Surface

ABBE = 45.0
"""A middling glass."""

Row = tuple[float, float, float, float]
"""Radius, thickness (mm), index behind (0 marks the stop), clear diameter (mm)."""

_SINGLET: tuple[Row, ...] = ((50.2792, 8.0, 1.5168, 17.8572), (-50.2792, 0, 1, 0))
TELEPHOTO_ROWS: tuple[Row, ...] = (  # Sigler, 250 mm f/5.6
    (54.6275, 12.52, 1.529, 47.5),
    (-86.365, 3.755, 1.599, 44.5),
    (271.7625, 2.8175, 1, 41.5),
    (0, 67.4125, 0, 40.5),
    (-32.13, 3.755, 1.613, 31.5),
    (49.5325, 12.52, 1.603, 33.5),
    (-50.945, 0, 1, 37),
)
WIDE_ROWS: tuple[Row, ...] = (  # Nakamura, 22 mm f/2.8
    (35.98738, 1.21638, 1.54, 23.716),
    (11.69718, 9.9957, 1, 17.996),
    (13.08714, 5.12622, 1.772, 12.364),
    (-22.63294, 1.76924, 1.617, 9.812),
    (71.05802, 0.8184, 1, 9.152),
    (0, 2.27766, 0, 8.756),
    (-9.58584, 2.43254, 1.617, 8.184),
    (-11.28864, 0.11506, 1, 9.152),
    (-166.7765, 3.09606, 1.713, 10.648),
    (-7.5911, 1.32682, 1.805, 11.44),
    (-16.7662, 3.98068, 1, 12.276),
    (-7.70286, 1.21638, 1.617, 13.42),
    (-11.97328, 0, 1, 17.996),
)


@dataclass(frozen=True)
class BenchLens:
    """A lens of the sweep.

    Attributes:
        name: of the lens, for people.
        lens: to put on the camera, which keeps its focal length.
        f_stop: the f-number that it is measured at.
        disperses: whether each colour has rays of its own.
    """

    name: str
    lens: Lens
    f_stop: float
    disperses: bool = False

    @property
    def surfaces(self) -> int:
        """Number of surfaces; 0 for the ideal lens."""
        return len(self.lens.prescription.surfaces) if self.lens.prescription else 0


def bench_lenses() -> tuple[BenchLens, ...]:
    """The ideal lens, the three of glass without dispersion, and the three with it."""
    plain = (
        BenchLens("singlet", _lens("spherical", "singlet", _SINGLET), 2.8),
        BenchLens("telephoto", _lens("prescription", "telephoto", TELEPHOTO_ROWS), 5.6),
        BenchLens("wide", _lens("prescription", "wide", WIDE_ROWS), 2.8),
    )
    return (BenchLens("thin", THIN_LENS, 2.8), *plain, *map(_add_dispersion, plain))


def _lens(model: LensModel, name: str, rows: tuple[Row, ...]) -> Lens:
    surfaces = tuple(
        Surface(radius, thickness, Glass(index) if index > 1 else AIR, diameter / 2, is_stop=index == 0)
        for radius, thickness, index, diameter in rows
    )
    return Lens(model, name, Prescription(surfaces, name=name))


def _add_dispersion(plain: BenchLens) -> BenchLens:
    prescription = plain.lens.prescription
    if prescription is None:
        raise ValueError(f"{plain.name} has no glass")
    surfaces = tuple(
        replace(surface, glass=replace(surface.glass, abbe=ABBE)) if surface.glass.index > 1 else surface
        for surface in prescription.surfaces
    )
    lens = replace(plain.lens, prescription=replace(prescription, surfaces=surfaces))
    return replace(plain, lens=lens, disperses=True)
