"""The numbers of a lens in words, as its data sheet has them."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.zooming import Zoom
from render.optics.report.lens_report import LensReport
from render.optics.report.mtf import FREQUENCIES

Row = tuple[str, str]


def data_sheet(report: LensReport) -> list[list[Row]]:
    """Names and values with their units, in groups of what belongs together: setting, picture, barrel, errors.

    Args:
        report: of the lens.
    """
    groups = [list(part(report)) for part in (_setting, _picture, _barrel, _errors)]
    return [rows for rows in groups if rows]


def metres(distance_m: float) -> str:
    """A distance for people."""
    return f"{distance_m:.3g} m" if math.isfinite(distance_m) else "infinity"


def _setting(report: LensReport) -> Iterator[Row]:
    camera = report.camera
    yield "model", camera.lens.model
    lens = report.focused
    if lens is not None and camera.lens.has_cylinders:
        sideways_mm = first_order(turned(lens.prescription)).focal_length_mm
        yield (
            "focal length",
            f"{lens.first.focal_length_mm:.2f} mm from top to bottom, {sideways_mm:.2f} mm from side to side",
        )
        yield "squeeze", f"{lens.squeeze:.3f} as focused; the picture is stretched back by {camera.lens.squeeze:g}"
    else:
        yield "focal length", f"{camera.focal_length_mm:.2f} mm"
    if report.zoom is not None:
        yield "zoom", _zoom(report.zoom)
    if report.f_stop:
        yield "f-number", _f_number(report)
    if report.paraxial_f_stop:
        paraxial = f"by the paraxial pupil f/{report.paraxial_f_stop:.3g}"
        yield "working f-number", f"f/{report.working_f_stop:.3g} as focused; {paraxial}"
    passed = report.transmittance * report.open_share
    if report.f_stop and 0 < passed < 1:
        sources = [f"{100 * report.open_share:.0f} % its openings"] if report.open_share < 1 else []
        if report.transmittance < 1:
            sources.insert(0, "as stated" if camera.lens.transmittance < 1 else "by its coatings")
        yield "T-stop", f"T{report.t_stop:.3g}: {100 * passed:.0f} % of the light pass, {', '.join(sources)}"
    yield "focused at", metres(camera.focus_distance_m) + ("" if report.is_at_infinity else " from the entrance pupil")
    if camera.lens.close_focus_m:
        yield "close focus", f"{metres(camera.lens.close_focus_m)} from the film, as marked"
    if math.isinf(report.nearest_m):
        yield "nearest focus", "infinity: its focus is fixed"
    elif report.nearest_m:
        yield "nearest focus", f"{metres(report.nearest_m)} from the entrance pupil, where its geometry ends"


def _zoom(zoom: Zoom) -> str:
    held = (
        "keeps its focus" if zoom.keeps_focus else f"vari-focal: its focus drifts by {zoom.drift_mm:.3g} mm at the film"
    )
    return f"{zoom.shortest_mm:.4g} to {zoom.longest_mm:.4g} mm; {held}"


def _f_number(report: LensReport) -> str:
    if report.set_f_stop < 0.995 * report.f_stop:
        return f"f/{report.f_stop:.3g}: set to f/{report.set_f_stop:.3g}, and it opens no wider"
    if report.f_stop < 1.005 * report.wide_open:
        return f"f/{report.f_stop:.3g}, wide open"
    return (
        f"f/{report.f_stop:.3g} (wide open f/{report.wide_open:.3g})" if report.wide_open else f"f/{report.f_stop:.3g}"
    )


def _picture(report: LensReport) -> Iterator[Row]:
    camera, curves = report.camera, report.curves
    across, up, diagonal = report.field_of_view_deg
    gate = f"{camera.horizontal_aperture_mm:g} × {camera.vertical_aperture_mm:g} mm"
    yield "angle of view", f"{across:.1f}° across, {up:.1f}° up, {diagonal:.1f}° corner to corner of {gate}"
    if math.isfinite(report.image_circle_mm):
        dark = ": the gate's corners are dark" if report.image_circle_mm < 2 * report.corner_mm else ""
        yield "image circle", f"⌀ {report.image_circle_mm:.1f} mm{dark}"
    lit = np.isfinite(curves.distortion)
    where = "in the corner" if lit[-1] else f"{curves.heights_mm[lit][-1]:.1f} mm from the axis, at the last light"
    distortion = f"{100 * curves.distortion[lit][-1] + 0.0:+.2f} %"
    if camera.lens.squeeze != 1:
        distortion += f" up, {100 * curves.distortion_across[lit][-1] + 0.0:+.2f} % across,"
    yield "distortion", f"{distortion} {where}"
    light = curves.illumination[-1]
    stops = f" ({math.log2(light):+.1f} stops)" if 0 < light < 0.999 else ""
    yield "illumination", f"{100 * light:.0f} % in the corner{stops}"
    if report.f_stop:
        sizes = ", ".join("dark" if math.isnan(spot.rms_um) else f"{spot.rms_um:.0f}" for spot in report.spots)
        yield "MTF", _transfer(report)
        yield "spots", f"{sizes} µm rms, axis to corner; diffraction's disc ⌀\u00a0{report.airy_um:.1f}\u00a0µm"


def _transfer(report: LensReport) -> str:
    mtf = report.mtf
    if mtf is None:
        return ""
    lit = np.flatnonzero(np.isfinite(mtf.field[0, 0]))
    if not len(lit):
        return "dark"
    middle = ", ".join(f"{100 * value:.0f}" for value in mtf.field[:, 0, 0])
    outer = ", ".join(f"{100 * s:.0f}/{100 * t:.0f}" for s, t in mtf.field[:, :, lit[-1]])
    frequencies = ", ".join(f"{frequency:g}" for frequency in FREQUENCIES)
    return f"{middle} % at {frequencies} lp/mm on the axis; {outer} % sagittal/tangential at {mtf.heights_mm[lit[-1]]:.1f} mm"


def _barrel(report: LensReport) -> Iterator[Row]:
    b = report.barrel
    if b is None:
        return
    yield "surfaces", f"{b.surfaces} over {b.length:.2f} mm; stop ⌀ {b.stop_diameter:.2f} mm"
    if b.floating_groups:
        travels = (f"surfaces {g.first + 1} to {g.last + 1} by {g.travel_mm:+.2f} mm" for g in b.floating_groups)
        moves = f"floating groups, from infinity to the closest configuration: {', '.join(travels)}"
    elif b.focus_group is None:
        moves = "moving the whole lens"
    else:
        moves = f"moving surfaces {b.focus_group[0] + 1} to {b.focus_group[1] + 1}"
    if b.focus_group_across is not None:
        moves += f", from side to side {b.focus_group_across[0] + 1} to {b.focus_group_across[1] + 1} too"
    yield "focuses by", moves
    yield "back focus", f"{b.back_focus:.2f} mm; film {b.film:.2f} mm behind the rear vertex"
    yield "entrance pupil", f"{_from(b.entrance_pupil, 'the front vertex')}, ⌀ {b.entrance_pupil_diameter:.2f} mm"
    away = _from(-b.exit_pupil, "the film") if math.isfinite(b.exit_pupil) else "infinitely far off"
    yield "exit pupil", f"{away}, ⌀ {b.exit_pupil_diameter:.2f} mm"
    front, rear = _from(b.front_principal, "the front vertex"), _from(b.rear_principal, "the rear vertex")
    yield "principal planes", f"H {front}; H′ {rear}"
    yield "Petzval radius", f"{b.petzval_radius:.1f} mm" if math.isfinite(b.petzval_radius) else "flat"


def _errors(report: LensReport) -> Iterator[Row]:
    waves = report.third_order
    if waves is None:
        return
    named = {
        "spherical": waves.w040,
        "coma": waves.w131,
        "astigmatism": waves.w222,
        "field curvature": waves.w220,
        "distortion": waves.w311,
        "axial colour": waves.axial_colour,
        "lateral colour": waves.lateral_colour,
    }
    sums = ", ".join(f"{name} {value + 0.0:+.3g}" for name, value in named.items() if value is not None)
    yield "third order", f"{sums} waves, at the d line and this f-number, in the corner"


def _from(distance_mm: float, what: str) -> str:
    return f"{abs(distance_mm):.2f} mm {'behind' if distance_mm >= 0 else 'before'} {what}"
