"""The lens bench's measurements: a row of the table, and the sweeps. Lee, Eisemann & Seidel 2010, section 5."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from render.lab.bench.clock import Repeats, Spent
from render.lab.bench.lenses import BenchLens
from render.lab.bench.results import ApertureRow, LayersRow, RaysRow, SceneRow, SurfacesRow, against, times
from render.lab.bench.rig import LensRig
from render.lab.reference.metrics import psnr_db, ssim
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.lens import THIN_LENS
from render.model.scene import Scene
from render.optics.thin_lens import coc_radius_px, focus_w, pupil_radius_m
from render.optics.view import PinholeView

SceneMaker = Callable[[], tuple[Scene, Camera]]


@dataclass(frozen=True, eq=False)
class Subject:
    """Loaded scene with its settings and its reference picture.

    Attributes:
        rig: that draws it, one scene at a time.
        name: of the scene.
        scene: loaded, or to be loaded again.
        camera: of the scene.
        settings: of the table's row.
        repeats: of the table's pictures.
        sweep_repeats: of those of the sweeps.
        reference: the accumulation buffer's picture.
        reference_spent: cost of the reference.
    """

    rig: LensRig
    name: str
    scene: Scene
    camera: Camera
    settings: FrameSettings
    repeats: Repeats
    sweep_repeats: Repeats
    reference: FloatArray
    reference_spent: Spent


def subject(
    rig: LensRig, name: str, make: SceneMaker, settings: FrameSettings, repeats: Repeats, sweep_repeats: Repeats
) -> Subject:
    """Make a scene, load it and draw its reference."""
    scene, camera = make()
    rig.load(scene, camera)
    return Subject(rig, name, scene, camera, settings, repeats, sweep_repeats, *rig.accumulate(camera, settings))


def scene_row(of: Subject, runs: int) -> SceneRow:
    """The table's row of the scene, which is loaded.

    Args:
        of: scene and its reference, which is that of the first run.
        runs: each measures the reference and the picture, one after the other.
    """
    made = []
    for run in range(runs):
        spent = of.rig.accumulate(of.camera, of.settings)[1] if run else of.reference_spent
        traced = of.rig.trace(of.camera, of.settings, of.repeats)
        made.append(against(traced, spent))
    made.sort(key=lambda times: times[0].ratio)
    wall, cpu = made[(runs - 1) // 2]
    return SceneRow(
        **vars(wall),
        name=of.name,
        triangles=of.scene.triangle_count,
        psnr_db=psnr_db(traced.color, of.reference),
        ssim=ssim(traced.color, of.reference),
        layers=traced.layers,
        layers_mb=traced.layers_bytes / 1e6,
        spared=of.rig.measure_spared(of.camera, of.settings),
        cpu=cpu,
        ratios=[times[0].ratio for times in made],
        cpu_ratios=sorted(times[1].ratio for times in made),
    )


def rays_sweep(of: Subject, counts: Sequence[int]) -> Iterator[RaysRow]:
    """Rows of the sweep over the number of rays."""
    for rays in counts:
        traced = of.rig.trace(of.camera, replace(of.settings, rays=rays), of.sweep_repeats)
        views = rays / of.settings.rays
        spent = Spent(of.reference_spent.wall_ms * views, of.reference_spent.cpu_ms * views)
        wall, cpu = against(traced, spent)
        yield RaysRow(**vars(wall), rays=rays, cpu=cpu)


def layers_sweep(of: Subject, counts: Sequence[int]) -> Iterator[LayersRow]:
    """Rows of the sweep over the number of layers."""
    for layers in counts:
        traced = of.rig.trace(of.camera, replace(of.settings, layers=layers), of.sweep_repeats)
        wall, cpu = times(traced)
        likeness = psnr_db(traced.color, of.reference), ssim(traced.color, of.reference)
        yield LayersRow(
            **vars(wall), layers=layers, peeled=traced.layers, psnr_db=likeness[0], ssim=likeness[1], cpu=cpu
        )


def aperture_sweep(of: Subject, f_stops: Sequence[float]) -> Iterator[ApertureRow]:
    """Rows for apertures."""
    view = PinholeView.from_camera(of.camera, of.settings.width, of.settings.height)
    ends = np.array([0.0, of.rig.nearest_w(of.camera, of.settings)])
    for f_stop in f_stops:
        camera = replace(of.camera, f_stop=f_stop)
        traced = of.rig.trace(camera, of.settings, of.sweep_repeats)
        wall, cpu = against(traced, of.reference_spent)
        blur_px = float(np.abs(coc_radius_px(view.fx, pupil_radius_m(camera), ends, focus_w(camera))).max())
        yield ApertureRow(**vars(wall), f_stop=f_stop, blur_px=blur_px, layers=traced.layers, cpu=cpu)


def surfaces_sweep(of: Subject, lenses: Sequence[BenchLens]) -> Iterator[SurfacesRow]:
    """Rows for lenses, each beside the ideal lens at its f-number, measured again so that both see the same machine load."""
    for lens in lenses:
        thin = traced = of.rig.trace(
            replace(of.camera, lens=THIN_LENS, f_stop=lens.f_stop), of.settings, of.sweep_repeats
        )
        if lens.surfaces:
            traced = of.rig.trace(replace(of.camera, lens=lens.lens, f_stop=lens.f_stop), of.settings, of.sweep_repeats)
        (wall, cpu), (thin_wall, thin_cpu) = times(traced), times(thin)
        yield SurfacesRow(
            **vars(wall),
            lens=lens.name,
            surfaces=lens.surfaces,
            disperses=lens.disperses,
            f_stop=lens.f_stop,
            table_ms=traced.table.wall_ms,
            thin_trace_ms=thin_wall.trace_ms,
            trace_over_thin=wall.trace_ms / thin_wall.trace_ms,
            cpu=cpu,
            cpu_trace_over_thin=cpu.trace_ms / thin_cpu.trace_ms,
        )
