"""Draws the pictures of the page of all kinds (docs/guide/kinds.md): a sheet of geometry, one of materials, one of lights.

usage: python -m tests.bench.kinds_pictures OUT_DIR [OPTIONS of pullfocus record]
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from render.cli.main import main as pullfocus
from tests.render.kits.kinds import GEOMETRY, LIGHTS, MATERIALS, Author, kind_stage

SHEETS = {"geometry": GEOMETRY, "materials": MATERIALS, "lights": LIGHTS}
COLUMNS, WIDTH_PX, HEIGHT_PX, GAP_PX = 5, 256, 192, 6


def draw(author: Author, *, booth: bool, options: list[str]) -> np.ndarray:
    """``(HEIGHT_PX, WIDTH_PX, 3)`` 8-bit picture of one kind."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        kind_stage(folder / "kind.usda", author, booth=booth)
        target = folder / "kind.png"
        arguments = [str(folder / "kind.usda"), str(target), "--camera", "/camera", "-w", str(WIDTH_PX), *options]
        if pullfocus(["record", *arguments]):
            raise SystemExit("a kind could not be drawn")
        return oiio.ImageBuf(str(target)).get_pixels(oiio.UINT8)[..., :3]


def main(arguments: list[str]) -> int:
    """Write the sheets to a folder; return the exit status."""
    if not arguments:
        print(__doc__, file=sys.stderr)
        return 2
    out, *options = arguments
    for name, kinds in SHEETS.items():
        rows = -(-len(kinds) // COLUMNS)
        size = rows * (HEIGHT_PX + GAP_PX) - GAP_PX, COLUMNS * (WIDTH_PX + GAP_PX) - GAP_PX
        sheet = np.full((*size, 3), 255, np.uint8)
        for number, author in enumerate(kinds.values()):
            top, left = number // COLUMNS * (HEIGHT_PX + GAP_PX), number % COLUMNS * (WIDTH_PX + GAP_PX)
            picture = draw(author, booth=kinds is LIGHTS, options=options)
            sheet[top : top + HEIGHT_PX, left : left + WIDTH_PX] = picture
        oiio.ImageBuf(sheet).write(str(Path(out) / f"kinds_{name}.jpg"))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
