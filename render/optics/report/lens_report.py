"""Report of a lens on its own: numbers, curves, spots and bokeh, for any lens model."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.optics.data_sheet import at_heights
from render.optics.flare.coating import axial_transmittance
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.mounting import distance_from_film_m, has_surfaces, mount_lens, nearer_than_marked
from render.optics.prescription.outlines import is_circle, without_outlines
from render.optics.prescription.zooming import Zoom, zoom_of
from render.optics.report.bokeh import BokehSheet, bokeh_sheet
from render.optics.report.colour import ColourCurves, measure_colour
from render.optics.report.cylinder_chiefs import CylinderChiefs
from render.optics.report.field import FieldCurves, Spot, field_curves, image_circle_mm, seen_at, spots
from render.optics.report.film_cone import film_cone
from render.optics.report.film_rays import FilmRays, SqueezedRays
from render.optics.report.focus_scale import FocusMark, focus_scale
from render.optics.report.glass_rays import GlassRays
from render.optics.report.ideal_rays import ThinRays
from render.optics.report.mtf import Mtf, measure_mtf
from render.optics.report.numbers import (
    Barrel,
    ThirdOrder,
    barrel,
    nearest_m,
    third_order_of_errors,
    third_order_of_glass,
)
from render.optics.report.sheet_rays import SheetRays
from render.optics.thin_lens import focus_w

SPOT_FIELDS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Image heights of the spot diagrams, over that of the gate's corner."""
_BOKEH_FOCUS = 40  # focal lengths
_WITHOUT_GLASS = {
    "pinhole": "It has no glass: everything is sharp, and diffraction is left out.",
    "thin": "It has no glass: an ideal lens without errors, whose picture is even.",
    "seidel": "It has no glass: a thin lens with third-order errors, whose picture is even.",
    "dataSheet": "It is known by its data sheet alone: rays are made that have the errors that were measured.",
}
_SHARE_SIDE = 160
_FARTHEST = 2.5  # corners of the gate: light farther out is of no use


@dataclass(frozen=True, eq=False)
class LensReport:
    """Report of a lens at its setting.

    Attributes:
        camera: the lens, its f-number and focus, and the gate behind it.
        focused: its surfaces as they stand; None for a lens that has none.
        zoom: its range and how it holds its focus; None for a lens of one focal length.
        f_stop: as reached, of the real beam from infinity; 0 for a pinhole.
        working_f_stop: of the real beam as focused, ``1 / (2·sin u′)``; 0 for a lens without surfaces.
        paraxial_f_stop: by the paraxial pupil; 0 for a lens without surfaces.
        transmittance: share of the light that passes: as stated, else what the coated surfaces of its glass let through on the
            axis; 1 where neither is known.
        open_share: of the light on the axis, what openings and obscurations of surfaces let through.
        set_f_stop: as it was set.
        wide_open: f-number; 0 for a pinhole, or where any goes.
        nearest_m: distance from the entrance pupil that its glass and its mount reach, whatever is engraved on it; 0 for no
            limit, infinite for a fixed focus.
        field_of_view_deg: across, up, and from corner to corner, as far as there is light.
        image_circle_mm: diameter beyond which there is no light; infinite where it does not end.
        airy_um: diameter of the disc that diffraction makes of a point, at the d line; 0 for a pinhole, which is left out.
        barrel: None for a lens without surfaces.
        third_order: None for a lens without errors, and for one with diffractive surfaces.
        spots: over the field, in the plane of focus.
        curves: over the field.
        notes: values that were computed or left out, one sentence each.
    """

    camera: Camera
    focused: FocusedLens | None
    zoom: Zoom | None
    f_stop: float
    working_f_stop: float
    paraxial_f_stop: float
    transmittance: float
    open_share: float
    set_f_stop: float
    wide_open: float
    nearest_m: float
    field_of_view_deg: tuple[float, float, float]
    image_circle_mm: float
    airy_um: float
    barrel: Barrel | None
    third_order: ThirdOrder | None
    spots: tuple[Spot, ...]
    curves: FieldCurves
    notes: tuple[str, ...]

    @property
    def t_stop(self) -> float:
        """``N / √T``, T with what openings leave; infinite where nothing comes through, 0 for a pinhole."""
        passed = self.transmittance * self.open_share
        return self.f_stop / math.sqrt(passed) if passed > 0 else math.inf

    @property
    def is_at_infinity(self) -> bool:
        """Whether infinity is in focus."""
        return not focus_w(self.camera)

    @property
    def corner_mm(self) -> float:
        """Image height of the gate's corner."""
        return corner_mm(self.camera)

    @cached_property
    def mtf(self) -> Mtf | None:
        """Modulation transfer; None for a pinhole."""
        return (
            measure_mtf(film_rays(self.camera), self.corner_mm, self.working_f_stop or self.f_stop)
            if self.f_stop
            else None
        )

    @cached_property
    def colour(self) -> ColourCurves | None:
        """Errors of each colour; None for a pinhole."""
        return measure_colour(film_rays(self.camera), self.corner_mm) if self.f_stop else None

    @cached_property
    def bokeh(self) -> BokehSheet | None:
        """Highlights over the frame; None for a pinhole."""
        return lens_bokeh(self.camera)

    @cached_property
    def focus_marks(self) -> tuple[FocusMark, ...]:
        """Scale of the focus ring; empty for a lens without surfaces."""
        return focus_scale(self.camera) if self.focused else ()


