"""LensAPI data of a prescription or a data sheet: the inverse of `render.stage.camera.lenses`."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from itertools import count
from typing import Any, Literal

from render.errors import InputError
from render.model.lens import Across, Configuration, Glass, Outline, Prescription
from render.optics.dispersion.names import agreeing_glass
from render.optics.dispersion.sellmeier_fit import as_sellmeier
from render.optics.lens_files import MeasuredLens
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import focal_points, paraxial_system
from render.optics.prescription.zooming import marked_close_focus_m, zoom_positions
from usd_schemas import Configurations, DataSheet, LensData
from usd_schemas import Prescription as PrescriptionData

_DECIMALS = 9  # of a millimetre: sums of thicknesses without their binary rounding
SQUEEZES = 0.1, 10.0
"""The schema's range; real lenses squeeze by 1.25 to 2."""
_HIGHEST_POWER = 20
ASPHERIC = tuple(f"aspheric{power}" for power in range(4, _HIGHEST_POWER + 1, 2))
"""Fields of the schema's prescription that hold the coefficients of r⁴, r⁶, ... r²⁰."""
ODD = tuple(f"aspheric{power}" for power in range(3, _HIGHEST_POWER, 2))
"""Fields that hold the coefficients of r³, r⁵, ... r¹⁹."""

PHASE = tuple(f"phase{power}" for power in range(2, _HIGHEST_POWER + 1, 2))
"""Fields that hold the coefficients of r², r⁴, ... r²⁰ of the phase of diffractive surfaces."""


def lens_data(prescription: Prescription, name: str = "") -> LensData:
    """LensAPI data of a prescription.

    Args:
        prescription: as read from a file; missing values stay missing.
        name: name of the lens; by default the prescription's own.

    Raises:
        InputError: it has terms that the schema cannot hold.
    """
    surfaces = [replace(surface, glass=_portable(surface.glass)) for surface in prescription.surfaces]
    highest = max((power for surface in surfaces for power in surface.aspheric_terms), default=0)
    highest = max(highest, *(2 * len(surface.phase) for surface in surfaces))
    if highest > _HIGHEST_POWER:
        raise InputError(f"{prescription.name} has a term of r^{highest}, USD has them up to r^{_HIGHEST_POWER}")
    stops = [index for index, surface in enumerate(surfaces) if surface.is_stop]
    has_sellmeier = any(surface.glass.sellmeier_b for surface in surfaces)
    nothing = (0.0, 0.0, 0.0)
    more: dict[str, Any] = {
        **_across(prescription),
        **_outlines(prescription, "opening"),
        **_outlines(prescription, "obscuration"),
        **{
            field: _unless_zero(surface.aspheric_terms.get(power, 0.0) for surface in surfaces)
            for power, field in (*zip(count(4, 2), ASPHERIC), *zip(count(3, 2), ODD))
        },
        **{
            field: _unless_zero(surface.phase[i] if i < len(surface.phase) else 0.0 for surface in surfaces)
            for i, field in enumerate(PHASE)
        },
    }
    data = PrescriptionData(
        radius=tuple(surface.radius_mm for surface in surfaces),
        thickness=tuple(surface.thickness_mm for surface in surfaces),
        index=tuple(surface.glass.index for surface in surfaces),
        abbe=_unless_zero(surface.glass.abbe for surface in surfaces),
        sellmeier_b=tuple(s.glass.sellmeier_b or nothing for s in surfaces) if has_sellmeier else (),
        sellmeier_c=tuple(s.glass.sellmeier_c or nothing for s in surfaces) if has_sellmeier else (),
        glass=tuple(s.glass.name for s in surfaces) if any(s.glass.name for s in surfaces) else (),
        clear_diameter=_unless_zero(2 * surface.semi_diameter_mm for surface in surfaces),
        conic=_unless_zero(surface.conic for surface in surfaces),
        coating_wavelength=_unless_zero(surface.coating_nm for surface in surfaces),
        stop_surface=stops[0] if stops else -1,
        focus_group=prescription.focus_group or (-1, -1),
        focus_group_across=prescription.focus_group_across or (-1, -1),
        **more,
    )
    return LensData(
        model="prescription",
        name=name or prescription.name,
        close_focus=1000 * marked_close_focus_m(prescription),
        f_stop_range=(prescription.f_stop, 0.0),
        squeeze=nominal_squeeze(prescription),
        prescription=data,
        configurations=_configurations(prescription),
    )


