"""Choices of a shot: variants of its variant sets, and payloads."""

from __future__ import annotations

from pydantic import Field
from pydantic.config import JsonDict

from service.models.base import Model, PrimPath, shown_as

VARIANT_EXAMPLE: JsonDict = {
    "prim": "/World/Tram",
    "name": "livery",
    "variants": ["night", "day"],
    "selection": "night",
    "edited": False,
}
PAYLOAD_EXAMPLE: JsonDict = {"prim": "/World/Tram", "shown": True, "edited": False}


class VariantSet(Model):
    """A variant set of a prim."""

    prim: PrimPath
    name: str
    variants: list[str] = Field(description="Names of its variants, as USD orders them.")
    selection: str = Field(description="The variant that is chosen; empty for none.")
    edited: bool = Field(description="Whether an edit of the shot chooses it.")


class Payload(Model):
    """A prim with a payload."""

    prim: PrimPath
    shown: bool = Field(description="Whether the prim, with its payload, is part of the shot.")
    edited: bool = Field(description="Whether an edit of the shot says so.")


class Choices(Model):
    """Choices that a shot leaves open, outer prims first. What lies in an instance is chosen at the instance."""

    model_config = shown_as({"variantSets": [VARIANT_EXAMPLE], "payloads": [PAYLOAD_EXAMPLE], "complete": True})

    variant_sets: list[VariantSet] = Field(description="2,000 at most, with 20,000 variants in all at most.")
    payloads: list[Payload] = Field(description="2,000 at most.")
    complete: bool = Field(description="Whether all of them are listed.")
