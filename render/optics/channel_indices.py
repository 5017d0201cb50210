"""Colour errors drawn by hand: refractive indices for red, green and blue in place of dispersion.

"Chromatic aberration can be controlled via varying refraction indices for the RGB channels" (Lee, Eisemann & Seidel 2010, section
5.3). Their lens has one glass. Here the indices are those of a lens's first glass, and the others keep their power relative to
it, ``(n - 1) / (n1 - 1)``, in every colour: all elements then have the dispersion of one glass, none corrects another, and red,
green and blue have focal lengths about as ``1 / (N - 1)``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from render.model.lens import Glass, Prescription
from render.optics.glass import D_LINE_NM, refractive_index


def with_channel_indices(prescription: Prescription, indices: Sequence[float]) -> Prescription:
    """Replace the dispersion of all glasses. The back focal distance is left to be solved for, as the lens's power changes.

    Args:
        prescription: the lens.
        indices: of its first glass for red, green and blue; above 1.
    """
    surfaces = prescription.surfaces
    first = next((surface.glass.index for surface in surfaces if surface.glass.index != 1), None)
    if first is None:
        return prescription

    def drawn(glass: Glass) -> Glass:
        if glass.index == 1:
            return glass
        power = (glass.index - 1) / (first - 1)
        red, green, blue = (1 + power * (index - 1) for index in indices)
        bare = Glass(name=glass.name, channels=(red, green, blue))
        return replace(bare, index=refractive_index(bare, D_LINE_NM))

    changed = [replace(surface, glass=drawn(surface.glass)) for surface in surfaces]
    changed[-1] = replace(changed[-1], thickness_mm=0.0)
    return replace(prescription, surfaces=tuple(changed))
