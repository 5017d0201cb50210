"""A data sheet from measurements: an MTF chart, a calibrated distortion or an STMap, on top of what a sheet says already."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from render.errors import InputError, SettingsError
from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.optics.data_sheet import at_heights
from render.optics.framing import FULL_FRAME_MM
from render.optics.lens_files import MeasuredLens
from render.optics.lens_files.lens_text import decode
from render.optics.measured.bokeh_photo import MeasuredIris, measure_iris
from render.optics.measured.calibration_file import MAX_BYTES, Calibration, parse_calibration
from render.optics.measured.mtf_chart import read_mtf_chart
from render.optics.measured.mtf_fit import fit_blur
from render.optics.measured.radial_distortion import RadialDistortion, fit_radial
from render.optics.measured.stmap import Direction, stmap_pairs_mm
from render.output.image_file import file_bytes
from render.shot.lens.stmap_file import read_stmap
from render.stage.camera.planes import read_first_channel
from render.stage.materials.image_files import TextureError

MAP_SUFFIXES = (".exr", ".tif", ".tiff")
_SMALLEST_STOP = 22.0
_OFF_CENTRE = 0.002  # of the picture's width
_MOST_PX = 2**24


@dataclass(frozen=True, eq=False)
class Measurements:
    """Measurements of a lens, and how they were made.

    Attributes:
        name: of the lens.
        focal_length_mm: 0 where the calibration is to say it.
        f_stop: of the measurements, and wide open.
        close_focus_m: from the film; 0 where none is marked.
        gate_mm: width and height of the gate on which distortion was measured; None for what its file says, else 36 by 24.
        known: a lens by its data sheet, which the measurements complete and replace.
        mtf: CSV file of an MTF chart.
        has_diffraction: whether the chart has diffraction in it.
        distortion: file of a calibration or an STMap.
        direction: which of the two STMaps it is.
    """

    name: str
    focal_length_mm: float
    f_stop: float
    close_focus_m: float
    gate_mm: tuple[float, float] | None
    known: MeasuredLens | None = None
    mtf: Path | None = None
    has_diffraction: bool = True
    distortion: Path | None = None
    direction: Direction = "undistort"


@dataclass(frozen=True)
class FittedLens:
    """A lens by a data sheet that was fitted.

    Attributes:
        lens: the lens.
        notes: how well the sheet gives the measurements, and what was left out, one sentence each.
    """

    lens: MeasuredLens
    notes: tuple[str, ...]


def fit_lens(given: Measurements) -> FittedLens:
    """Fit a data sheet.

    Args:
        given: the measurements.

    Raises:
        SettingsError: a number is out of range or missing.
        InputError: a file has no such measurements; the message names it.
    """
    known = given.known
    notes: list[str] = []
    sheets = [] if known is None else [known.sheet]
    sources = [] if known is None else list(known.sources)
    focal = given.focal_length_mm or (known.focal_length_mm if known is not None else 0.0)
    f_stop = given.f_stop or (known.sheet.f_stop if known is not None else 0.0)
    if known is not None and known.sheet.f_stop not in (0.0, f_stop):
        raise SettingsError(f"the tables of --base were measured at f/{known.sheet.f_stop:.3g}: leave --f-stop out")
    if given.distortion is not None:
        focal, found = _distortion(given.distortion, focal, given, notes)
        bent = tuple(np.round(found.distortion, 7).tolist())
        sheets.append(DataSheet(tuple(np.round(found.heights_mm, 6).tolist()), distortion=bent))
        sources.append(f"distortion from {given.distortion.name}")
    if not focal:
        raise SettingsError("the focal length is not known: state it with --focal-length")
    if given.mtf is not None:
        if not f_stop:
            raise SettingsError("an MTF chart holds at one f-number: state it with --f-stop")
        chart = read_mtf_chart(decode(read_small(given.mtf), given.mtf.name))
        blur = fit_blur(
            chart,
            focal,
            f_stop,
            merged(sheets, f_stop) if sheets else None,
            diffraction=given.has_diffraction,
        )
        sheets.append(DataSheet(blur.sheet.heights_mm, sagittal_blur_mm=blur.sheet.sagittal_blur_mm))
        sheets.append(DataSheet(blur.sheet.heights_mm, tangential_blur_mm=blur.sheet.tangential_blur_mm))
        height, per_mm = blur.worst_at
        notes.append(
            f"MTF: {100 * blur.rms:.1f} % rms of contrast are left, at most {100 * blur.worst:.1f} % "
            f"({per_mm:g} lp/mm at {height:g} mm)."
        )
        sources.append(f"blur from {given.mtf.name} at f/{f_stop:g}")
    if not sheets:
        raise SettingsError("there is nothing to fit: state --mtf, --distortion or --base")
    stops = known.f_stops if known is not None else (f_stop, max(_SMALLEST_STOP, f_stop) if f_stop else 0.0)
    lens = MeasuredLens(
        given.name or (known.name if known is not None else "Measured lens"),
        focal,
        merged(sheets, f_stop),
        stops,
        given.close_focus_m or (known.close_focus_m if known is not None else 0.0),
        tuple(sources),
    )
    return FittedLens(lens, tuple(notes))


def merged(sheets: list[DataSheet], f_stop: float) -> DataSheet:
    """One sheet of several, over all of their heights; of two that have the same column the later one counts.

    Args:
        sheets: at least one.
        f_stop: of all.
    """
    by_column = {
        column.name: sheet
        for sheet in sheets
        for column in fields(DataSheet)
        if column.name not in ("heights_mm", "f_stop") and getattr(sheet, column.name)
    }
    heights = np.unique(np.round(np.concatenate([sheet.heights_mm for sheet in sheets]), 4))
    columns = {name: tuple(at_heights(sheet, name, heights).tolist()) for name, sheet in by_column.items()}
    return DataSheet(tuple(heights.tolist()), **columns, f_stop=f_stop)


def _distortion(
    path: Path, focal_length_mm: float, given: Measurements, notes: list[str]
) -> tuple[float, RadialDistortion]:
    """Focal length and distortion by a calibration or an STMap; what is to be said of them is added to the notes."""
    gate_mm = given.gate_mm or FULL_FRAME_MM
    if path.suffix.lower() in MAP_SUFFIXES:
        stmap = read_stmap(path)
        found = fit_radial(*stmap_pairs_mm(stmap, given.direction, gate_mm, path.name), path.name)
        px_per_mm = stmap.size[0] / gate_mm[0]
        if abs(found.centre_scale - 1) > 1e-3:
            notes.append(
                f"The map changes the size of the picture's middle by {100 * (found.centre_scale - 1):+.2f} %, which counts as "
                "part of the focal length and not as distortion."
            )
    else:
        calibration = parse_calibration(read_small(path), path.name)
        if given.gate_mm is None and any(calibration.gate_mm):
            gate_mm = calibration.gate_mm
            if not all(0.1 <= side <= 1000 for side in gate_mm):
                what = f"its sensor must have sides from 0.1 to 1000 mm, got {gate_mm[0]:g} x {gate_mm[1]:g}"
                raise InputError(f"{path.name}: {what}", code="bad_calibration", path=path.name)
            notes.append(f"The gate is {gate_mm[0]:g} x {gate_mm[1]:g} mm by {path.name}.")
        pinhole = calibration.pinhole_mm(gate_mm)
        if not focal_length_mm and pinhole:
            focal_length_mm = round(pinhole, 4)
            notes.append(f"The focal length is {focal_length_mm:g} mm by {path.name}.")
        elif pinhole and abs(pinhole / focal_length_mm - 1) > 0.02:
            notes.append(f"{path.name} says a focal length of {pinhole:.4g} mm; {focal_length_mm:g} mm count.")
        if not focal_length_mm:
            raise SettingsError(f"{path.name} does not say its focal length in mm: state it with --focal-length")
        found = fit_radial(*calibration.pairs_mm(focal_length_mm, math.hypot(*gate_mm) / 2), path.name)
        px_per_mm = calibration.size_px[0] / gate_mm[0]
        notes.extend(_centre_notes(calibration, gate_mm))
    off = f"{1000 * found.rms_mm:.1f} µm rms on the film are left, at most {1000 * found.worst_mm:.1f} µm"
    pixels = f" ({found.worst_mm * px_per_mm:.2f} pixels)" if px_per_mm else ""
    notes.append(f"Distortion: {off}{pixels}: what is not the same all around the axis.")
    if math.isfinite(found.cut_mm):
        notes.append(
            f"Beyond {found.cut_mm:.1f} mm the picture is wider than a data sheet can say; that part is left out."
        )
    return focal_length_mm, found


def _centre_notes(calibration: Calibration, gate_mm: tuple[float, float]) -> list[str]:
    centre, size = np.array(calibration.centre), np.array(calibration.size_px)
    if calibration.focal_length_mm:
        off = float(np.hypot(*centre)) / gate_mm[0]
    elif size.all():
        off = float(np.hypot(*((centre - (size - 1) / 2) / size[0])))
    else:
        return []
    if off < _OFF_CENTRE:
        return []
    return [
        f"Its optical axis is {100 * off:.1f} % of the picture's width off the middle; a data sheet has it in the middle."
    ]


def read_iris(path: Path) -> MeasuredIris:
    """Measure the iris of a photograph of a point out of focus.

    Args:
        path: of an image; one with whole numbers is taken as sRGB, one with floats as linear light.

    Raises:
        InputError: it cannot be read, or shows no such disc.
    """
    try:
        stored, one = read_first_channel(str(path))
    except TextureError as error:
        raise InputError(f"{path.name} {error}", code="bad_photograph", path=str(path)) from error
    if stored.size > _MOST_PX:
        raise InputError(
            f"{path.name} has {stored.size} pixels, at most {_MOST_PX} are read", code="bad_photograph", path=str(path)
        )
    values = stored.astype(np.float64) / one
    if stored.dtype.kind == "u":
        values = np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
    return measure_iris(values, path.name)


def encode_mask(mask: DoubleArray) -> bytes:
    """Encode an iris mask as OpenEXR, for `aperture:mask`."""
    spec = oiio.ImageSpec(mask.shape[1], mask.shape[0], 1, oiio.FLOAT)
    spec.channelnames = ("Y",)
    return file_bytes(".exr", [(spec, mask.astype(np.float32)[..., None])])


def iris_layer(iris: MeasuredIris, mask_name: str) -> str:
    """Text of a USD layer whose default prim gives a camera that references it this iris.

    Args:
        iris: the iris.
        mask_name: file name of its mask, beside the layer.
    """
    weights = ", ".join(f"{weight:g}" for weight in iris.weights)
    ends, escaped = ("@@@", mask_name.replace("@@@", "\\@@@")) if "@" in mask_name else ("@", mask_name)
    return (
        '#usda 1.0\n(\n    defaultPrim = "Iris"\n)\n\n'
        'over "Iris" (\n    prepend apiSchemas = ["ApertureAPI"]\n)\n{\n'
        f"    asset aperture:mask = {ends}./{escaped}{ends}\n    double[] aperture:radialWeights = [{weights}]\n}}\n"
    )


def read_small(path: Path) -> bytes:
    """Read a file of numbers, up to one byte beyond what such a file may have.

    Raises:
        InputError: it cannot be read.
    """
    try:
        if not path.is_file():
            raise InputError(f"{path} is no file", code="bad_measurement", path=str(path))
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}", code="bad_measurement", path=str(path)) from error
