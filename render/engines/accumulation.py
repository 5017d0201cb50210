"""Engine ``accumulation``: one rendering of the scene for each lens ray. The slow reference.

Computes: for each sample of the pupil the scene is drawn as a pinhole camera at that point sees it, sheared so that the plane of
focus stays in place; the picture is the mean. Visibility is exact at pixel centres, through any number of
partly transparent surfaces. The sensor offset of each sample anti-aliases.

Settings:
    rays        renderings, 1 to 4096 (100). All pixels share one pattern, so that too few show as ghosts, not as noise.
    supersample filter width of textures, as if layers were that fine; 0 for that of the lens engine's (0).
    seed        of the pattern (0).
    layers, tiled and wavelengths have no effect.

Cost: proportional to rays times triangles. The demo shot at 960x540 with 100 rays took 64 s on two CPU cores.

Gaussian splats are sorted and drawn anew for each view, between the surfaces of each pixel.

Limits: thin lenses with a plane of focus, tilted or not. Other lenses and bent focal surfaces are refused. Motion is drawn moment
by moment.

Source: Haeberli & Akeley 1990, "The Accumulation Buffer: Hardware Support for High-Quality Rendering".

Example::

    pullfocus record demo/night_street.usda reference.png --frames 40 --engine accumulation --rays 16 --imageWidth 320
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, accumulated_cost_s
from render.engines.shared.layer_scale import traced_scale
from render.engines.shared.request import DrawRequest
from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.optics.sampling import ray_range
from render.optics.thin_lens import focal_surface

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device


class AccumulationEngine(Engine):
    """Accumulates pinhole views through the pupil."""

    name = "accumulation"
    summary = "renders the scene once for each ray, as a slow reference"
    rank = 60
    has_rays = True
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.trace.accumulator import Accumulator

        super().__init__(device)
        self._accumulator = Accumulator(device.graphics.ctx, device.programs)

    @classmethod
    def check_camera(cls, camera: Camera) -> None:
        """Raise `SettingsError` unless the camera has a thin lens, or a pinhole, and a plane of focus."""
        if camera.lens.model not in ("thin", "pinhole") and camera.f_stop > 0:
            raise SettingsError(
                f"engine accumulation can show a thin lens alone, and camera {camera.path} has a lens of model "
                f"{camera.lens.model}: use engine lens"
            )
        if not focal_surface(camera).is_plane:
            raise SettingsError(
                f"engine accumulation can show a plane of focus alone, and camera {camera.path} has a focal surface that is "
                "none: use engine lens"
            )

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return accumulated_cost_s(work)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Accumulate the request's part of the views."""
        from render.trace.accumulator import choose_view_sampling, make_lens_points

        camera, view, settings = request.camera, request.view, request.settings
        return self._accumulator.accumulate(
            self._device.peeler,
            view,
            make_lens_points(camera, settings.rays, settings.seed)[ray_range(settings.rays, *request.part)],
            focal_surface(camera).plane,
            unlit=request.is_unlit,
            sampling=choose_view_sampling(camera, view, settings.rays, traced_scale(settings, request.part[1])),
            on_progress=request.on_progress,
        )
