"""Modules that the template of the workers imports, so that no worker has to (see `service.workers.template`).

USD and OpenBLAS would start threads, which a fork does not copy. USD gets its threads back when a worker has entered its
sandbox (`service.stage.opened.OpenedShot`): Landlock does not confine threads that were there before.
"""

from __future__ import annotations

from pxr import Work

Work.SetConcurrencyLimit(1)

from service.picture import frames, live, long_exposure, metering, render_products, warming  # noqa: E402, F401
from service.stage import (  # noqa: E402, F401
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
    photography,
    shots,
    solving,
)
