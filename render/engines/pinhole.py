"""Engine ``pinhole``: everything sharp.

Computes: the picture of the engine ``lens`` with the iris closed to a point (f-number 0). The rays of a pixel differ only in
where they leave the sensor, so that they anti-alias. The errors of a lens by its data sheet are
applied to the finished picture (`render.pictures.image_space`).

Settings: as ``lens``. rays 4 to 8 are enough for anti-aliasing (100), layers 1 is enough where nothing is transparent (4).

Cost: the demo shot at 960x540 takes 2.9 s on two CPU cores with 100 rays and four layers.

Limits: no depth of field, no flare, no errors, distortion or vignetting of a prescription.

Source: the limit of the engine ``lens`` (Lee, Eisemann & Seidel 2010, section 3.1) for a pupil of radius 0.

Example::

    pullfocus record demo/night_street.usda sharp.png --frames 40 --engine pinhole --rays 8
"""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, traced_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # they need OpenGL
    from render.layers.movement import Movement
    from render.trace.motion_tracer import ShutterSample


class PinholeEngine(Engine):
    """Traces one point of the pupil."""

    name = "pinhole"
    summary = "has everything sharp"
    rank = 70
    has_rays = True
    traces_lens = True
    is_sharp = True
    uses_image_space = True
    takes_velocities = True
    draws_mattes = True
    draws_splats = True

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return traced_cost_s(work, layers=1)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Trace the request's part of the rays."""
        return self._device.trace(request)

    def draw_swept(
        self, request: DrawRequest, samples: Sequence[ShutterSample], movements: Mapping[int, Movement]
    ) -> Generator[FloatArray, None, None]:
        """Carry what moves along straight ways through layers that are peeled once."""
        return self._device.trace_swept(request, samples, movements)
