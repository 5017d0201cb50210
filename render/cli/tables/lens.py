"""Report of a lens as a table and as JSON."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from rich import box
from rich.table import Table

from render.cli.console import camel_case_keys, finite
from render.errors import one_line
from render.model.arrays import DoubleArray
from render.optics.prescription.zooming import Zoom
from render.optics.report import LensReport, data_sheet
from render.optics.report.field import WAVELENGTHS_NM
from render.optics.report.mtf import FREQUENCIES, LIGHT
from render.shot.lens.lens_alone import LensAlone

_PICTURE_ERROR_MM = 0.004  # as render.trace.prescription_table.FILM_ERROR_MM, which loads OpenGL


def lens_json(lens: LensAlone, report: LensReport, picture_error_mm: float | None) -> dict[str, Any]:
    """Convert a report to JSON; keys end with their unit, and infinite or dark values are null.

    Args:
        lens: the lens.
        report: of the lens.
        picture_error_mm: error on the film of the rays of pictures; None where it is not known.
    """
    camera = report.camera
    across, up, diagonal = report.field_of_view_deg
    return {
        **finite(
            {
                "name": lens.name,
                "title": lens.title,
                "description": lens.description,
                "source": lens.source,
                "model": camera.lens.model,
                "focalLengthMm": camera.focal_length_mm,
                "fStopWideOpen": report.wide_open,
                "fStopSet": report.set_f_stop,
                "fStop": report.f_stop,
                "fStopWorking": report.working_f_stop or None,
                "fStopParaxial": report.paraxial_f_stop or None,
                "transmittance": report.transmittance,
                "transmittanceSource": "stated" if report.transmittance == camera.lens.transmittance else "coatings",
                "openShare": report.open_share,
                "tStop": report.t_stop,
                "focusDistanceM": camera.focus_distance_m,
                "closeFocusM": camera.lens.close_focus_m,
                "nearestFocusM": report.nearest_m,
                "squeeze": camera.lens.squeeze,
                "squeezeAsFocused": report.focused.squeeze if camera.lens.has_cylinders and report.focused else None,
                "imageCircleMm": report.image_circle_mm,
                "airyDiameterUm": report.airy_um,
                "cornerDistortion": float(report.curves.distortion[-1]),
                "cornerDistortionAcross": float(report.curves.distortion_across[-1]),
                "cornerIllumination": float(report.curves.illumination[-1]),
            }
        ),
        "gateMm": [camera.horizontal_aperture_mm, camera.vertical_aperture_mm],
        "fieldOfViewDeg": {"horizontal": across, "vertical": up, "diagonal": diagonal},
        "zoom": _zoom(report.zoom),
        "barrelMm": finite(camel_case_keys(asdict(report.barrel))) if report.barrel else None,
        "thirdOrderWaves": finite(camel_case_keys(asdict(report.third_order))) if report.third_order else None,
        "spots": [finite({"heightMm": spot.height_mm, "rmsUm": spot.rms_um}) for spot in report.spots],
        "spotWavelengthsNm": list(WAVELENGTHS_NM),
        "curves": {key: _numbers(values) for key, values in camel_case_keys(vars(report.curves)).items()},
        "bokeh": _bokeh(report),
        "mtf": _mtf(report),
        "colour": _colour(report),
        "focusScale": [finite(camel_case_keys(asdict(mark))) | {"label": mark.label} for mark in report.focus_marks],
        "pictureErrorUm": None if picture_error_mm is None else 1000 * picture_error_mm,
        "notes": [*report.notes, *_picture_notes(picture_error_mm)],
    }


def _zoom(zoom: Zoom | None) -> dict[str, Any] | None:
    if zoom is None:
        return None
    return {
        "shortestMm": zoom.shortest_mm,
        "longestMm": zoom.longest_mm,
        "keepsFocus": zoom.keeps_focus,
        "driftMm": zoom.drift_mm,
        "positions": [
            {
                "focalLengthMm": position.focal_length_mm,
                "fStop": position.far.f_stop or None,
                "focusShiftMm": position.focus_shift_mm,
                "closestMm": position.near[-1].object_mm if position.near else None,
            }
            for position in zoom.positions
        ],
    }


def _numbers(values: DoubleArray) -> list[float | None]:
    return [float(value) if math.isfinite(value) else None for value in values]


def _picture_notes(error_mm: float | None) -> list[str]:
    if error_mm is None or error_mm <= _PICTURE_ERROR_MM:
        return []
    return [
        f"Rays of pictures are up to {1000 * error_mm:.1f} µm off on the film, more than the {1000 * _PICTURE_ERROR_MM:g} µm that"
        " their table is refined for."
    ]


def _mtf(report: LensReport) -> dict[str, Any] | None:
    mtf = report.mtf
    if mtf is None:
        return None
    directions = ("sagittal", "tangential")
    over_field = [
        {
            "linePairsPerMm": frequency,
            **{
                f"{direction}{kind}": _numbers(values[f, d])
                for kind, values in (("", mtf.field), ("Geometric", mtf.field_geometric))
                for d, direction in enumerate(directions)
            },
        }
        for f, frequency in enumerate(FREQUENCIES)
    ]
    through_focus = [
        {
            "linePairsPerMm": frequency,
            "heightMm": float(height),
            **{direction: _numbers(mtf.focus[f, d, p]) for d, direction in enumerate(directions)},
        }
        for f, frequency in enumerate(FREQUENCIES)
        for p, height in enumerate(mtf.focus_heights_mm)
    ]
    return {
        "wavelengths": [{"nm": nm, "weight": weight} for nm, weight in LIGHT],
        "diffraction": "wavefront" if mtf.is_exact else "rays times the perfect lens",
        "heightsMm": _numbers(mtf.heights_mm),
        "overField": over_field,
        "filmShiftsMm": _numbers(mtf.shifts_mm),
        "throughFocus": through_focus,
    }


def _colour(report: LensReport) -> dict[str, Any] | None:
    colour = report.colour
    if colour is None:
        return None
    return {
        "wavelengthsNm": list(WAVELENGTHS_NM),
        "pupil": _numbers(colour.pupil),
        "longitudinalMm": [_numbers(values) for values in colour.longitudinal_mm],
        "heightsMm": _numbers(colour.heights_mm),
        "lateralUm": [_numbers(values) for values in colour.lateral_um],
    }


def _bokeh(report: LensReport) -> dict[str, Any] | None:
    if report.bokeh is None:
        return None
    return {
        "focusDistanceM": report.bokeh.focus_distance_m,
        "discMm": report.bokeh.disc_mm,
        "places": [
            {
                "name": place.name,
                "right": place.place[0],
                "up": place.place[1],
                "light": place.share,
                "widthMm": place.width_mm,
            }
            for place in report.bokeh.places
        ],
    }


def lens_table(lens: LensAlone, report: LensReport, picture_error_mm: float | None) -> Table:
    """Convert a report to a table, one row for each number.

    Args:
        lens: the lens.
        report: of the lens.
        picture_error_mm: error on the film of the rays of pictures; None where it is not known.
    """
    table = Table(
        box=box.SIMPLE_HEAD, show_header=False, title=one_line(lens.title), title_justify="left", pad_edge=False
    )
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    for group in data_sheet(report):
        for row in group:
            table.add_row(*row)
        table.add_section()
    if picture_error_mm is not None:
        table.add_row("picture's rays", f"within {1000 * picture_error_mm:.1f} µm of exact rays on the film")
        table.add_section()
    if lens.source:
        table.add_row("source", one_line(lens.source))
    for note in (*report.notes, *_picture_notes(picture_error_mm)):
        table.add_row("note", one_line(note))
    return table
