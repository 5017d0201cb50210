"""Engine ``gather``: the picture of ``flag`` by the definition of the blur, point by point. A baseline.

Computes: as ``flag``, but each pixel tests every point around it and sums the light of those whose iris image reaches it.

Settings:
    layers      peeled layers at most, 1 to 8 (4).
    supersample pixels that are blurred to one pixel of the picture, along each axis, rounded up to a whole number; 0 for 2 (0).
    rays, tiled, wavelengths and seed have no effect while the iris is open.

Cost: proportional to the square of the largest radius. A picture of 384x384 takes 0.07 s of processor time on two CPU cores
at a radius of 3 pixels, 0.8 s at 13, 26 s at 81.

Limits: those of ``flag``. The two agree to the rounding of the outline.

Source: the definition of the blur that Moersch & Hamilton 2014 compute in linear time.

Example::

    pullfocus record demo/night_street.usda gather.png --frames 40 --engine gather --imageWidth 240 --supersample 1
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, blurred_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device


class GatherEngine(Engine):
    """Blurs one picture point by point."""

    name = "gather"
    summary = "blurs one picture point by point, the slow definition of flag"
    rank = 30
    uses_image_space = True
    preview = "blur"
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.postblur.gather import GatherBlur

        super().__init__(device)
        self._blur = GatherBlur(device.graphics.ctx, device.programs, device.graphics.cancellation)

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return blurred_cost_s(work, pixel_s=3e-6, per_px2=4.6e-11)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Blur the view from the pupil's centre; a closed iris is traced, since nothing is blurred."""
        return self._device.blur(request, self._blur)

    def release(self) -> None:
        """Give back what is kept between pictures."""
        self._blur.release()
