"""Seconds for a frame of the demo shot, and how near the lens engine comes to the accumulation buffer.

    make bench                        the whole table
    scripts/bench --json table.json   and for programs

Not collected by pytest: a bench measures, it does not pass. The first frame compiles shaders and uploads the scene; `frame`
is the quicker of the two frames after it.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, TypeVar

from render.demo.shot import write_demo
from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db, ssim
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.shot import Shot

FRAME = 48.0
REPEATS = 2
LENS = FrameSettings(960, 540, rays=100, layers=4, supersample=2, tiled=False)
CASES = {
    "lens": LENS,
    "lens, 1 layer": replace(LENS, layers=1),
    "lens, 36 rays": replace(LENS, rays=36),
    "lens, no supersampling": replace(LENS, supersample=1),
    "pinhole": replace(LENS, engine="pinhole"),
}

T = TypeVar("T")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="scripts/bench", description="Measure the engines on the demo shot.")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the table there too")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, FrameRenderer() as renderer:
        table = measure(Path(folder), renderer)
    print_table(table)
    if asked.json:
        asked.json.write_text(json.dumps(table, indent=2) + "\n")


def measure(folder: Path, renderer: FrameRenderer) -> dict[str, Any]:
    """The whole table: the machine, the shot, and a row for each case."""
    author_s, path = timed(lambda: write_demo(folder))
    open_s, shot = timed(lambda: Shot.open(path))
    read_s, scene = timed(lambda: shot.scene_at(FRAME))
    camera = shot.camera_at(None, FRAME, LENS.width, LENS.height)
    reference_s, reference = timed(lambda: renderer.render(scene, camera, replace(LENS, engine="accumulation")).color)
    return {
        "device": renderer.graphics.renderer,
        "cores": os.cpu_count(),
        "triangles": scene.triangle_count,
        "authorS": author_s,
        "openS": open_s,
        "readS": read_s,
        "accumulationS": reference_s,
        "cases": [row(name, settings, renderer, scene, camera, reference) for name, settings in CASES.items()],
    }


def row(
    name: str,
    settings: FrameSettings,
    renderer: FrameRenderer,
    scene: Scene,
    camera: Camera,
    reference: FloatArray,
) -> dict[str, Any]:
    """Seconds for a frame, and its likeness to the accumulation buffer of 100 rays."""

    def draw() -> Frame:
        renderer.forget_layers()
        return renderer.render(scene, camera, settings)

    first_s, frame = timed(draw)
    frame_s = min(timed(draw)[0] for _ in range(REPEATS))
    result = {"name": name, "settings": asdict(settings), "firstS": first_s, "frameS": frame_s}
    if settings.engine == "lens":
        result |= {"psnrDb": psnr_db(frame.color, reference), "ssim": ssim(frame.color, reference)}
    return result


def timed(work: Callable[[], T]) -> tuple[float, T]:
    """Seconds that the work took, and what it gave."""
    began = time.perf_counter()
    result = work()
    return time.perf_counter() - began, result


def print_table(table: dict[str, Any]) -> None:
    """The table for people."""
    print(
        f"{table['device']}, {table['cores']} cores; demo shot of {table['triangles']:,} triangles, {LENS.width} x {LENS.height}"
    )
    print(f"author {table['authorS']:.2f} s, open {table['openS']:.2f} s, read {table['readS']:.2f} s")
    print(f"accumulation buffer of {LENS.rays} rays: {table['accumulationS']:.1f} s")
    print(f"{'':24}{'first s':>9}{'frame s':>9}{'PSNR dB':>9}{'SSIM':>8}")
    for case in table["cases"]:
        likeness = f"{case['psnrDb']:9.1f}{case['ssim']:8.4f}" if "psnrDb" in case else ""
        print(f"{case['name']:24}{case['firstS']:9.2f}{case['frameS']:9.2f}{likeness}")


if __name__ == "__main__":
    main()
