"""A checkout of Pullfocus in a process of its own that draws the quality bench's pictures."""

from __future__ import annotations

import hashlib
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from render.errors import GraphicsError
from render.lab.bench.checkouts import script_command, script_environment
from render.lab.bench.quality import draw_pictures
from render.model.arrays import FloatArray

HERE = Path(draw_pictures.__file__).parents[4]
"""The checkout that runs the bench."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A picture and its cost.

    Attributes:
        color: ``(height, width, 4)`` float32.
        seconds: wall time of the frame, scene on the device and shaders compiled; median.
        cpu_s: processor time of all threads; median.
        kept_s: wall time of the same frame with layers from before; median.
    """

    color: FloatArray
    seconds: float
    cpu_s: float
    kept_s: float


class Checkout:
    """Process that draws with a checkout's code.

    Args:
        path: root of the checkout.
        folder: for pictures on their way.

    Attributes:
        digest: `code_digest` of the checkout.
        device: name of the device.
    """

    def __init__(self, path: Path, folder: Path) -> None:
        self._path, self._file = path, folder / "drawn.npy"
        self.digest = code_digest(path)
        self._process = subprocess.Popen(
            script_command(Path(draw_pictures.__file__)),
            env=script_environment(path),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.device: str = self._read()["device"]

    def load(self, file: Path) -> None:
        """Load a pickled pair of scene and camera."""
        self._ask({"load": str(file)})

    def draw(self, settings: dict[str, Any], repeats: int = 1) -> Drawn:
        """Draw the loaded scene.

        Args:
            settings: fields of `FrameSettings`; those that the checkout does not know are left out.
            repeats: number of times, for the median of the cost.

        Raises:
            GraphicsError: the process has ended.
        """
        cost = self._ask({"draw": settings, "file": str(self._file), "repeats": repeats})
        return Drawn(np.load(self._file), **cost)

    def close(self) -> None:
        """End the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def __enter__(self) -> Checkout:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        if self._process.stdin is not None and self._process.poll() is None:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        return self._read()

    def _read(self) -> dict[str, Any]:
        line = self._process.stdout.readline() if self._process.stdout is not None else ""
        if not line:
            raise GraphicsError(f"the process that draws with {self._path} ended with status {self._process.wait()}")
        found: dict[str, Any] = json.loads(line)
        return found


def code_digest(path: Path) -> str:
    """Digest of the code of a checkout that draws: pictures of another digest may differ."""
    render = path / "render"
    files = [file for folder in render.iterdir() if folder.name not in ("lab", "cli") for file in _sources(folder)]
    total = hashlib.sha256()
    for file in sorted(files):
        total.update(file.relative_to(render).as_posix().encode() + b"\0" + file.read_bytes() + b"\0")
    return total.hexdigest()[:12]


def _sources(folder: Path) -> list[Path]:
    """Files of code in a folder, or the file itself."""
    if folder.is_file():
        return [folder]
    return [file for file in folder.rglob("*") if file.suffix in (".py", ".glsl", ".vert", ".frag", ".comp")]
