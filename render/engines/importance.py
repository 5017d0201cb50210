"""Engine ``importance``: the picture of ``linear``, updated where it has changed since the picture before.

Computes: the sums of ``linear`` are kept from picture to picture. The old effect of each changed pixel is subtracted from its
neighbours and the new one added, the most visible changes first. When all changes are made the picture is that of ``linear``
to the bit. A picture of another size begins anew; the margin around the picture grows in steps, so that pictures of one shot
mostly have one size.

Settings: as ``linear``. Frames of one command or one live view are drawn in their order.

Cost: a hundred frames of Fearing's experiments at 1024x1024 take 3 times less than by ``linear`` in a focus pull and 58 times
less where one thing moves (`pullfocus bench importance`); 112 bytes a pixel for each side of the focus.

Limits: those of ``linear``, among them the largest radius of 96 supersampled pixels.

Source: Fearing 1995, "Importance Ordering for Real-Time Depth of Field", sections 4 and 5; `render.postblur.importance_field`
says what differs.

Example::

    pullfocus record demo/night_street.usda ordered.####.png --frames 40:42 --engine importance --supersample 1
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from render.engines.base import Engine
from render.engines.shared.cost import PictureWork, blurred_cost_s
from render.engines.shared.request import DrawRequest
from render.model.arrays import FloatArray

if TYPE_CHECKING:  # needs OpenGL
    from render.engines.shared.device import Device

MARGIN_STEP_PX = 16
"""Steps by which the margin around the picture grows: sums are kept for pictures of one size only."""


class ImportanceEngine(Engine):
    """Spreads what has changed since the picture before."""

    name = "importance"
    summary = "makes the picture of linear from what has changed since the frame before"
    rank = 50
    uses_image_space = True
    preview = "blur"
    draws_splats = True

    def __init__(self, device: Device) -> None:
        from render.postblur.importance import ImportanceBlur

        super().__init__(device)
        self._blur = ImportanceBlur(device.graphics.ctx, device.programs, device.graphics.cancellation)

    @classmethod
    def cost_s(cls, work: PictureWork) -> float:
        """Estimate the processor time of a picture, s."""
        return blurred_cost_s(work, pixel_s=1e-5)

    def draw(self, request: DrawRequest) -> FloatArray:
        """Blur the view from the pupil's centre; a closed iris is traced, since nothing is blurred."""
        return self._device.blur(request, self._blur, margin_step=MARGIN_STEP_PX)

    def release(self) -> None:
        """Give back what is kept between pictures."""
        self._blur.release()