def _configurations(prescription: Prescription) -> Configurations:
    """Positions of zoom and focus, each by the focal length of its zoom position."""
    rows: list[tuple[Configuration, float]] = []
    for position in zoom_positions(prescription):
        focal_mm = position.far.focal_length_mm or round(position.focal_length_mm, _DECIMALS)
        rows += [(each, focal_mm) for each in (position.far, *position.near)]
    if len(rows) < 2:
        return Configurations()
    return Configurations(
        thickness=tuple(round(length, _DECIMALS) for each, _ in rows for length in each.thicknesses_mm),
        object_distance=_unless_zero(0.0 if math.isinf(each.object_mm) else each.object_mm for each, _ in rows),
        focal_length=tuple(focal_mm for _, focal_mm in rows),
        f_stop=_unless_zero(each.f_stop for each, _ in rows),
    )


def nominal_squeeze(prescription: Prescription) -> float:
    """Squeeze of a lens with cylinders at infinity, to two decimals; 1 of any other, and where none makes a picture."""
    if not prescription.is_anamorphic:
        return 1.0
    own, across = (focal_points(paraxial_system(part))[0] for part in (prescription, turned(prescription)))
    squeeze = round(own / across, 2)
    return squeeze if SQUEEZES[0] <= squeeze <= SQUEEZES[1] else 1.0


def _across(prescription: Prescription) -> dict[str, Any]:
    """Arrays of the curves from side to side; none of a lens with rotational symmetry."""
    if not prescription.is_anamorphic:
        return {}
    tori = tuple(surface.torus for surface in prescription.surfaces)
    curves = [surface.across or Across(surface.radius_mm, surface.conic) for surface in prescription.surfaces]
    conics = tuple(curve.conic for curve in curves)
    same = conics == tuple(surface.conic for surface in prescription.surfaces)
    radii = tuple(curve.radius_mm for curve in curves)
    return {"radius_across": radii, "conic_across": () if same else conics, "torus": tori if any(tori) else ()}


def _outlines(prescription: Prescription, name: Literal["opening", "obscuration"]) -> dict[str, Any]:
    """Arrays of the openings or of the obscurations; none of a lens without them."""
    outlines: list[Outline | None] = [getattr(surface, name) for surface in prescription.surfaces]
    if not any(outlines):
        return {}
    sized = [o if o and o.kind != "polygon" else None for o in outlines]
    polygons = [o.corners_mm for o in outlines if o and o.kind == "polygon"]
    sizes = tuple((2 * o.half_mm[0], 2 * o.half_mm[1]) if o else (0.0, 0.0) for o in sized)
    centres = tuple(o.centre_mm if o else (0.0, 0.0) for o in sized)
    return {
        f"{name}_shape": tuple(o.kind if o else "" for o in outlines),
        f"{name}_size": sizes if any(sized) else (),
        f"{name}_corners": tuple(corner for corners in polygons for corner in (*corners, corners[0])),
        f"{name}_centre": centres if any(any(centre) for centre in centres) else (),
    }


def _portable(glass: Glass) -> Glass:
    """The glass as USD holds it: by a name of the catalogue, by Sellmeier coefficients, or by index and Abbe number."""
    if glass.dispersion is None:
        return glass
    known = agreeing_glass(glass.name, glass.index, glass.abbe)
    return glass if known == glass else as_sellmeier(glass)


def measured_lens_data(lens: MeasuredLens) -> LensData:
    """LensAPI data of a lens described by its data sheet."""
    sheet = lens.sheet
    return LensData(
        model="dataSheet",
        name=lens.name,
        close_focus=1000 * lens.close_focus_m,
        f_stop_range=lens.f_stops,
        data_sheet=DataSheet(
            height=sheet.heights_mm,
            distortion=sheet.distortion,
            vignetting=sheet.light,
            sagittal_blur=sheet.sagittal_blur_mm,
            tangential_blur=sheet.tangential_blur_mm,
            spherical_aberration=sheet.spherical,
            coma=sheet.coma_mm,
            field_curvature=sheet.field_curvature_mm,
            lateral_color=sheet.lateral_color_mm,
            axial_color=sheet.axial_color_mm,
            f_stop=sheet.f_stop,
        ),
    )


def _unless_zero(values: Iterable[float]) -> tuple[float, ...]:
    """The values, or none where all are 0: the schema's way to leave an array out."""
    kept = tuple(values)
    return kept if any(kept) else ()
