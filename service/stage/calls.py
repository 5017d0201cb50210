"""Modules of the stage process as the HTTP process sees them: functions to call by name, without importing USD.

A type checker follows the imports; at run time each module is a stand-in (see `service.workers.calls`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from service.workers.calls import RemoteModule

if TYPE_CHECKING:
    from service.stage import (
        cameras,
        choices,
        curves,
        edits,
        exposure,
        focus_points,
        focus_reports,
        lenses,
        libraries,
        notes,
        opened,
        photography,
        picture_states,
        render_plans,
        shots,
        solving,
        top_view,
    )
else:
    cameras = RemoteModule("service.stage.cameras")
    choices = RemoteModule("service.stage.choices")
    curves = RemoteModule("service.stage.curves")
    edits = RemoteModule("service.stage.edits")
    exposure = RemoteModule("service.stage.exposure")
    focus_points = RemoteModule("service.stage.focus_points")
    focus_reports = RemoteModule("service.stage.focus_reports")
    lenses = RemoteModule("service.stage.lenses")
    libraries = RemoteModule("service.stage.libraries")
    notes = RemoteModule("service.stage.notes")
    opened = RemoteModule("service.stage.opened")
    photography = RemoteModule("service.stage.photography")
    picture_states = RemoteModule("service.stage.picture_states")
    render_plans = RemoteModule("service.stage.render_plans")
    shots = RemoteModule("service.stage.shots")
    solving = RemoteModule("service.stage.solving")
    top_view = RemoteModule("service.stage.top_view")

__all__ = [
    "cameras",
    "choices",
    "curves",
    "edits",
    "exposure",
    "focus_points",
    "focus_reports",
    "lenses",
    "libraries",
    "notes",
    "opened",
    "photography",
    "picture_states",
    "render_plans",
    "shots",
    "solving",
    "top_view",
]
