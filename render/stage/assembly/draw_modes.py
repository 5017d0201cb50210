"""Draw modes of models: which models a stand-in replaces, by the rules of UsdGeomModelAPI."""

from __future__ import annotations

from pxr import Kind, Usd, UsdGeom

from render.stage.findings import FindingLog
from render.stage.geometry.stand_ins import MODES
from render.stage.values import UNREADABLE

_AS_IT_IS = ("default", "inherited")


def draw_mode(prim: Usd.Prim, above: str, log: FindingLog) -> str:
    """Draw mode that holds for a model and below it.

    Args:
        prim: the model.
        above: mode that holds above it; empty where that is not known.
        log: notes a mode that USD does not have.
    """
    if above and not prim.GetAttribute("model:drawMode"):
        return above
    try:
        found = str(UsdGeom.ModelAPI(prim).ComputeModelDrawMode(above))
    except UNREADABLE:
        found = "of another type"
    if found in MODES or found in _AS_IT_IS:
        return found
    path = prim.GetPath()
    log.add(
        "draw_mode",
        path,
        f"draw mode of {path} must be {', '.join((*MODES, *_AS_IT_IS))}, got {found}: it is not honoured",
    )
    return "default"


def is_replaced(prim: Usd.Prim) -> bool:
    """Whether a model with a draw mode is replaced: as it says itself, or else as a component."""
    applies = UsdGeom.ModelAPI(prim).GetModelApplyDrawModeAttr()
    if applies and applies.HasAuthoredValue():
        return bool(applies.Get() is True)
    return bool(Kind.Registry.IsA(Usd.ModelAPI(prim).GetKind(), Kind.Tokens.component))


def mode_of(prim: Usd.Prim) -> str:
    """Draw mode by which a prim is drawn; empty where it is drawn as it is."""
    if not prim.IsModel() or not is_replaced(prim):
        return ""
    mode = draw_mode(prim, "", FindingLog())
    return mode if mode in MODES else ""


def note_no_model(prim: Usd.Prim, log: FindingLog) -> None:
    """Note a draw mode of a prim that is no model, which has no effect in USD."""
    attribute = prim.GetAttribute("model:drawMode")
    mode = attribute.Get() if attribute and not prim.IsModel() else None
    if mode is not None and mode not in _AS_IT_IS:
        path = prim.GetPath()
        log.add(
            "draw_mode",
            path,
            f"draw mode {mode} of {path} has no effect: the prim is no model, by its kind or one above it",
        )
