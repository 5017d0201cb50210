"""Results of the lens bench as plain data: the fields are the keys of the bench's JSON."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from typing import Any

from render.lab.bench.clock import Spent
from render.lab.bench.rig import Traced


@dataclass(frozen=True)
class Times:
    """Milliseconds of a picture by either clock: peeling + N-buffers + tracing = total.

    Attributes:
        peel_ms: layers, with the search for their extent and number.
        nbuffer_ms: the N-buffers.
        trace_ms: the tracing, with highlights, the lens table and reading the picture.
        total_ms: all of it.
    """

    peel_ms: float
    nbuffer_ms: float
    trace_ms: float
    total_ms: float


@dataclass(frozen=True)
class ReferenceTimes(Times):
    """Beside those of the picture itself.

    Attributes:
        reference_ms: the accumulation buffer with as many views as rays.
        ratio: speed of the lens engine over the reference.
    """

    reference_ms: float
    ratio: float


@dataclass(frozen=True)
class SceneRow(ReferenceTimes):
    """A row of the paper's table 1, in wall time, of the run with the median ratio.

    Attributes:
        name: of the scene.
        triangles: in it.
        psnr_db: against the accumulation buffer with the same lens samples.
        ssim: the same comparison.
        layers: number of peeled layers.
        layers_mb: megabytes (10⁶) of layers and N-buffers, supersampling and guard band included.
        spared: share of the texels behind the first layer that are left out because no ray reaches them.
        cpu: the same times by the processor's clock, of all threads.
        ratios: ratio of each run, from the least to the greatest.
        cpu_ratios: the same by the processor's clock.
    """

    name: str
    triangles: int
    psnr_db: float
    ssim: float
    layers: int
    layers_mb: float
    spared: float
    cpu: ReferenceTimes
    ratios: list[float]
    cpu_ratios: list[float]


@dataclass(frozen=True)
class RaysRow(ReferenceTimes):
    """One count of rays. The reference's time is that of the table's row, whose views cost the same each, for so many views."""

    rays: int
    cpu: ReferenceTimes


@dataclass(frozen=True)
class LayersRow(Times):
    """One count of layers.

    Attributes:
        layers: requested number of layers.
        peeled: layers that there were.
        psnr_db: against the accumulation buffer.
        ssim: the same comparison.
        cpu: by the processor's clock.
    """

    layers: int
    peeled: int
    psnr_db: float
    ssim: float
    cpu: Times


@dataclass(frozen=True)
class ApertureRow(ReferenceTimes):
    """One f-number. The reference's time, which it does not change, is that of the table's row.

    Attributes:
        f_stop: the f-number.
        blur_px: largest circle of confusion in the picture, radius.
        layers: number of peeled layers.
        cpu: by the processor's clock.
    """

    f_stop: float
    blur_px: float
    layers: int
    cpu: ReferenceTimes


@dataclass(frozen=True)
class SurfacesRow(Times):
    """One lens.

    Attributes:
        lens: its name.
        surfaces: of it, the stop included; 0 for the ideal lens.
        disperses: whether each colour has its own rays.
        f_stop: its f-number.
        table_ms: the making of its table, once for each focus and f-number.
        thin_trace_ms: the ideal lens's tracing at the same f-number, measured beside it.
        trace_over_thin: this lens's tracing over that.
        cpu: by the processor's clock.
        cpu_trace_over_thin: the same in processor time.
    """

    lens: str
    surfaces: int
    disperses: bool
    f_stop: float
    table_ms: float
    thin_trace_ms: float
    trace_over_thin: float
    cpu: Times
    cpu_trace_over_thin: float


@dataclass(frozen=True)
class Goal:
    """Goal and whether it is met.

    Attributes:
        goal: the goal in words.
        want: bound.
        got: measured value.
        holds: whether the value is within the bound.
    """

    goal: str
    want: float
    got: float
    holds: bool


@dataclass(frozen=True)
class Sweeps:
    """Sweeps of one setting each, in the named scene.

    Attributes:
        scene: name of the scene.
        rays: rows by number of rays.
        layers: rows by number of layers.
        aperture: rows by f-number.
        surfaces: rows by lens.
    """

    scene: str
    rays: list[RaysRow]
    layers: list[LayersRow]
    aperture: list[ApertureRow]
    surfaces: list[SurfacesRow]


@dataclass(frozen=True)
class LensBench:
    """All of it.

    Attributes:
        device: the driver's name of what drew.
        software: whether that is a rasteriser on the CPU.
        width: of the pictures, pixels.
        height: picture height in pixels.
        rays: per pixel.
        supersample: layer pixels per picture pixel along each axis.
        scenes: the table.
        sweeps: along one setting each.
        layers_mb_1024x768: megabytes of four layers of that size, and of their N-buffers.
        goals: none where the settings are not those that the goals are set for.
    """

    device: str
    software: bool
    width: int
    height: int
    rays: int
    supersample: float
    scenes: list[SceneRow]
    sweeps: Sweeps
    layers_mb_1024x768: float
    goals: list[Goal] = field(default_factory=list)


def as_json(bench: LensBench) -> str:
    """JSON of the results; null stands for infinity, such as the PSNR of equal pictures, and for NaN."""
    return json.dumps(_finite(asdict(bench)), indent=2, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def times(traced: Traced) -> tuple[Times, Times]:
    """Cost of a picture, in wall time and in processor time."""
    peel, nbuffers = traced.stages["peel"], traced.stages["nbuffers"]
    trace = traced.stages["rays"] + traced.stages["highlights"] + traced.stages["trace"]
    total = peel + nbuffers + trace
    return (
        Times(peel.wall_ms, nbuffers.wall_ms, trace.wall_ms, total.wall_ms),
        Times(peel.cpu_ms, nbuffers.cpu_ms, trace.cpu_ms, total.cpu_ms),
    )


def against(traced: Traced, reference: Spent) -> tuple[ReferenceTimes, ReferenceTimes]:
    """Times relative to the reference's cost."""
    wall, cpu = times(traced)
    return (
        ReferenceTimes(**vars(wall), reference_ms=reference.wall_ms, ratio=reference.wall_ms / wall.total_ms),
        ReferenceTimes(**vars(cpu), reference_ms=reference.cpu_ms, ratio=reference.cpu_ms / cpu.total_ms),
    )
