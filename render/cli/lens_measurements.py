"""`pullfocus lenses fit`, `stmap` and `opentrackio`: lenses from measurements, and their distortion for other tools."""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from render.cli.console import print_message
from render.cli.options import shared
from render.errors import InputError, SettingsError
from render.files import check_writable, write_atomic
from render.model.camera import Camera
from render.optics.lens_files import data_sheet_text, is_data_sheet, read_measured_lens
from render.optics.measured.opentrackio_lens import FAR_AWAY_M, MODEL, tracked_distortion
from render.optics.measured.stmap import Direction, make_stmap
from render.shot.lens.fitted_lens import Measurements, encode_mask, fit_lens, iris_layer, read_iris
from render.shot.lens.stmap_file import MAX_PIXELS, encode_stmap

CameraReader = Callable[[argparse.Namespace], Camera]

_DIRECTIONS: tuple[Direction, ...] = ("undistort", "distort")
_MOST_OVERSCAN = 4.0


def add_fit(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `run_fit`."""
    parser.set_defaults(run=run_fit)
    parser.add_argument("out", metavar="FILE.lens", type=Path, help="data sheet to write")
    parser.add_argument("--name", default="", help="name of the lens")
    parser.add_argument("--focal-length", metavar="MM", type=float, default=0.0, help="of the lens")
    parser.add_argument("--f-stop", metavar="N", type=float, default=0.0, help="f-number of the measurements")
    parser.add_argument("--close-focus", metavar="M", type=float, default=0.0, help="marked on the lens, from the film")
    parser.add_argument(
        "--gate", metavar="WxH", help="film gate that distortion was measured on, mm; without it the file's, else 36x24"
    )
    parser.add_argument("--base", metavar="FILE.lens", type=Path, help="data sheet to complete")
    parser.add_argument("--mtf", metavar="CSV", type=Path, help="chart: height_mm, lp_mm, sagittal, tangential")
    parser.add_argument(
        "--geometric",
        action="store_true",
        help="the chart is a lens designer's without diffraction, not a measured one",
    )
    parser.add_argument(
        "--distortion",
        metavar="FILE",
        type=Path,
        help="OpenCV's calibration (.json, .yaml), an OpenTrackIO sample (.json), or an STMap (.exr)",
    )
    parser.add_argument(
        "--direction", choices=_DIRECTIONS, default="undistort", help="which STMap it is; without it undistort"
    )
    parser.add_argument(
        "--bokeh",
        metavar="IMAGE",
        type=Path,
        help="photograph of a point out of focus: writes an iris beside the sheet",
    )


def run_fit(arguments: argparse.Namespace) -> None:
    """Fit a data sheet to measurements, and write it.

    Args:
        arguments: as `add_fit` declares them.

    Raises:
        SettingsError: a number is out of range or missing.
        InputError: a file has no such measurements.
        OutputError: a file cannot be written.
    """
    out: Path = arguments.out
    if not is_data_sheet(out):
        raise SettingsError(f"lenses fit writes a .lens file, got {out}")
    numbers = {"--focal-length": 1e5, "--f-stop": 1000.0, "--close-focus": 1000.0}
    for option, most in numbers.items():
        value = getattr(arguments, option.removeprefix("--").replace("-", "_"))
        if not 0 <= value <= most:
            raise SettingsError(f"{option} takes a number above 0 and up to {most:g}, got {value:g}")
    gate = None if arguments.gate is None else shared.read_gate(arguments.gate)
    if gate is not None and not all(0.1 <= side <= 1000 for side in gate):
        raise SettingsError(f"--gate takes sides from 0.1 to 1000 mm, got {gate[0]:g} x {gate[1]:g}")
    check_writable(out)
    iris = None if arguments.bokeh is None else read_iris(arguments.bokeh)
    sheet_is_given = any(given is not None for given in (arguments.mtf, arguments.distortion, arguments.base))
    if sheet_is_given or iris is None:
        fitted = fit_lens(
            Measurements(
                name=arguments.name,
                focal_length_mm=arguments.focal_length,
                f_stop=arguments.f_stop,
                close_focus_m=arguments.close_focus,
                gate_mm=gate,
                known=None if arguments.base is None else read_measured_lens(arguments.base),
                mtf=arguments.mtf,
                has_diffraction=not arguments.geometric,
                distortion=arguments.distortion,
                direction=arguments.direction,
            )
        )
        for note in fitted.notes:
            print_message(note)
        write_atomic(out, data_sheet_text(fitted.lens).encode())
        print_message(f"written: {out}")
    if iris is not None:
        mask, layer = out.with_name(f"{out.stem}_iris.exr"), out.with_name(f"{out.stem}_iris.usda")
        for note in iris.notes:
            print_message(note)
        x, y = iris.centre_px
        print_message(f"bokeh: a disc of {2 * iris.radius_px:.0f} pixels around {x:.1f}, {y:.1f}")
        write_atomic(mask, encode_mask(iris.mask))
        write_atomic(layer, iris_layer(iris, mask.name).encode())
        print_message(f"written: {mask}, {layer}")


def add_stmap(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `run_stmap` beside those of the lens."""
    parser.add_argument("--width", metavar="PX", type=int, required=True, help="width of the picture")
    parser.add_argument(
        "--overscan", metavar="FACTOR", type=float, default=1.0, help="of the undistorted picture's size"
    )
    parser.add_argument("--direction", choices=_DIRECTIONS, help="one of the two maps; without it both are written")
    parser.add_argument(
        "--out",
        metavar="FILE.exr",
        type=Path,
        required=True,
        help="with both maps, FILE_undistort.exr and FILE_distort.exr",
    )


def run_stmap(arguments: argparse.Namespace, read_camera: CameraReader) -> None:
    """Write the STMaps of a lens.

    Args:
        arguments: as `add_stmap` declares them.
        read_camera: camera with the lens that they name.

    Raises:
        SettingsError: a number is out of range, or there is no such lens.
        OutputError: a file cannot be written.
    """
    out: Path = arguments.out
    if out.suffix.lower() != ".exr":
        raise SettingsError(f"lenses stmap writes an .exr file, got {out}")
    if not 1 <= arguments.overscan <= _MOST_OVERSCAN:
        raise SettingsError(f"--overscan takes a factor from 1 to {_MOST_OVERSCAN:g}, got {arguments.overscan:g}")
    width = arguments.width
    if not 8 <= width <= MAX_PIXELS:
        raise SettingsError(f"--width takes 8 pixels or more, and a map at most {MAX_PIXELS} pixels")
    camera = read_camera(arguments)
    height = round(width * camera.vertical_aperture_mm / camera.horizontal_aperture_mm)
    if not (min(width, height) >= 8 and width * height * arguments.overscan**2 <= MAX_PIXELS):
        raise SettingsError(
            f"--width takes 8 pixels or more, and a map at most {MAX_PIXELS} pixels, got {width} x {max(height, 0)}"
        )
    pads = math.ceil(width * (arguments.overscan - 1) / 2), math.ceil(height * (arguments.overscan - 1) / 2)
    for direction in (direction for direction in _DIRECTIONS if arguments.direction in (None, direction)):
        file = out if arguments.direction else out.with_name(f"{out.stem}_{direction}.exr")
        check_writable(file)
        padded = pads if direction == "undistort" else (0, 0)
        write_atomic(file, encode_stmap(make_stmap(camera, (width, height), direction, padded)))
        print_message(f"written: {file}")


def run_opentrackio(arguments: argparse.Namespace, read_camera: CameraReader) -> None:
    """Print, or write, an OpenTrackIO sample with the lens part of a lens.

    Args:
        arguments: of the lens, and ``out``.
        read_camera: camera with the lens that they name.

    Raises:
        SettingsError: a number is out of range, or there is no such lens.
        InputError: the model cannot describe the lens: an anamorphic one, or a steep fisheye.
        OutputError: the file cannot be written.
    """
    camera = read_camera(arguments)
    if camera.lens.squeeze != 1 or camera.lens.has_cylinders:
        raise InputError(f"{camera.path} is anamorphic, and OpenTrackIO's distortion is round", code="bad_lens")
    found = tracked_distortion(camera)
    if not found.holds:
        raise InputError(
            f"OpenTrackIO's distortion cannot describe {camera.path}: it would be off by {found.worst_mm:.3g} mm; "
            "pullfocus lenses stmap can",
            code="bad_lens",
        )
    lens: dict[str, Any] = {"distortion": [{"model": MODEL, "radial": list(found.radial)}]}
    lens |= {"fStop": camera.f_stop} if camera.f_stop else {}
    lens |= {"pinholeFocalLength": camera.focal_length_mm, "focusDistance": min(camera.focus_distance_m, FAR_AWAY_M)}
    sensor = {"width": camera.horizontal_aperture_mm, "height": camera.vertical_aperture_mm}
    sample = {
        "static": {"camera": {"activeSensorPhysicalDimensions": sensor}, "lens": {"model": camera.path}},
        "protocol": {"name": "OpenTrackIO", "version": [1, 0, 1]},
        "lens": lens,
    }
    text = json.dumps(sample, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    print_message(f"distortion: {1000 * found.worst_mm:.1f} µm on the film are left at most")
    if arguments.out is None:
        print(text, end="")
    else:
        check_writable(arguments.out)
        write_atomic(arguments.out, text.encode())
        print_message(f"written: {arguments.out}")