def lens_report(camera: Camera, wide_open: float = 0.0) -> LensReport:
    """Measure a camera's lens.

    Args:
        camera: with its lens, f-number, focus and gate. The factors on a lens's errors are left at 1: it is shown as it is made.
        wide_open: f-number of a lens without surfaces, wide open; 0 for no limit.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance, or openings and obscurations stop all light on the axis at this stop.
    """
    lens, set_f_stop = mount_lens(camera) if has_surfaces(camera) else None, camera.f_stop
    if lens is None and camera.f_stop:
        camera = replace(camera, f_stop=max(camera.f_stop, wide_open))
    rays, corner = film_rays(camera), corner_mm(camera)
    f_stop = lens.f_stop if lens else camera.f_stop
    if lens and lens.prescription.outlines and not rays.light(np.zeros(1))[0] > 0:
        name = camera.lens.name or "the lens"
        what = "its openings and obscurations stop all light on the axis: open the iris"
        raise SettingsError(f"{name} is dark in the middle of the picture at f/{f_stop:.3g}, where {what}")
    circle = image_circle_mm(rays, _FARTHEST * corner) if lens else float("inf")
    share = _open_share(lens) if lens else 1.0
    return LensReport(
        camera=camera,
        focused=lens,
        zoom=zoom_of(camera.lens.prescription) if camera.lens.prescription is not None and lens else None,
        f_stop=f_stop,
        working_f_stop=lens.working_f_stop if lens else 0.0,
        paraxial_f_stop=lens.paraxial_f_stop if lens else 0.0,
        transmittance=_transmittance(camera.lens),
        open_share=share,
        set_f_stop=set_f_stop,
        wide_open=lens.prescription.f_stop if lens else wide_open,
        nearest_m=nearest_m(lens, camera.focus_distance_m) if lens else 0.0,
        field_of_view_deg=_field_of_view_deg(rays, camera, circle),
        image_circle_mm=circle,
        airy_um=2.44 * D_LINE_NM * 1e-3 * f_stop,
        barrel=barrel(lens) if lens else None,
        third_order=_third_order(camera, lens),
        spots=spots(rays, np.array(SPOT_FIELDS) * corner, camera.iris),
        curves=_curves(rays, camera),
        notes=(*_notes(camera, lens), *_outline_notes(camera, share), *_dark_corners(circle, corner)),
    )


def _open_share(lens: FocusedLens) -> float:
    """Share of the light on the axis that openings and obscurations let through."""
    if not lens.prescription.outlines:
        return 1.0
    plain = replace(lens, prescription=without_outlines(lens.prescription))
    own, whole = (film_cone(each, np.zeros(2), side=_SHARE_SIDE) for each in (lens, plain))
    return own.light / whole.light if own and whole and whole.light > 0 else 0.0


