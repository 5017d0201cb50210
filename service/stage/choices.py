"""Function of the stage process that reads what a shot leaves open."""

from __future__ import annotations

from service.models.choices import Choices, Payload, VariantSet
from service.stage.opened import OpenedShot, stage_function
from service.storage.store import ShotRecord


@stage_function
def read_choices(opened: OpenedShot, record: ShotRecord, edits: str) -> Choices:
    """Read the variant sets and payloads of a shot with its edits."""
    with opened.use(record, edits) as shot:
        found = shot.choices.read()
    return Choices(
        variant_sets=[
            VariantSet(
                prim=choice.prim,
                name=choice.name,
                variants=list(choice.variants),
                selection=choice.selection,
                edited=choice.is_edited,
            )
            for choice in found.variants
        ],
        payloads=[
            Payload(prim=choice.prim, shown=choice.is_shown, edited=choice.is_edited) for choice in found.payloads
        ],
        complete=found.is_whole,
    )
