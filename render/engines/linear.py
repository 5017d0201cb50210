"""Engine ``linear``: the linear post-filter, each pixel spread over its circle of confusion by a table. A baseline.

Computes: the scene is peeled once from the pupil's centre and parted at the focus. Each pixel is the sum of the weighted
light that falls on it over the sum of the weights. The sums are exact: light is rounded to 29 bits below the brightest in the
picture, to 25 with a mask or radial weights, and weights to 20.

Settings:
    layers      peeled layers at most, 1 to 8 (4).
    supersample pixels that are blurred to one pixel of the picture, along each axis, rounded up to a whole number; 0 for 2 (0).
    rays, tiled, wavelengths and seed have no effect while the iris is open.

Cost: proportional to the area of the circles of confusion; 40 bytes a pixel for each side of the focus, and tables of 3 MB
for radii up to 20 pixels, 84 MB up to 96.

Limits: radii above 96 supersampled pixels are drawn as 96 (with a squeeze below 1, also wider blurs). Dividing by
the sum of weights does not conserve the light of a point. An ideal lens, or one by its data sheet in image space.
34 to 35 dB from the engine ``lens`` on generated scenes.

Source: Potmesil & Chakravarty 1981, "A Lens and Aperture Camera Model for Synthetic Image Generation"; the cut-off of what is
hidden is Fearing's (1995, section 5).

Example::

    pullfocus record demo/night_street.usda linear.png --frames 40 --engine linear --supersample 1
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, blurred_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device


class LinearEngine(Engine):
    """Spreads each pixel of one picture by a table."""

    name = "linear"
    summary = "blurs one picture pixel by pixel"
    rank = 40
    uses_image_space = True
    preview = "blur"
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.postblur.linear import LinearBlur

        super().__init__(device)
        self._blur = LinearBlur(device.graphics.ctx, device.programs, device.graphics.cancellation)

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return blurred_cost_s(work, pixel_s=3e-6, per_px=3.5e-9)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Blur the view from the pupil's centre; a closed iris is traced, since nothing is blurred."""
        return self._device.blur(request, self._blur)

    def release(self) -> None:
        """Give back what is kept between pictures."""
        self._blur.release()
