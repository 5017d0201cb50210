"""Choices that a stage leaves open: variants of its variant sets, and payloads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pxr import Sdf, Usd

from render.errors import NotFoundError, SettingsError
from render.near_names import hint

MOST_CHOICES = 2_000
"""Variant sets, and payloads, that are listed of a stage."""
MOST_VARIANTS = 20_000
"""Variants that are listed of all variant sets of a stage: prims that inherit one class multiply them."""


@dataclass(frozen=True)
class VariantChoice:
    """A variant set of a prim.

    Attributes:
        prim: path of the prim.
        name: of the variant set.
        variants: names of its variants, as USD orders them.
        selection: the variant that is chosen; empty for none.
        is_edited: whether the edit layer chooses it.
    """

    prim: str
    name: str
    variants: tuple[str, ...]
    selection: str
    is_edited: bool


@dataclass(frozen=True)
class PayloadChoice:
    """A prim with a payload.

    Attributes:
        prim: its path.
        is_shown: whether the prim, and so its payload, is part of the stage.
        is_edited: whether the edit layer says so.
    """

    prim: str
    is_shown: bool
    is_edited: bool


@dataclass(frozen=True)
class StageChoices:
    """Choices that a stage leaves open, outer prims first.

    What lies in an instance has the choices of its prototype, and is not listed.

    Attributes:
        variants: variant sets, `MOST_CHOICES` at most, with `MOST_VARIANTS` variants in all at most.
        payloads: prims with payloads, those too that are not part of the stage, `MOST_CHOICES` at most.
        is_whole: whether all of them are listed.
    """

    variants: tuple[VariantChoice, ...]
    payloads: tuple[PayloadChoice, ...]
    is_whole: bool


def list_choices(stage: Usd.Stage, edits: Sdf.Layer) -> StageChoices:
    """List the choices of a stage.

    Args:
        stage: the stage.
        edits: the layer of edits.
    """
    variants: list[VariantChoice] = []
    payloads: list[PayloadChoice] = []
    left, is_whole = MOST_VARIANTS, True
    for prim in stage.TraverseAll():
        if prim.HasAuthoredPayloads():
            if len(payloads) < MOST_CHOICES:
                payloads.append(_payload_choice(prim, edits))
            else:
                is_whole = False
        if not (prim.IsActive() and prim.IsDefined() and not prim.IsAbstract()):
            continue
        for name in prim.GetVariantSets().GetNames():
            names = prim.GetVariantSet(name).GetVariantNames() if is_whole else []
            if len(variants) == MOST_CHOICES or len(names) > left or not is_whole:
                is_whole = False
                continue
            left -= len(names)
            variants.append(_variant_choice(prim, name, names, edits))
    return StageChoices(tuple(variants), tuple(payloads), is_whole)


def _variant_choice(prim: Usd.Prim, name: str, variants: Sequence[str], edits: Sdf.Layer) -> VariantChoice:
    spec = edits.GetPrimAtPath(prim.GetPath())
    is_edited = spec is not None and name in spec.variantSelections
    selection = prim.GetVariantSet(name).GetVariantSelection()
    return VariantChoice(str(prim.GetPath()), name, tuple(variants), selection, is_edited)


def _payload_choice(prim: Usd.Prim, edits: Sdf.Layer) -> PayloadChoice:
    spec = edits.GetPrimAtPath(prim.GetPath())
    return PayloadChoice(str(prim.GetPath()), prim.IsActive(), spec is not None and spec.HasInfo("active"))


def choose_variant(stage: Usd.Stage, prim_path: str, name: str, variant: str | None) -> None:
    """Choose a variant, in the stage's edit target.

    Args:
        stage: the stage.
        prim_path: of a prim.
        name: of one of its variant sets.
        variant: one of its variants; empty for none of them; None takes the edit target's choice back.

    Raises:
        NotFoundError: there is no such prim.
        SettingsError: it has no such variant set or variant, or it lies in an instance.
    """
    prim = _editable(stage, prim_path)
    sets = prim.GetVariantSets()
    if name not in sets.GetNames():
        raise SettingsError(
            f"{prim_path} has no variant set {name!r}: {hint(name, sets.GetNames())}",
            code="no_variant_set",
            path=prim_path,
        )
    variants = sets.GetVariantSet(name)
    if variant is None:
        variants.ClearVariantSelection()
        return
    if variant and variant not in variants.GetVariantNames():
        known = hint(variant, variants.GetVariantNames())
        raise SettingsError(
            f"variant set {name!r} of {prim_path} has no variant {variant!r}: {known}",
            code="no_variant",
            path=prim_path,
        )
    if variant:
        variants.SetVariantSelection(variant)
    else:
        variants.BlockVariantSelection()


def show_payload(stage: Usd.Stage, prim_path: str, is_shown: bool | None) -> None:
    """Make a prim with a payload part of the stage or not, by its activation in the stage's edit target.

    Load rules are no part of a layer, so that they could be neither kept with edits nor downloaded.

    Args:
        stage: the stage.
        prim_path: of a prim with a payload.
        is_shown: whether it is part of the stage; None takes the edit target's choice back.

    Raises:
        NotFoundError: there is no such prim.
        SettingsError: it has no payload, or lies in an instance.
    """
    prim = _editable(stage, prim_path)
    if not prim.HasAuthoredPayloads():
        raise SettingsError(f"{prim_path} has no payload", code="no_payload", path=prim_path)
    if is_shown is None:
        prim.ClearActive()
    else:
        prim.SetActive(is_shown)


def _editable(stage: Usd.Stage, path: str) -> Usd.Prim:
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    if not prim or prim.IsPseudoRoot():
        raise NotFoundError(f"there is no prim {path}", path=path)
    if prim.IsInstanceProxy() or prim.IsInPrototype():
        raise SettingsError(f"{path} lies in an instance: choose at the instance itself", path=path)
    return prim
