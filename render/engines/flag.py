"""Engine ``flag``: one picture blurred in time linear in the radius, a preview without noise.

Computes: the scene is peeled once from the pupil's centre and split into three parts: the near field, the slightly blurred far
field, and the strongly blurred far field. FLAG spreads each part over the outline of the iris from the columns of the outline
that begin and end at each pixel. The parts are composited front to back.

Settings:
    layers      peeled layers at most, 1 to 8 (4): the nearest and what it hides.
    supersample pixels that are blurred to one pixel of the picture, along each axis, rounded up to a whole number; 0 for 2 (0).
    rays, tiled, wavelengths and seed have no effect while the iris is open.

Cost: frame 40 of the demo shot at 960x540 takes 2.7 s of processor time on two CPU cores with peeling, 0.9 s with the layers kept
(supersample 1). The time of a blur grows with the radius to the power 0.9 to 1.04. Memory, of supersampled pixels: 67 MB for a
part of the picture, or 33 kB for each of its columns (67 kB where top and bottom of the iris differ) where that is more; and 128
bytes a pixel with the fields.

Limits: convex irises, evenly bright: masks and inner holes are filled. An ideal lens, or one by its data sheet in image
space. Visibility is that of the pupil's centre. 38 to 40 dB from the engine ``lens`` on generated scenes.

Source: Moersch & Hamilton 2014, "Variable-Sized, Circular Bokeh Depth of Field Effects", section 3; `render.postblur.flag` says
what differs.

Example::

    pullfocus record demo/night_street.usda flag.png --frames 40 --engine flag
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, blurred_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device


class FlagEngine(Engine):
    """Blurs one picture in linear time."""

    name = "flag"
    summary = "blurs one picture in linear time, without noise"
    rank = 10
    uses_image_space = True
    preview = "blur"
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.postblur.flag_blur import FlagBlur

        super().__init__(device)
        self._blur = FlagBlur(device.graphics.ctx, device.programs, device.graphics.cancellation)

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return blurred_cost_s(work, pixel_s=6e-6)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Blur the view from the pupil's centre; a closed iris is traced, since nothing is blurred."""
        return self._device.blur(request, self._blur)

    def release(self) -> None:
        """Give back what is kept between pictures."""
        self._blur.release()
