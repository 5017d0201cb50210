"""Draws the pictures of the page of all kinds (docs/guide/kinds.md): one of geometry, one of materials, one of lights.

usage: python -m tests.bench.kinds_pictures OUT_DIR [OPTIONS of pullfocus record]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from render.cli.main import main as pullfocus
from tests.render.kits.kinds import GEOMETRY, LIGHTS, MATERIALS, kinds_stage

PICTURES = {"geometry": (GEOMETRY, False), "materials": (MATERIALS, False), "lights": (LIGHTS, True)}
"""Kinds of each picture, and whether each kind stands in a booth."""


def main(arguments: list[str]) -> int:
    """Write the pictures to a folder; return the exit status of the first that fails."""
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    out, *options = arguments
    for name, (kinds, booths) in PICTURES.items():
        with tempfile.TemporaryDirectory() as folder:
            stage = Path(folder) / f"{name}.usda"
            kinds_stage(stage, kinds, booths=booths)
            target = Path(out) / f"kinds_{name}.jpg"
            status = pullfocus(["record", str(stage), str(target), "--camera", "/camera", "-w", "1280", *options])
        if status:
            return status
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
