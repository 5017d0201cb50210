"""Options of how a stage is opened and read: those of usdrecord."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from render.model.scene import LitBy

Resolver = Literal["root", "inherit"]

COMPLEXITIES = ("auto", "low", "medium", "high", "veryhigh")
PURPOSES = ("default", "render", "proxy", "guide")
DRAWN_PURPOSES = ("default", "render")
"""Purposes that are drawn where nobody says which."""
LIGHTS: tuple[LitBy, ...] = get_args(LitBy)


@dataclass(frozen=True)
class StageOptions:
    """Options of how a stage is opened and read.

    Attributes:
        purposes: which of `PURPOSES` are drawn; None for the included purposes of the settings prim where ``settings_prim`` or
            ``render_pass`` names one, else `DRAWN_PURPOSES`.
        mask: only what lies at, below or above these prim paths is drawn and lights, and with what that needs it is all that is
            composed (`render.stage.population`); None for everything.
        camera: prim path of the camera that a mask keeps in any case; None keeps those that may be the default one.
        all_cameras: a mask keeps all cameras that are not in payloads, as pairs of eyes need.
        unloaded: payloads are not loaded, and a finding counts them.
        complexity: one of `COMPLEXITIES`: ``auto`` refines subdivision surfaces until their edges are within a quarter of a
            pixel; ``low`` draws their control meshes, and the others refine them in 1, 2 or 3 steps.
        cull_backfaces: leave out back faces of what is not ``doubleSided``; as in usdrecord, both sides are drawn otherwise.
        lit_by: one of `LIGHTS`: ``auto`` lights by the stage, or by a light at the camera where the stage has no lights.
        dome_visible: the camera sees the dome behind everything; it lights either way.
        draw_modes: models are drawn by their draw modes; else as they are.
        session_layer: goes into the session layer, below the edits.
        resolver: ``root`` finds assets from the root layer's folder, ``inherit`` from the environment alone.
        settings_prim: path of a RenderSettings prim, in place of the one that the stage names.
        render_pass: path of a RenderPass prim, whose source is the settings prim and whose collections choose what is drawn.
    """

    purposes: tuple[str, ...] | None = None
    mask: tuple[str, ...] | None = None
    camera: str | None = None
    all_cameras: bool = False
    unloaded: bool = False
    complexity: str = "auto"
    cull_backfaces: bool = False
    lit_by: LitBy = "auto"
    dome_visible: bool = True
    draw_modes: bool = True
    session_layer: Path | None = None
    resolver: Resolver = "root"
    settings_prim: str | None = None
    render_pass: str | None = None


DEFAULT_OPTIONS = StageOptions()
