"""Rows of LensAPI's arrays of surfaces, and errors about them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from render.errors import CameraError
from usd_schemas import Prescription as PrescriptionData


def row_values(rows: PrescriptionData, field: str, count: int, camera: str) -> Sequence[Any]:
    """Return an array that has an entry for each surface, or none.

    Args:
        rows: LensAPI's arrays.
        field: name of the array's field.
        count: number of surfaces.
        camera: prim path, for messages.

    Raises:
        CameraError: it has another length.
    """
    values: Sequence[Any] = getattr(rows, field)
    if len(values) not in (0, count):
        raise row_error(rows, field, camera, f"{count} entries, like lens:prescription:radius", f"{len(values)}")
    return values


def row_error(rows: PrescriptionData, field: str, camera: str, expected: str, got: str) -> CameraError:
    """Make the error about an array, by its name in USD.

    Args:
        rows: LensAPI's arrays.
        field: name of the array's field.
        camera: prim path.
        expected: in words.
        got: in words.
    """
    name = rows.__dataclass_fields__[field].metadata["usd"]
    return CameraError(f"{name} of camera {camera} must be {expected}, got {got}", path=camera)
