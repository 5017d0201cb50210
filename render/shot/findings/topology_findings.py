"""What became of the faces that focus points were placed on."""

from __future__ import annotations

from collections.abc import Iterator

from render.stage import Finding
from usd_schemas import LensCamera, SchemaError
from usd_schemas.topology import topology_change


def topology_findings(camera: LensCamera) -> Iterator[Finding]:
    """One finding for each focus point of a camera whose mesh has other faces than when the point was placed."""
    for view in camera.focus_points():
        try:
            changed = topology_change(camera.prim.GetStage(), view.read())
        except SchemaError:
            continue  # its target cannot be read, which focusing says
        if changed is not None:
            yield Finding("topology_changed", str(camera.prim.GetPath()), changed)
