"""`pullfocus bodies`: camera bodies and film formats, with their fields of view and framing guides."""

from __future__ import annotations

import argparse
import math
from typing import Any

from rich import box
from rich.table import Table

from render.cli.console import print_json
from render.cli.rich_output import print_result
from render.errors import SettingsError
from render.optics.framing import FieldOfView, FramingGuide, Gate, field_of_view, framing_guides
from usd_schemas import LibraryBody, SchemaError, library_bodies, library_body

USUAL_LENSES_MM = (18.0, 25.0, 35.0, 50.0, 75.0, 100.0)
"""Focal lengths of the table of fields of view, without --lens-mm."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run_list)
    parser.add_argument("--json", action="store_true", help="print JSON")
    actions = parser.add_subparsers(title="actions", metavar="ACTION")
    show = actions.add_parser("show", help="gate, crop factor, field of view and framing guides of one of them")
    show.set_defaults(run=run_show)
    show.add_argument("body", metavar="NAME", help="of the library")
    usual = ", ".join(f"{lens_mm:g}" for lens_mm in USUAL_LENSES_MM)
    show.add_argument("--lens-mm", metavar="MM", type=float, help=f"focal length of the field of view; else {usual}")
    # No default here, so that --json before `show` is kept.
    show.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")


def gate_of(body: LibraryBody) -> Gate:
    """Exposed area of a body."""
    return Gate(*body.gate_mm, body.squeeze, body.resolution)


def run_list(arguments: argparse.Namespace) -> None:
    """Print the library.

    Args:
        arguments: as `add_arguments` declares them.
    """
    if arguments.json:
        print_json({"bodies": [_body_json(body) for body in library_bodies()]})
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("name", "kind"):
        table.add_column(title, no_wrap=True)
    for title in ("gate in mm", "photosites", "crop"):
        table.add_column(title, no_wrap=True, justify="right")
    table.add_column("description")
    for body in library_bodies():
        crop = f"{gate_of(body).crop_factor:.2f}"
        table.add_row(
            body.name,
            body.kind,
            _size(*body.gate_mm),
            _size(*body.resolution),
            crop,
            f"{body.title}: {body.description}",
        )
    print_result(table)


def run_show(arguments: argparse.Namespace) -> None:
    """Print the numbers of one body.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the library has no such body, or there is no such lens.
    """
    try:
        body = library_body(arguments.body)
    except SchemaError as error:
        raise SettingsError(str(error), code="no_such_body", path=arguments.body) from error
    lenses_mm = USUAL_LENSES_MM if arguments.lens_mm is None else (arguments.lens_mm,)
    gate = gate_of(body)
    fields, guides = {mm: field_of_view(gate, mm) for mm in lenses_mm}, framing_guides(gate)
    if arguments.json:
        print_json(_as_json(body, fields, guides))
        return
    for table in (_numbers(body), _fields(gate, fields), _guides(guides)):
        print_result(table)


def _size(width: float, height: float) -> str:
    return f"{width:g} × {height:g}" if width else "film"


def _numbers(body: LibraryBody) -> Table:
    gate = gate_of(body)
    table = Table(box=box.SIMPLE_HEAD, show_header=False, title=body.title, title_justify="left", pad_edge=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    table.add_row("description", body.description)
    table.add_row("gate", f"{_size(*body.gate_mm)} mm, diagonal {gate.diagonal_mm:.2f} mm")
    if body.kind == "digital":
        pitch_um = 1000 * gate.width_mm / body.resolution[0]
        table.add_row("photosites", f"{_size(*body.resolution)}, {pitch_um:.2f} µm apart")
    if body.squeeze != 1:
        table.add_row("squeeze", f"{body.squeeze:g}x: shown as wide as {gate.width_mm * body.squeeze:g} mm")
    table.add_row("shape", f"{gate.aspect:.2f}:1")
    crop = f"{gate.crop_factor:.2f} corner to corner, {gate.horizontal_crop_factor:.2f} from side to side"
    table.add_row("crop factor", f"{crop}; full frame is 1")
    return table


def _fields(gate: Gate, fields: dict[float, FieldOfView]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="Field of view", title_justify="left")
    for title in ("lens", "across", "up", "corner to corner", "on full frame"):
        table.add_column(title, no_wrap=True, justify="right")
    for lens_mm, view in fields.items():
        table.add_row(
            f"{lens_mm:g} mm",
            *(f"{math.degrees(angle):.1f}°" for angle in (view.horizontal_rad, view.vertical_rad, view.diagonal_rad)),
            f"{lens_mm * gate.crop_factor:.0f} mm",
        )
    return table


def _guides(guides: tuple[FramingGuide, ...]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title="Framing guides", title_justify="left")
    is_digital = guides[0].resolution != (0, 0)
    photosites = ("photosites",) if is_digital else ()
    for title in ("shape", "mm on the gate", "of its width", "of its height", *photosites):
        table.add_column(title, no_wrap=True, justify="right")
    for guide in guides:
        table.add_row(
            guide.name,
            f"{guide.width_mm:.2f} × {guide.height_mm:.2f}",
            f"{100 * guide.width_share:.1f} %",
            f"{100 * guide.height_share:.1f} %",
            *((_size(*guide.resolution),) if is_digital else ()),
        )
    return table


def _body_json(body: LibraryBody) -> dict[str, Any]:
    gate = gate_of(body)
    return {
        "name": body.name,
        "title": body.title,
        "description": body.description,
        "kind": body.kind,
        "gateMm": list(body.gate_mm),
        "diagonalMm": gate.diagonal_mm,
        "resolution": list(body.resolution) if body.kind == "digital" else None,
        "squeeze": body.squeeze,
        "aspect": gate.aspect,
        "cropFactor": gate.crop_factor,
        "horizontalCropFactor": gate.horizontal_crop_factor,
    }


def _as_json(body: LibraryBody, fields: dict[float, FieldOfView], guides: tuple[FramingGuide, ...]) -> dict[str, Any]:
    return {
        **_body_json(body),
        "fieldsOfView": [
            {
                "lensMm": lens_mm,
                "horizontalDeg": math.degrees(view.horizontal_rad),
                "verticalDeg": math.degrees(view.vertical_rad),
                "diagonalDeg": math.degrees(view.diagonal_rad),
                "fullFrameMm": lens_mm * gate_of(body).crop_factor,
            }
            for lens_mm, view in fields.items()
        ],
        "framingGuides": [
            {
                "name": guide.name,
                "aspect": guide.aspect,
                "gateMm": [guide.width_mm, guide.height_mm],
                "shareOfGate": [guide.width_share, guide.height_share],
                "resolution": list(guide.resolution) if body.kind == "digital" else None,
            }
            for guide in guides
        ],
    }
