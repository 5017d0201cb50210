"""A surface as it is read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from render.model.lens import AIR, Glass, Outline
from render.optics.lens_files.forbes import ForbesTerms


@dataclass
class DraftSurface:
    """Surface in the file's own unit, while the file is being read.

    Attributes:
        label: as the file counts it.
        line: first line, counted from 1; 0 in a file whose lines say nothing.
        radius: of curvature; 0 is a plane.
        thickness: to the next surface.
        glass: the medium behind it.
        semi_diameter: half the clear diameter; 0 where it is unknown.
        conic: conic constant.
        terms: coefficients by the power of r.
        is_stop: whether it is the aperture stop.
        across: radius and conic constant in x, where they are others than in y; None where not.
        torus: the curve, in y or in x, that is turned about an axis across it and has the terms; empty for no torus.
        opening: within which light passes, in the file's unit in place of millimetres; None where there is none.
        obscuration: within which no light passes, likewise.
        phase: coefficients of the phase that it adds by diffraction, radians, by the power of r.
        forbes: departure in Forbes's polynomials; None where there is none.
    """

    label: str
    line: int
    radius: float = 0.0
    thickness: float = 0.0
    glass: Glass = AIR
    semi_diameter: float = 0.0
    conic: float = 0.0
    terms: dict[int, float] = field(default_factory=dict)
    is_stop: bool = False
    across: tuple[float, float] | None = None
    opening: Outline | None = None
    obscuration: Outline | None = None
    forbes: ForbesTerms | None = None
    torus: Literal["", "upright", "across"] = ""
    phase: dict[int, float] = field(default_factory=dict)

    @property
    def is_flat(self) -> bool:
        """Whether it is a plane."""
        is_straight = self.radius == 0 and (self.across is None or self.across[0] == 0)
        return is_straight and self.forbes is None and not any((*self.terms.values(), *self.phase.values()))