def _outline_notes(camera: Camera, share: float) -> tuple[str, ...]:
    if not camera.lens.has_outlines:
        return ()
    notes = [
        f"Openings and obscurations of its surfaces let {100 * share:.3g} % of the light on the axis through; the f-number is "
        "that of the beam without them, and pictures are as much darker."
    ]
    outlines = camera.lens.prescription.outlines if camera.lens.prescription else ()
    is_round = all(is_circle(outline) and outline.centre_mm == (0.0, 0.0) for outline in outlines)
    if not is_round and not camera.lens.has_cylinders:
        notes.append(
            "They are not the same all around: what is shown over the image height is that straight up from the middle."
        )
    if camera.lens.ghosts > 0 and not camera.lens.has_cylinders:
        notes.append("Its ghosts are drawn as if it had none.")
    return tuple(notes)


def _dark_corners(circle_mm: float, corner_mm: float) -> tuple[str, ...]:
    if circle_mm >= 2 * corner_mm:
        return ()
    return (
        f"Its image circle of {circle_mm:.3g} mm leaves the corners of the gate, {2 * corner_mm:.3g} mm across, dark.",
    )


def _transmittance(lens: Lens) -> float:
    """Transmittance as stated, else by the coatings; bare glass counts only beside coated."""
    surfaces = lens.prescription.surfaces if lens.prescription is not None else ()
    if lens.transmittance < 1 or not any(surface.coating_nm > 0 for surface in surfaces):
        return lens.transmittance
    return axial_transmittance(surfaces)


def _curves(rays: FilmRays, camera: Camera) -> FieldCurves:
    curves, sheet = field_curves(rays, corner_mm(camera), camera.lens.drawn_squeeze), camera.lens.data_sheet
    if (chiefs := _cylinder_chiefs(camera)) is not None:
        return _with_own_distortion(curves, chiefs, focus_w(camera) / 1000)
    if sheet is None:
        return curves
    # its foci were measured with the whole pupil, and a narrow beam of what stands for its blur has others
    behind = -at_heights(sheet, "field_curvature_mm", curves.heights_mm)
    return replace(curves, tangential_mm=behind, sagittal_mm=behind)


def _with_own_distortion(curves: FieldCurves, chiefs: CylinderChiefs, nearness_per_mm: float) -> FieldCurves:
    """Distortion up and across, each along its own axis: across, the squeeze that differs from the nominal one counts too."""

    def along(axis: int) -> DoubleArray:
        places = np.zeros((len(curves.heights_mm), 2))
        places[:, axis] = np.maximum(curves.heights_mm, 1e-3)
        seen = chiefs.at(places, nearness_per_mm)[0][:, axis]
        return np.where(
            np.isfinite(curves.distortion), places[:, axis] / (seen * chiefs.lens.image_scale_mm) - 1, np.nan
        )

    return replace(curves, distortion=along(1), distortion_across=along(0))


def _field_of_view_deg(rays: FilmRays, camera: Camera, circle_mm: float) -> tuple[float, float, float]:
    right, up = camera.horizontal_aperture_mm / 2, camera.vertical_aperture_mm / 2
    ends = np.array([[right, 0.0], [0.0, up], [right, up]])
    lit = ends * np.minimum(1, circle_mm / 2 / np.hypot(*ends.T))[:, None]
    chiefs = _cylinder_chiefs(camera)
    seen = seen_at(rays, lit, camera.lens.squeeze) if chiefs is None else chiefs.at(lit, 0.0)[0]
    across, high, diagonal = 2 * np.degrees(np.arctan(np.hypot(*seen.T)))
    return float(across), float(high), float(diagonal)


def film_rays(camera: Camera) -> FilmRays:
    """Rays of the camera's lens on its film, at its focus and f-number."""
    lens, nearness = camera.lens, focus_w(camera)
    rays: FilmRays
    if has_surfaces(camera):
        rays = GlassRays(mount_lens(camera), nearness, _cylinder_chiefs(camera))
    elif lens.model == "dataSheet" and lens.data_sheet is not None and camera.f_stop:
        rays = SheetRays(lens.data_sheet, camera.focal_length_mm, camera.f_stop, nearness)
    else:
        errors = lens.seidel if lens.model == "seidel" else None
        rays = ThinRays(camera.focal_length_mm, camera.f_stop, nearness, errors)
    return rays if lens.drawn_squeeze == 1 else SqueezedRays(rays, lens.squeeze)


