"""The machine that a bench of the service runs on."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from datetime import UTC, datetime
from importlib import metadata

from render.gl.context import GraphicsContext
from service.bench.results import Machine


def this_machine(packages: Iterable[str]) -> Machine:
    """Describe this machine as it is now.

    Args:
        packages: names of the packages whose versions are told.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    with GraphicsContext() as graphics:
        device = graphics.renderer
    return Machine(
        datetime.now(UTC).isoformat(timespec="seconds"),
        len(os.sched_getaffinity(0)),
        device,
        os.getloadavg()[0],
        platform.python_version(),
        {name: metadata.version(name) for name in packages},
    )
