"""Script that draws pictures with whatever checkout PYTHONPATH names, for the quality bench.

    PYTHONPATH=CHECKOUT python -P draw_pictures.py

Each line of standard input is a request in JSON, each line of standard output its answer. ``{"load": FILE}`` loads a pickled
pair of scene and camera, ``{"draw": SETTINGS, "file": FILE, "repeats": N}`` draws the loaded scene and saves the picture as
``.npy``. Settings that the checkout does not know are left out. The script imports nothing of the bench, and of `render` only
what old checkouts have too.
"""

from __future__ import annotations

import json
import pickle
import sys
import time
from dataclasses import fields
from statistics import median
from typing import Any

import numpy as np

from render.frame import FrameRenderer, FrameSettings
from render.model.camera import Camera
from render.model.scene import Scene


def main() -> None:
    """Answer requests until standard input ends."""
    known = {one.name for one in fields(FrameSettings)}
    with FrameRenderer() as renderer:
        loaded: tuple[Scene, Camera] | None = None
        _answer({"device": renderer.graphics.renderer})
        for line in sys.stdin:
            request = json.loads(line)
            if "load" in request:
                with open(request["load"], "rb") as file:
                    loaded = pickle.load(file)
                _answer({})
            elif loaded is not None:
                settings = FrameSettings(**{name: value for name, value in request["draw"].items() if name in known})
                _answer(_draw(renderer, loaded, settings, request["file"], request["repeats"]))


def _draw(
    renderer: FrameRenderer, loaded: tuple[Scene, Camera], settings: FrameSettings, file: str, repeats: int
) -> dict[str, Any]:
    """Draw, save the picture, and return medians of wall time and processor time, and of the wall time with kept layers."""
    whole, kept = [], []
    for _ in range(repeats):
        renderer.forget_layers()
        wall_s, cpu_s = time.perf_counter(), time.process_time()
        color = renderer.render(*loaded, settings).color
        whole.append((time.perf_counter() - wall_s, time.process_time() - cpu_s))
        wall_s = time.perf_counter()
        renderer.render(*loaded, settings)
        kept.append(time.perf_counter() - wall_s)
    np.save(file, color)
    return {
        "seconds": median(wall for wall, _ in whole),
        "cpu_s": median(cpu for _, cpu in whole),
        "kept_s": median(kept),
    }


def _answer(found: dict[str, Any]) -> None:
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main()
