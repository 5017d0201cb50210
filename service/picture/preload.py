"""Modules that the template of the workers imports, so that no worker has to (see `service.workers.template`).

USD and OpenBLAS would start threads, which a fork does not copy. USD gets its threads back in each worker.
"""

from __future__ import annotations

import os

from pxr import Work

Work.SetConcurrencyLimit(1)
os.register_at_fork(after_in_child=Work.SetMaximumConcurrencyLimit)

from service.picture import frames, live, long_exposure, metering  # noqa: E402, F401
from service.stage import (  # noqa: E402, F401
    cameras,
    curves,
    edits,
    exposure,
    focus_points,
    lenses,
    libraries,
    photography,
    shots,
    solving,
)
