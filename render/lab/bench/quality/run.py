"""The quality bench: noise and bias of the lens engine, and its seconds, of this checkout and of another one.

pullfocus bench quality --references FOLDER --before CHECKOUT
"""

from __future__ import annotations

import argparse
import io
import math
import pickle
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from render.errors import SettingsError
from render.files import write_atomic
from render.frame import FrameRenderer
from render.lab.bench.progress import check_file, say
from render.lab.bench.quality.checkout import HERE, Checkout
from render.lab.bench.quality.plan import GOAL_RAYS, QualityPlan, plan_from_arguments
from render.lab.bench.quality.results import (
    NOTHING,
    Likeness,
    QualityBench,
    QualityRow,
    ReferenceRow,
    judge,
    report,
)
from render.lab.bench.quality.subjects import Subject, make_subject
from render.lab.reference.converged import Converged, accumulate_converged, trace_converged
from render.lab.reference.flip import flip
from render.lab.reference.metrics import encode_for_display, psnr_db, ssim, worst_share
from render.model.arrays import FloatArray

_EVEN: dict[str, Any] = {"seed": 1, "adaptive": False}
"""Settings of the picture that noise is measured against: other points, and as many rays for each pixel."""


def measure(plan: QualityPlan) -> QualityBench:
    """Measure everything.

    Args:
        plan: what to measure.

    Raises:
        GraphicsError: there is no device to draw on, or a checkout cannot draw.
        OutputError: a reference or a picture cannot be written.
    """
    rows: list[QualityRow] = []
    references: list[ReferenceRow] = []
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        kept = folder if plan.references is None else plan.references
        paths = {"after": HERE} if plan.before is None else {"before": plan.before, "after": HERE}
        checkouts = {}
        for which, path in paths.items():
            (folder / which).mkdir()
            checkouts[which] = stack.enter_context(Checkout(path, folder / which))
        for name in plan.subjects:
            subject = make_subject(name, plan.width, folder / "demo")
            converged = _converge(subject, plan, kept)
            if converged is not None:
                references.append(ReferenceRow(name, converged.count, _finite(converged.halves_psnr_db)))
            rows += _rows(subject, None if converged is None else converged.picture, checkouts, plan, kept, folder)
        device = checkouts["after"].device
    return QualityBench(device, plan.noise_rays, rows, references, judge(rows))


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.quality.plan.add_arguments` declares them.

    Raises:
        SettingsError: a setting is out of range.
        GraphicsError: there is no device to draw on, or a checkout cannot draw.
        OutputError: a file cannot be written.
    """
    plan = plan_from_arguments(arguments)
    check_file(arguments.json)
    for folder in (plan.references, plan.pictures):
        if folder is not None and not folder.is_dir():
            raise SettingsError(f"the folder {folder} does not exist")
    result = measure(plan)
    say(result, report(result), arguments.json)


def _converge(subject: Subject, plan: QualityPlan, folder: Path) -> Converged | None:
    size = f"{subject.settings.width}x{subject.settings.height}"
    file = folder / f"{subject.name}_{size}_{subject.settings.shading}.npz"
    if subject.reference == "views":
        with FrameRenderer() as renderer:
            settings = replace(subject.settings, rays=plan.views)
            return accumulate_converged(renderer, subject.scene, subject.camera, settings, file, say=_note)
    if subject.reference == "rays":
        settings = replace(subject.settings, rays=plan.glass_rays)
        return trace_converged(subject.scene, subject.camera, settings, file, say=_note)
    return None


def _rows(
    subject: Subject,
    converged: FloatArray | None,
    checkouts: dict[str, Checkout],
    plan: QualityPlan,
    kept: Path,
    folder: Path,
) -> list[QualityRow]:
    loaded = folder / "subject.pickle"
    loaded.write_bytes(pickle.dumps((subject.scene, subject.camera)))
    size = {"width": subject.settings.width, "height": subject.settings.height, "shading": subject.settings.shading}
    many = {}
    for which, checkout in checkouts.items():
        checkout.load(loaded)
        checkout.draw({**size, "rays": 1})  # compiles shaders, and sends the scene
        file = kept / f"{subject.name}_{size['width']}x{size['height']}_{plan.noise_rays}_{checkout.digest}.npy"
        many[which] = _noise_reference(checkout, {**size, "rays": plan.noise_rays, **_EVEN}, file)
    rows = []
    for rays in plan.rays:
        for which, checkout in checkouts.items():
            drawn = checkout.draw({**size, "rays": rays}, plan.repeats)
            row = QualityRow(
                subject.name,
                which,
                subject.settings.width,
                subject.settings.height,
                rays,
                _likeness(drawn.color, many[which]),
                NOTHING if converged is None else _likeness(drawn.color, converged),
                drawn.seconds,
                drawn.cpu_s,
                drawn.kept_s,
            )
            rows.append(row)
            _note(f"{subject.name}, {rays} rays, {which}: {row.noise.psnr_db} and {row.bias.psnr_db} dB")
            if plan.pictures is not None and rays == GOAL_RAYS:
                _write_png(plan.pictures / f"{subject.name}_{which}.png", drawn.color)
    if plan.pictures is not None and converged is not None:
        _write_png(plan.pictures / f"{subject.name}_converged.png", converged)
    return rows


def _noise_reference(checkout: Checkout, settings: dict[str, Any], file: Path) -> FloatArray:
    """Picture of many rays; drawn where the file does not hold it yet."""
    if not file.is_file():
        packed = io.BytesIO()
        np.save(packed, checkout.draw(settings).color)
        write_atomic(file, packed.getvalue())
    many: FloatArray = np.load(file)
    return many


def _likeness(picture: FloatArray, reference: FloatArray) -> Likeness:
    return Likeness(
        _finite(psnr_db(picture, reference)),
        ssim(picture, reference),
        flip(picture, reference),
        _finite(worst_share(picture, reference)),
    )


def _write_png(file: Path, picture: FloatArray) -> None:
    packed = io.BytesIO()
    Image.fromarray(np.round(255 * encode_for_display(picture)).astype(np.uint8)).save(packed, "PNG")
    write_atomic(file, packed.getvalue())


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _note(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
