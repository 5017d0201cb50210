"""From the library of camera bodies to models. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

import math

from render.errors import NotFoundError
from render.optics.framing import ASPECTS, Gate, field_of_view, framing_guides
from service.models.bodies import Body, BodyList, BodySummary, FieldOfView, FramingGuide, Shape
from usd_schemas import LibraryBody, SchemaError, library_bodies, library_body


def list_bodies() -> BodyList:
    """All bodies of the library."""
    shapes = [Shape(name=name, aspect=aspect) for name, aspect in ASPECTS.items()]
    return BodyList(bodies=[_summary(body) for body in library_bodies()], shapes=shapes)


def read_body(name: str, focal_lengths_mm: list[float]) -> Body:
    """One body of the library.

    Args:
        name: of it.
        focal_lengths_mm: to tell fields of view for.

    Raises:
        NotFoundError: there is none of that name.
    """
    body = body_entry(name)
    return Body(
        **_summary(body).model_dump(),
        fields_of_view=[_field(body, focal_mm) for focal_mm in focal_lengths_mm],
        framing_guides=[
            FramingGuide(
                name=guide.name,
                aspect=guide.aspect,
                share_of_gate=(guide.width_share, guide.height_share),
                gate_mm=(guide.width_mm, guide.height_mm),
                resolution=guide.resolution if body.kind == "digital" else None,
            )
            for guide in framing_guides(_gate(body))
        ],
    )


def body_entry(name: str) -> LibraryBody:
    """A body of the library.

    Raises:
        NotFoundError: there is none of that name; the message has the nearest names.
    """
    try:
        return library_body(name)
    except SchemaError as error:
        raise NotFoundError(str(error), code="no_such_body", path=name) from error


def _gate(body: LibraryBody) -> Gate:
    return Gate(*body.gate_mm, body.squeeze, body.resolution)


def _field(body: LibraryBody, focal_mm: float) -> FieldOfView:
    gate = _gate(body)
    field = field_of_view(gate, focal_mm)
    return FieldOfView(
        focal_length_mm=focal_mm,
        horizontal_deg=math.degrees(field.horizontal_rad),
        vertical_deg=math.degrees(field.vertical_rad),
        diagonal_deg=math.degrees(field.diagonal_rad),
        full_frame_mm=focal_mm * gate.crop_factor,
    )


def _summary(body: LibraryBody) -> BodySummary:
    gate = _gate(body)
    return BodySummary(
        name=body.name,
        title=body.title,
        kind=body.kind,
        gate_mm=body.gate_mm,
        resolution=body.resolution if body.kind == "digital" else None,
        squeeze=body.squeeze,
        aspect=gate.aspect,
        crop_factor=gate.crop_factor,
        description=body.description,
    )
