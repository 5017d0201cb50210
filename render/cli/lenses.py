"""`pullfocus lenses`: the lens library, the report and sheet of one lens, and glass by its names."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path

from rich import box
from rich.table import Table

from render.cli import lens_measurements
from render.cli.console import print_json, print_message
from render.cli.options import shared
from render.cli.options.lens_search import add_lens_search, found_lenses, search_options
from render.cli.options.shared import add_unknown_glass, glass_advice
from render.cli.rich_output import print_result
from render.cli.tables.comparison import comparison_json, comparison_table
from render.cli.tables.glass import glass_json, glass_table
from render.cli.tables.lens import lens_json, lens_table
from render.cli.tables.sheet_path import resolve_sheet_path
from render.errors import GraphicsError, InputError, NotFoundError, SettingsError
from render.files import check_writable, write_atomic
from render.model.camera import Camera
from render.optics.dispersion.names import find_glass, find_in_catalogue, near_glasses
from render.optics.lens_files import UNKNOWN_GLASS, data_sheet_text, is_data_sheet
from render.optics.lens_files.writing import target_suffix, write_lens
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.mounting import PRESCRIBED
from render.optics.prescription.zooming import set_focal_length
from render.optics.report import LensReport, lens_report
from render.shot.lens.comparison import compared_lens
from render.shot.lens.lens_alone import FULL_FRAME_MM, LensAlone, lens_alone
from render.shot.lens.measured_lens import measured_lens


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run_list)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_lens_search(parser)
    actions = parser.add_subparsers(title="actions", metavar="ACTION")
    show = actions.add_parser("show", help="numbers of a lens, and with --out a sheet that draws it")
    show.set_defaults(run=run_show)
    show.add_argument(
        "lens",
        metavar="NAME|FILE",
        help="of the library, or a .dat, .zmx, .seq, Optical Bench .txt, .roa, optiland .json or data sheet .lens file",
    )
    show.add_argument(
        "--out", metavar="PATH", type=Path, help="draw a sheet: a .png or .svg file, or a folder to put NAME.png in"
    )
    show.add_argument(
        "--tables",
        metavar="PATH",
        type=Path,
        help="write its data sheet as a .lens file; a lens with surfaces is measured as it is set",
    )
    _add_setting(show)
    _add_json(show)
    compare = actions.add_parser("compare", help="two lenses side by side, and with --out a sheet that draws both")
    compare.set_defaults(run=run_compare)
    for name in ("lens", "other"):
        compare.add_argument(name, metavar="NAME|FILE", help="of the library, or a lens file")
    compare.add_argument("--out", metavar="PATH", type=Path, help="draw a sheet: a .png or .svg file, or a folder")
    _add_setting(compare)
    _add_json(compare)
    export = actions.add_parser("export", help="write a lens as a lens file of another program")
    export.set_defaults(run=run_export)
    export.add_argument("lens", metavar="NAME|FILE", help="of the library, or a lens file; it must have surfaces")
    export.add_argument("path", metavar="PATH", type=Path, help="Zemax .zmx, CODE V .seq or Optical Bench .txt")
    export.add_argument("--focal-length", metavar="MM", type=float, help="of a zoom; without it its first position")
    add_unknown_glass(export)
    fit = actions.add_parser("fit", help="a data sheet from an MTF chart, calibrated distortion, an STMap, bokeh")
    lens_measurements.add_fit(fit)
    for name, words in (
        ("stmap", "its distortion as STMaps, for compositors"),
        ("opentrackio", "its lens part of an OpenTrackIO sample, with distortion"),
    ):
        action = actions.add_parser(name, help=words)
        action.add_argument("lens", metavar="NAME|FILE", help="of the library, or a lens file")
        _add_setting(action)
        action.set_defaults(run=run_stmap if name == "stmap" else run_opentrackio)
        if name == "stmap":
            lens_measurements.add_stmap(action)
        else:
            action.add_argument("--out", metavar="FILE", type=Path, help="file to write; without it, standard output")
    glass = actions.add_parser("glass", help="numbers of a glass, by any of its names, and its refractive indices")
    glass.set_defaults(run=run_glass)
    glass.add_argument(
        "glass", metavar="NAME", help="such as N-BK7, or with its maker NBK7_SCHOTT, or a code such as 517642"
    )
    _add_json(glass)
    for name, action in actions.choices.items():
        action.set_defaults(run=partial(_run_action, name, action.get_default("run")))


def _run_action(name: str, run: Callable[[argparse.Namespace], None], arguments: argparse.Namespace) -> None:
    """Run an action, which no search goes before."""
    searched = search_options(arguments)
    if searched:
        raise SettingsError(f"{searched[0]} before {name} searches the library, and {name} lists none: leave it out")
    run(arguments)


def _add_setting(parser: argparse.ArgumentParser) -> None:
    """Add the options that set a lens."""
    parser.add_argument(
        "--focal-length", metavar="MM", type=float, help="of a zoom; without it where the library or the file has it"
    )
    parser.add_argument("--f-stop", metavar="N", type=float, help="f-number; without it wide open")
    parser.add_argument("--focus", metavar="M", type=float, help="focus distance in metres; without it infinity")
    parser.add_argument("--gate", metavar="WxH", help="film gate in mm; without it 36x24")
    add_unknown_glass(parser)


def _add_json(parser: argparse.ArgumentParser) -> None:
    """Add --json without a default, so that it is kept where it stands before the action."""
    parser.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")


def run_list(arguments: argparse.Namespace) -> None:
    """Print the library.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the search is for what cannot be.
    """
    entries = found_lenses(arguments)
    if arguments.json:
        lenses = [
            {
                "name": entry.name,
                "title": entry.lens.name,
                "model": entry.lens.model,
                "focalLengthMm": entry.focal_length_mm,
                "focalLengthRangeMm": entry.focal_length_range_mm,
                "fStop": entry.f_stop,
                "families": list(entry.families),
                "year": entry.year,
                "source": entry.source,
                "description": entry.description,
            }
            for entry in entries
        ]
        print_json({"lenses": lenses})
        return
    if not entries:
        print_message("the library has no such lens")
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("name", "model"):
        table.add_column(title, no_wrap=True)
    for title in ("mm", "wide open", "year"):
        table.add_column(title, no_wrap=True, justify="right")
    table.add_column("families")
    table.add_column("description")
    for entry in entries:
        widest = f"f/{entry.f_stop:g}" if entry.f_stop else "pinhole"
        year, families = str(entry.year or ""), ", ".join(entry.families)
        zoom = entry.focal_length_range_mm
        focal_length = f"{entry.focal_length_mm:g}" if zoom is None else f"{zoom[0]:g}–{zoom[1]:g}"
        table.add_row(entry.name, entry.lens.model, focal_length, widest, year, families, entry.description)
    print_result(table)


def run_show(arguments: argparse.Namespace) -> None:
    """Measure a lens, print its report, and draw its sheet with --out.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the library has no such lens, or a setting is out of range.
        InputError: the file has no usable lens, or one that cannot focus at infinity.
        OutputError: the sheet cannot be written.
    """
    lens = _read_lens(arguments.lens, arguments)
    if arguments.tables is not None:
        if not is_data_sheet(arguments.tables):
            raise SettingsError(f"--tables writes a .lens file, got {arguments.tables}")
        check_writable(arguments.tables)
    target = None if arguments.out is None else resolve_sheet_path(arguments.out, lens.name)
    report = _report(lens, arguments)
    error_mm = _picture_error_mm(report)
    if arguments.json:
        print_json(lens_json(lens, report, error_mm))
    else:
        print_result(lens_table(lens, report, error_mm))
    if arguments.tables is not None:
        write_atomic(arguments.tables, data_sheet_text(measured_lens(lens, report)).encode())
        print_message(f"written: {arguments.tables}")
    if target is not None:
        from render.drawing import draw_lens_sheet  # matplotlib takes a second to load

        write_atomic(target, draw_lens_sheet(lens, report, target.suffix.lower().removeprefix(".")))
        print_message(f"drawn: {target}")


def run_compare(arguments: argparse.Namespace) -> None:
    """Measure two lenses at the same setting, print them side by side, and draw both with --out.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the library has no such lens, or a setting is out of range.
        InputError: a file has no usable lens.
        OutputError: the sheet cannot be written.
    """
    first, second = (_read_lens(name, arguments) for name in (arguments.lens, arguments.other))
    named = f"{first.name}_and_{second.name}"
    target = None if arguments.out is None else resolve_sheet_path(arguments.out, named)
    zooms = any(lens.is_zoom for lens in (first, second))  # a lens beside a zoom keeps the focal length that it has
    reports = [_report(lens, arguments, keeps_focal_length=zooms and not lens.is_zoom) for lens in (first, second)]
    sides = (
        compared_lens(first, reports[0], _picture_error_mm(reports[0])),
        compared_lens(second, reports[1], _picture_error_mm(reports[1])),
    )
    if arguments.json:
        print_json(comparison_json(sides))
    else:
        print_result(comparison_table(sides))
    if target is not None:
        from render.drawing import draw_lens_comparison  # matplotlib takes a second to load

        write_atomic(target, draw_lens_comparison(sides, target.suffix.lower().removeprefix(".")))
        print_message(f"drawn: {target}")


def run_export(arguments: argparse.Namespace) -> None:
    """Write a lens as a lens file; print what its format cannot say.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the library has no such lens, the lens has no surfaces or no such focal length, or no lens file has that
            suffix.
        InputError: the file has no usable lens.
        OutputError: the file cannot be written.
    """
    suffix = target_suffix(arguments.path)
    check_writable(arguments.path)
    alone = _read_lens(arguments.lens, arguments)
    lens = alone.camera.lens
    if lens.model not in PRESCRIBED or lens.prescription is None:
        raise SettingsError(f"{alone.name} has no surfaces to write: its model is {lens.model}")
    glass, which = lens.prescription, "zoom and focus the first"
    if arguments.focal_length is not None:
        alone.set_to(None, None, FULL_FRAME_MM, focal_length_mm=arguments.focal_length)  # refuses what it has not
        glass, which = set_focal_length(glass, arguments.focal_length), "focus that at infinity"
    written = write_lens(complete_prescription(glass), suffix)
    notes = list(written.notes)
    if glass.configurations:
        notes.append(f"Of its positions of {which} is written.")
    if lens.height_field is not None:
        notes.append("The heights that are added to its surfaces are not written.")
    if lens.squeeze != 1:
        notes.append(f"Its squeeze of {lens.squeeze:g} is not written.")
    write_atomic(arguments.path, written.content)
    for note in notes:
        print_message(f"note: {note}")
    print_message(f"written: {arguments.path}")


def run_stmap(arguments: argparse.Namespace) -> None:
    """Write the STMaps of a lens (`lens_measurements.run_stmap`)."""
    lens_measurements.run_stmap(arguments, _camera)


def run_opentrackio(arguments: argparse.Namespace) -> None:
    """Write the OpenTrackIO lens part of a lens (`lens_measurements.run_opentrackio`)."""
    lens_measurements.run_opentrackio(arguments, _camera)


def _camera(arguments: argparse.Namespace) -> Camera:
    lens = _read_lens(arguments.lens, arguments)
    return _set_to(lens, arguments)


def _set_to(lens: LensAlone, arguments: argparse.Namespace, *, keeps_focal_length: bool = False) -> Camera:
    focal_length_mm = None if keeps_focal_length else arguments.focal_length
    gate_mm = shared.read_gate(arguments.gate)
    return lens.set_to(arguments.f_stop, arguments.focus, gate_mm, focal_length_mm=focal_length_mm)


def run_glass(arguments: argparse.Namespace) -> None:
    """Print the numbers of a glass.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: no catalogue has such a glass; the message has the nearest names.
    """
    name = arguments.glass
    found, medium = find_in_catalogue(name), find_glass(name)
    if medium is None:
        near = near_glasses(name)
        hint = f", did you mean {' or '.join(near)}?" if near else ""
        raise SettingsError(f"glass {name[:40]!r} is in no catalogue{hint}", code=UNKNOWN_GLASS)
    if arguments.json:
        print_json(glass_json(medium, found))
    else:
        print_result(glass_table(medium, found))


def _report(lens: LensAlone, arguments: argparse.Namespace, *, keeps_focal_length: bool = False) -> LensReport:
    camera = _set_to(lens, arguments, keeps_focal_length=keeps_focal_length)
    try:
        return lens_report(camera, lens.f_stop)
    except SettingsError as error:
        if (
            error.code == "focus_out_of_reach" and arguments.focus is None
        ):  # infinity is the default, not the user's choice
            raise InputError(f"{error.detail}; --focus sets another distance", code=error.code) from error
        raise


def _picture_error_mm(report: LensReport) -> float | None:
    """Error of the rays of pictures through the lens; None without surfaces, without polynomials, or without a device."""
    lens = report.camera.lens
    if lens.model not in ("spherical", "prescription") or report.focused is None:
        return None
    if lens.has_cylinders or lens.has_outlines:
        return None
    from render.trace.table_error import table_error_mm  # loads OpenGL

    try:
        return table_error_mm(report.camera)
    except GraphicsError:
        return None


def _read_lens(name: str, arguments: argparse.Namespace) -> LensAlone:
    try:
        with glass_advice():
            return lens_alone(name, arguments.allow_unknown_glass)
    except NotFoundError as error:
        raise SettingsError(error.detail, code=error.code, path=error.path) from error
