"""Settings that the two cameras of a stereo rig share: lens, focus and film, unless each says otherwise."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Usd

_OWN = (
    "xformOp",
    "backPlate:",
    "clippingPlanes",
    "horizontalApertureOffset",
    "verticalApertureOffset",
    "tiltShift:shift",
)
"""Starts of names of what each camera has for itself: its place, its convergence, and what it sees."""
_OF_PRIMS = ("stereoRole", "visibility", "purpose", "proxyPrim")


def give_settings(giver: Usd.Prim, taker: Usd.Prim) -> list[str]:
    """Author on one camera what is authored on another alone, over time too, in the stage's edit target.

    Args:
        giver: camera whose settings are given.
        taker: camera that is given them.

    Returns:
        Names of the properties that were given.
    """
    missing = [prop for prop in giver.GetAuthoredProperties() if _is_shared(prop) and not _has(taker, prop.GetName())]
    for schema in _missing_schemas(giver, taker) if missing else ():
        taker.AddAppliedSchema(schema)
    for prop in missing:
        prop.FlattenTo(taker)
    return [prop.GetName() for prop in missing]


def lacks_settings(giver: Usd.Prim, taker: Usd.Prim) -> bool:
    """Whether `give_settings` would give any."""
    return any(_is_shared(prop) and not _has(taker, prop.GetName()) for prop in giver.GetAuthoredProperties())


def _is_shared(prop: Usd.Property) -> bool:
    name = prop.GetName()
    return not name.startswith(_OWN) and name not in _OF_PRIMS


def _has(prim: Usd.Prim, name: str) -> bool:
    return bool(prim.HasProperty(name) and prim.GetProperty(name).IsAuthored())


def _missing_schemas(giver: Usd.Prim, taker: Usd.Prim) -> Iterable[str]:
    theirs = taker.GetAppliedSchemas()
    return [name for name in giver.GetAppliedSchemas() if name not in theirs and not name.startswith("BackPlateAPI:")]
