"""Scripts on the modules of another checkout of Pullfocus, in processes of their own."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_RUN = (
    "import runpy, sys; "
    "sys.meta_path[:] = [one for one in sys.meta_path if not one.__module__.startswith('__editable__')]; "
    "del sys.argv[0]; "
    "runpy.run_path(sys.argv[0], run_name='__main__')"
)


def script_command(script: Path) -> list[str]:
    """Command that runs a script; its arguments follow.

    An editable installation is left out, since it would stand in for modules that the checkout lacks.
    """
    return [sys.executable, "-P", "-c", _RUN, str(script)]


def script_environment(checkout: Path) -> dict[str, str]:
    """Environment in which a script imports the modules of a checkout."""
    return {**os.environ, "PYTHONPATH": str(checkout.resolve())}
