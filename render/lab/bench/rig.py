"""The lens engine and the accumulation buffer on one context, over the same uploaded scene, with a clock on either."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import TracebackType

import numpy as np

from render.engines.shared.layer_scale import traced_scale
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.lab.bench.clock import Repeats, Spent, StageClock, median_spent
from render.layers.nbuffers import NBufferBuilder
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.layers.shadows import shadow_region
from render.layers.targets import LAYERS_PER_PACK
from render.layers.umbra import umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.optics.thin_lens import focal_surface, pupil_radius_m
from render.optics.view import PinholeView
from render.trace.accumulator import Accumulator, choose_view_sampling, make_lens_points
from render.trace.lens import STAGES, LensTracer, Stage, TracedPicture
from render.trace.rays import make_ray_pattern


@dataclass(frozen=True, eq=False)
class Traced:
    """Picture of the lens engine and its cost.

    Attributes:
        color: ``(height, width, 4)`` float32.
        stages: by `render.trace.lens.STAGES`, medians over the runs.
        table: the making of the lens's table, which later pictures share.
        layers: number of peeled layers.
        layers_bytes: memory of the layers and their N-buffers.
    """

    color: FloatArray
    stages: dict[Stage, Spent]
    table: Spent
    layers: int
    layers_bytes: int


class LensRig:
    """Draws one scene at a time with either engine."""

    def __init__(self) -> None:
        """Raises `GraphicsError` where no context can be made."""
        self.graphics = GraphicsContext()
        programs = ProgramCache(self.graphics.ctx)
        self._peeler = Peeler(self.graphics, programs)
        self._lens = LensTracer(self.graphics.ctx, programs)
        self._accumulator = Accumulator(self.graphics.ctx, programs)
        self._nbuffers = NBufferBuilder(self.graphics.ctx, programs)

    def load(self, scene: Scene, camera: Camera) -> None:
        """Upload a scene, for both engines."""
        self._peeler.load(scene, shadow_region(camera))

    def trace(self, camera: Camera, settings: FrameSettings, repeats: Repeats) -> Traced:
        """Trace the loaded scene's picture: with one ray to compile shaders and make the lens's table, then for the clock.

        Raises:
            InputError: the camera's prescription is not a lens.
            SettingsError: it does not reach the focus distance.
        """
        picture, first = self._timed(camera, replace(settings, rays=1))
        runs: list[dict[str, Spent]] = []
        while repeats.more(len(runs), sum(spent.wall_ms for run in runs for spent in run.values())):
            picture, spent = self._timed(camera, settings)
            runs.append(spent)
        stages = {stage: median_spent([run[stage] for run in runs]) for stage in STAGES}
        layers, nbuffers = picture.layers, picture.nbuffers
        return Traced(picture.color, stages, first["rays"], layers.count, layers.targets.bytes + nbuffers.bytes)

    def accumulate(self, camera: Camera, settings: FrameSettings) -> tuple[FloatArray, Spent]:
        """Picture of the loaded scene from the accumulation buffer with the same lens samples, and its cost."""
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        points = make_lens_points(camera, settings.rays, settings.seed)
        sampling = choose_view_sampling(camera, view, settings.rays, traced_scale(settings))
        plane = focal_surface(camera).plane
        self._accumulator.accumulate(self._peeler, view, points[:1], plane, sampling=sampling)  # compiles
        clock = StageClock(self.graphics.ctx.finish)
        picture = self._accumulator.accumulate(self._peeler, view, points, plane, sampling=sampling)
        clock("reference")
        return picture, clock.spent["reference"]

    def measure_spared(self, camera: Camera, settings: FrameSettings) -> float:
        """Share of the texels behind the first layer that are left out because no ray reaches them (`render.layers.reach`)."""
        reached = self._timed(camera, replace(settings, rays=1))[0].layers
        texels = _count_behind(reached)
        whole = self._peeler.peel(reached.view, layers=settings.layers, umbra=reached.umbra, unlit=True)
        return 1.0 - texels / max(1, _count_behind(whole))

    def nearest_w(self, camera: Camera, settings: FrameSettings) -> float:
        """Inverse depth of the nearest surface of the loaded scene in the picture, 1/m."""
        return self._peeler.nearest_w(PinholeView.from_camera(camera, settings.width, settings.height))

    def layers_bytes(self, camera: Camera, width: int, height: int, layers: int) -> int:
        """Memory of ``layers`` unlit layers of exactly ``width`` by ``height`` pixels, and of their N-buffers."""
        view = PinholeView.from_camera(camera, width, height)
        umbra = umbra_reach(view.fx * pupil_radius_m(camera))
        peeled = self._peeler.peel(view, layers=layers, umbra=umbra, unlit=True)
        return peeled.targets.bytes + self._nbuffers.build(peeled, self._peeler.nearest_w(view)).bytes

    def close(self) -> None:
        """Give the device's memory and the context back."""
        self.graphics.make_current()  # another context of the process may have been current since
        self._nbuffers.release()
        self._lens.release()
        self._peeler.release()
        self.graphics.close()

    def __enter__(self) -> LensRig:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _timed(self, camera: Camera, settings: FrameSettings) -> tuple[TracedPicture, dict[str, Spent]]:
        view = PinholeView.from_camera(camera, settings.width, settings.height)
        self._peeler.clear_cache()
        clock = StageClock(self.graphics.ctx.finish)
        picture = self._lens.picture(
            self._peeler,
            camera,
            view,
            make_ray_pattern(settings.rays, camera.iris, seed=settings.seed, tiled=settings.tiled),
            wavelengths=settings.wavelengths,
            layers=settings.layers,
            supersample=traced_scale(settings),
            on_stage=clock,
        )
        return picture, clock.spent


def _count_behind(layers: Layers) -> int:
    """Number of texels that hold a surface, in all layers but the first."""
    packs = layers.targets.packed_w[: -(-layers.count // LAYERS_PER_PACK)]
    filled = [np.frombuffer(pack.read(), np.float32).reshape(-1, LAYERS_PER_PACK) != 0 for pack in packs]
    return int(sum(pack.sum() for pack in filled) - filled[0][:, 0].sum()) if filled else 0
