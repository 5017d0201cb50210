"""Positions of zoom and focus of a lens with surfaces."""

# ruff: noqa: RUF009  (setting() is dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Floats, schema_group, setting


@schema_group("Lens:Configurations")
@dataclass(frozen=True)
class Configurations:
    """Positions of zoom and focus, one entry for each in every array; none for a lens of one position."""

    thickness: Floats = setting(
        "lens:configuration:thickness",
        (),
        "Thicknesses",
        "Thicknesses of all surfaces in one position after the other, as in lens:prescription:thickness: of three positions "
        "of a lens with twelve surfaces 36 numbers.",
        "A position at infinity for each focal length makes a zoom, which focalLength sets; positions focused nearer say how "
        "the groups move to focus.",
        unit="millimetres",
        keyable=False,
    )
    object_distance: Floats = setting(
        "lens:configuration:objectDistance",
        (),
        "Object Distances",
        "Distance from the object in focus to the first surface, in each position; 0 is infinity.",
        unit="millimetres",
        keyable=False,
    )
    focal_length: Floats = setting(
        "lens:configuration:focalLength",
        (),
        "Focal Lengths",
        "Focal length of each position's zoom position at infinity, by which close positions belong to it; 0 where unknown.",
        unit="millimetres",
        keyable=False,
    )
    f_stop: Floats = setting(
        "lens:configuration:fStop",
        (),
        "F-Numbers",
        "f-number wide open in each position at infinity; 0 where it is that of lens:fStopRange.",
        unit="none, an f-number",
        keyable=False,
    )