def _cylinder_chiefs(camera: Camera) -> CylinderChiefs | None:
    """Chief rays of a lens with cylinders, whose heights are measured toward the corner of the gate."""
    if not camera.lens.has_cylinders:
        return None
    corner = np.array([camera.horizontal_aperture_mm, camera.vertical_aperture_mm])
    return CylinderChiefs(mount_lens(camera), camera.lens.squeeze, corner / np.hypot(*corner))


def corner_mm(camera: Camera) -> float:
    """Image height of the gate's corner."""
    return float(np.hypot(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)) / 2


def _third_order(camera: Camera, lens: FocusedLens | None) -> ThirdOrder | None:
    if lens is not None and lens.prescription.is_diffractive:
        return None
    if lens is not None:
        return third_order_of_glass(lens.prescription, lens.f_stop, corner_mm(camera))
    if camera.lens.seidel is not None and camera.f_stop:
        return third_order_of_errors(camera.lens.seidel, camera.f_stop, corner_mm(camera))
    return None


def lens_bokeh(camera: Camera) -> BokehSheet | None:
    """Bokeh of a camera's lens at its focus, or, focused at infinity, at the portrait distance of its focal length.

    None for a pinhole, and for a lens of fixed focus, which has infinity in focus.
    """
    if not camera.f_stop:
        return None
    if not focus_w(camera):
        nearest = max(_BOKEH_FOCUS * camera.focal_length_mm / 1000, 1.5 * camera.lens.close_focus_m)
        camera = replace(camera, focus_distance_m=_round(nearest))
    try:
        rays = film_rays(camera)
    except SettingsError:
        return None
    scale_mm = mount_lens(camera).image_scale_mm if has_surfaces(camera) else camera.focal_length_mm
    pupil_mm = camera.focal_length_mm / camera.f_stop
    disc_mm = scale_mm * pupil_mm * focus_w(camera) / 1000
    gate = (camera.horizontal_aperture_mm, camera.vertical_aperture_mm)
    return bokeh_sheet(rays, camera.iris, gate, camera.focus_distance_m, disc_mm)


def _round(distance_m: float) -> float:
    """Round a distance to one significant digit."""
    return float(f"{distance_m:.1g}")


def _notes(camera: Camera, lens: FocusedLens | None) -> tuple[str, ...]:
    notes = lens.prescription.notes if lens else ()
    if lens is None:
        notes += (_WITHOUT_GLASS[camera.lens.model],)
    if nearer_than_marked(camera):
        notes += (
            f"Focused {distance_from_film_m(camera):.3g} m before the film, nearer than the {camera.lens.close_focus_m:g} m"
            " that are marked on it: as if on an extension tube.",
        )
    if lens is None and camera.f_stop and focus_w(camera) > 1000 / camera.focal_length_mm:
        notes += ("Focused nearer than its focal length: no real lens makes an image of that, but this one does.",)
    if lens is not None and lens.prescription.is_diffractive:
        notes += (
            "All light is taken to go into the one order of its diffractive surfaces; third-order errors are left out.",
        )
    if camera.lens.model == "heightField":
        notes += ("Its height field is left out here: the numbers and drawings are of the surfaces without it.",)
    if camera.lens.has_cylinders:
        notes += (
            "Heights in its picture are measured toward the gate's corner; tangential and up are from top to bottom, sagittal "
            "and across from side to side; the third order and the pupils are those from top to bottom.",
        )
    if camera.lens.has_cylinders and camera.lens.ghosts > 0:
        notes += ("It draws no ghosts: those of cylinders are not traced.",)
    if camera.lens.drawn_squeeze != 1:
        on_film = camera.horizontal_aperture_mm / camera.lens.squeeze
        notes += (
            f"Its picture is shown stretched back, {on_film:.4g} mm wide on the film: the squeeze of {camera.lens.squeeze:g} "
            "narrows pupil, bokeh and distortion from side to side.",
        )
    return notes
