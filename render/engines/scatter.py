"""Engine ``scatter``: each point out of focus drawn as the picture of the iris.

Computes: the scene is peeled once from the pupil's centre and parted at the focus. Each point is drawn as a spot: a table of
where the rays of a point on the axis land, at the point's circle of confusion. Equal neighbours are drawn as one square,
wide spots at less resolution.

Settings:
    layers      peeled layers at most, 1 to 8 (4).
    supersample pixels that are blurred to one pixel of the picture, along each axis, rounded up to a whole number; 0 for 2 (0).
    rays, tiled, wavelengths and seed have no effect while the iris is open.

Cost: frame 40 of the demo shot at 960x540 takes 0.7 s of processor time on two CPU cores, with the layers kept and
supersample 1; nearly the same for all radii, and up to five times as long where every pixel has a radius of its own.

Limits: of the lens only masks of the iris and errors on the axis (spherical aberration): no coma, no cat's eyes, no colour
fringes. Visibility is that of the pupil's centre. 38 to 41 dB from the engine ``lens`` on generated scenes.

Source: Kyaw 2013, section 7.3; `render.postblur.scatter` says what differs.

Example::

    pullfocus record demo/night_street.usda spots.png --frames 40 --engine scatter --lens planar_50
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, blurred_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device


class ScatterEngine(Engine):
    """Draws each point of one picture as the iris."""

    name = "scatter"
    summary = "draws each point of one picture as the iris, with the spherical aberration of the lens"
    rank = 20
    uses_image_space = True
    draws_axis_aberrations = True
    preview = "blur"
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.postblur.scatter import ScatterBlur

        super().__init__(device)
        self._blur = ScatterBlur(device.graphics.ctx, device.programs, device.graphics.cancellation)

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return blurred_cost_s(work, pixel_s=6e-6)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Blur the view from the pupil's centre; a closed iris is traced, since nothing is blurred."""
        return self._device.blur(request, self._blur, with_axis_errors=True)

    def release(self) -> None:
        """Give back what is kept between pictures."""
        self._blur.release()
