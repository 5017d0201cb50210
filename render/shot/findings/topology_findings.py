"""Findings of focus points whose meshes have changed since the points were placed."""

from __future__ import annotations

from collections.abc import Iterator

from render.stage import Finding
from usd_schemas import LensCamera, SchemaError
from usd_schemas.topology import topology_change


def topology_findings(camera: LensCamera) -> Iterator[Finding]:
    """Find each focus point of a camera whose mesh has other faces than when the point was placed."""
    for view in camera.focus_points():
        try:
            changed = topology_change(camera.prim.GetStage(), view.read())
        except SchemaError:
            continue  # an unreadable target is reported by focusing
        if changed is not None:
            yield Finding("topology_changed", str(camera.prim.GetPath()), changed)
