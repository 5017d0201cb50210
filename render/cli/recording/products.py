"""Record the products of a stage's render settings: each picture and file that it asks for, in one run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from render.cli.console import FrameProgress
from render.cli.options.stereo import view_pattern
from render.cli.recording.frames import record_frame
from render.cli.recording.job import RecordJob
from render.cli.recording.stereo import record_stereo_frame
from render.errors import SettingsError
from render.model.frame_spec import frame_file_names
from render.output.formats import format_of
from render.output.layout import FileLayout, FilePart
from render.stage import EYES, StereoPair
from render.stage.render_products import Product


@dataclass(frozen=True)
class ProductRun:
    """A product and what it takes to record it.

    Attributes:
        product: the product.
        job: the shot, its camera and the settings of each picture.
        files: of each frame: one, or two for the left eye and the right.
        pair: cameras of both eyes; None for the job's camera alone.
    """

    product: Product
    job: RecordJob
    files: Sequence[tuple[Path, ...]]
    pair: StereoPair | None = None


def product_files(
    product: Product, folder: Path, frames: Sequence[float], *, is_stereo: bool = False
) -> list[tuple[Path, ...]]:
    """Files of a product's frames: of each one, or two for the left eye and the right.

    Args:
        product: the product.
        folder: that all files lie in.
        frames: USD time codes.
        is_stereo: record both eyes.

    Raises:
        SettingsError: its name leaves the folder, or has no place for the numbers of frames.
    """
    name = PurePosixPath(product.file.replace("\\", "/"))
    if not name.parts or name.is_absolute() or ".." in name.parts or ":" in name.parts[0]:
        raise SettingsError(
            f"productName of {product.path} must be a file below {folder}, got {product.file!r}: files go into OUT alone"
        )
    format_of(name.name)
    if "#" in name.name and any(map(math.isnan, frames)):
        raise SettingsError(
            f"--defaultTime has no frame number for the # of productName {product.file!r} of {product.path}"
        )
    patterns = dict.fromkeys(view_pattern(str(name), eye) for eye in EYES) if is_stereo else [str(name)]
    files = (frame_file_names(str(folder / pattern), frames) for pattern in patterns)
    return [tuple(map(Path, each)) for each in zip(*files, strict=True)]


def record_products(runs: Sequence[ProductRun], frames: Sequence[float]) -> list[dict[str, Any]]:
    """Render and write each frame of each product.

    Args:
        runs: products of one shot.
        frames: USD time codes.

    Returns:
        Entries for ``--json``, one for each file.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    written: list[dict[str, Any]] = []
    with FrameRenderer() as renderer, FrameProgress(len(runs) * len(frames)) as progress:
        for number, time in enumerate(frames):
            for run in runs:
                job, files, layout = run.job, run.files[number], file_layout(run.product)
                with job.shot.framed(run.product.framing):
                    if run.pair is None:
                        entries = [record_frame(renderer, progress, job, time, files[0], layout)]
                    else:
                        by_eye = dict(zip(EYES, (files[0], files[-1]), strict=True))
                        entries = record_stereo_frame(renderer, progress, job, run.pair, time, by_eye, layout)
                cameras = {"camera": job.camera_path} if run.pair is None else {"cameras": asdict(run.pair)}
                written += [{**entry, "product": run.product.path, **cameras} for entry in entries]
    return written


def file_layout(product: Product) -> FileLayout:
    """Layout of a product's files."""
    parts = tuple(FilePart(var.name, var.aov, var.kind, var.channels) for var in product.vars)
    return FileLayout(parts, product.framing, product.is_deep)
