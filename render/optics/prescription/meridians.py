"""The two meridians of a lens with cylinders: from top to bottom (y-z) and from side to side (x-z).

A ray that starts in one of them stays there, so that all that is known of rays in the y-z plane holds from side to side for the
lens turned by a quarter about its axis.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from render.model.lens import Across, Prescription, Surface
from render.optics.prescription import outlines

_OTHER: dict[str, Literal["", "upright", "across"]] = {"": "", "upright": "across", "across": "upright"}


def turned(prescription: Prescription) -> Prescription:
    """The lens turned by a quarter about its axis: its curves from side to side stand from top to bottom."""
    return replace(prescription, surfaces=tuple(_turned(surface) for surface in prescription.surfaces))


def upright(prescription: Prescription) -> Prescription:
    """The lens of revolution with the curves from top to bottom: each cylinder that lies across is a plane plate."""
    surfaces = tuple(_upright(surface) for surface in prescription.surfaces)
    return replace(prescription, surfaces=surfaces, focus_group_across=None)


def _upright(surface: Surface) -> Surface:
    terms_are_across = surface.torus == "across"
    aspheric, odd = ((), ()) if terms_are_across else (surface.aspheric, surface.odd)
    return replace(surface, across=None, aspheric=aspheric, odd=odd)


def _turned(surface: Surface) -> Surface:
    opening, obscuration = (outlines.turned(outline) for outline in (surface.opening, surface.obscuration))
    surface = replace(surface, opening=opening, obscuration=obscuration)
    if surface.across is None:
        return surface
    curve = Across(surface.radius_mm, surface.conic, _OTHER[surface.torus])
    return replace(surface, radius_mm=surface.across.radius_mm, conic=surface.across.conic, across=curve)
