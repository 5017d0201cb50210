"""Applies schemas to cameras, and takes them back where what was to be said with them is refused."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from pxr import Usd

from usd_schemas.errors import SchemaError

_FIELD = "apiSchemas"


def apply(prim: Usd.Prim, *schema: str) -> None:
    """Apply a schema in the edit target, unless the prim has it.

    Args:
        prim: the camera.
        schema: the schema's name, and the instance's where it is a multiple-apply schema.

    Raises:
        SchemaError: it cannot be applied to that prim, or under that name.
    """
    if prim.HasAPI(*schema):
        return
    # ApplyAPI itself does not ask whether the prim is a camera.
    allowed = prim.CanApplyAPI(*schema)
    if not allowed:
        raise SchemaError(f"{':'.join(schema)} cannot be applied to {prim.GetPath()}: {allowed.whyNot}")
    prim.ApplyAPI(*schema)


@contextmanager
def applied(prim: Usd.Prim, *schema: str) -> Iterator[None]:
    """Apply a schema for a block that authors with it; a `SchemaError` in the block leaves the layer as it was."""
    target = prim.GetStage().GetEditTarget()
    spec = target.GetPrimSpecForScenePath(prim.GetPath())
    before = spec.GetInfo(_FIELD) if spec is not None and spec.HasInfo(_FIELD) else None
    apply(prim, *schema)
    try:
        yield
    except SchemaError:
        made = target.GetPrimSpecForScenePath(prim.GetPath())
        if made is not None and before is not None:
            made.SetInfo(_FIELD, before)
        elif made is not None:
            made.ClearInfo(_FIELD)
            target.GetLayer().ScheduleRemoveIfInert(made)
        raise
