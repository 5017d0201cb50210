"""Image space: the errors of a lens by its data sheet applied to a finished picture, for engines that trace no rays through it.

The frame is rendered with a margin, since the lens bends and blurs light from there into the picture. Then the errors are applied
(`render.postblur.aberrate_passes`) and the margin is cut off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from render.engines import engine_class
from render.model.arrays import IndexArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.moment import Moment
from render.optics.view import PinholeView

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer
    from render.postblur.picture_errors import PictureErrors


def renders_in_image_space(camera: Camera, settings: FrameSettings) -> bool:
    """Tell whether the camera's lens is applied to the finished picture."""
    has_sheet = camera.lens.model == "dataSheet" and camera.lens.data_sheet is not None
    return engine_class(settings).uses_image_space and has_sheet and camera.f_stop > 0


@dataclass(frozen=True, eq=False)
class ImageSpace:
    """Settings of a frame and of the larger frame that is rendered for it.

    Attributes:
        requested: settings of the frame.
        settings: settings of the larger frame; the same where no errors are applied.
        margin: pixels that are added on the left and right, and at the top and bottom.
        view: projection of the larger frame.
        errors: of the lens over the larger frame; None where none are applied.
    """

    requested: FrameSettings
    settings: FrameSettings
    margin: tuple[int, int] = (0, 0)
    view: PinholeView | None = None
    errors: PictureErrors | None = None

    @classmethod
    def for_camera(cls, camera: Camera, settings: FrameSettings) -> ImageSpace:
        """Find the errors of a camera's lens, and the margin that they need."""
        sheet = camera.lens.data_sheet
        if sheet is None or not renders_in_image_space(camera, settings):
            return cls(settings, settings)
        from render.postblur.picture_errors import make_picture_errors  # only for a lens by its data sheet

        view = PinholeView.from_camera(camera, settings.width, settings.height)

        def errors_in(view: PinholeView) -> PictureErrors:
            x, y = max(view.cx, view.width - view.cx) / view.fx, max(view.cy, view.height - view.cy) / view.fy
            return make_picture_errors(
                sheet,
                camera.lens.scales,
                focal_length_mm=camera.focal_length_mm,
                f_stop=camera.f_stop,
                last_slope=float(np.hypot(x, y)),
                squeeze=camera.lens.squeeze,
                colours=settings.wavelengths > 1,
                axis_is_drawn=engine_class(settings).draws_axis_aberrations,
            )

        margin = errors_in(view).margin(view)
        larger = replace(settings, width=settings.width + 2 * margin[0], height=settings.height + 2 * margin[1])
        larger_view = PinholeView.from_camera(_widen_film(camera, settings, margin), larger.width, larger.height)
        return cls(settings, larger, margin, larger_view, errors_in(larger_view))

    def widen_camera(self, camera: Camera) -> Camera:
        """Widen the camera's film by the margin."""
        return camera if self.errors is None else _widen_film(camera, self.requested, self.margin)

    def widen_moment(self, moment: Moment) -> Moment:
        """Widen the film of a moment's camera. In the margin a shutter that travels is open as at the nearest edge."""
        if self.errors is None:
            return moment
        share = np.asarray(moment.share)
        if share.ndim > 1:
            across, up = self.margin
            around = ((up if share.shape[0] > 1 else 0,) * 2, (across if share.shape[1] > 1 else 0,) * 2, (0, 0))
            share = np.pad(share, around, "edge")
        return replace(moment, camera=self.widen_camera(moment.camera), share=share)

    def apply(self, renderer: FrameRenderer, frame: Frame) -> Frame:
        """Apply the errors to a frame, and cut the margin off. AOVs are those of the place that each pixel's green comes from.

        Args:
            renderer: that rendered it, of the calling thread.
            frame: the larger frame.

        Raises:
            GraphicsError: OpenGL reports an error.
            Cancelled: the work is stale, within `CancellationPoint.cancel_when`.
        """
        if self.errors is None or self.view is None:
            return frame
        from render.postblur.aberrate_passes import aberrate_on_device

        renderer.graphics.make_current()
        graphics = renderer.graphics
        color = aberrate_on_device(graphics.ctx, frame.color, self.view, self.errors, graphics.cancellation)
        rows, columns = self._green_source(self.view, self.errors)
        return replace(
            frame,
            color=np.ascontiguousarray(self._crop(color)),
            aovs={name: self._crop(values[rows, columns]) for name, values in frame.aovs.items()},
        )

    def _crop(self, picture: NDArray[Any]) -> NDArray[Any]:
        x, y = self.margin
        return picture[y : y + self.requested.height, x : x + self.requested.width]

    @staticmethod
    def _green_source(view: PinholeView, errors: PictureErrors) -> tuple[IndexArray, IndexArray]:
        """Give the row and column that each pixel's green comes from, ``(height, width)`` each."""
        x, y = np.meshgrid(np.arange(view.width) + 0.5 - view.cx, np.arange(view.height) + 0.5 - view.cy)
        source = errors.at(np.hypot(x / view.fx, y / view.fy))[..., 1]
        column = np.floor(view.cx + x * (1 + (source - 1) / errors.squeeze)).astype(int)
        row = np.floor(view.cy + y * source).astype(int)
        return np.clip(row, 0, view.height - 1), np.clip(column, 0, view.width - 1)


def _widen_film(camera: Camera, settings: FrameSettings, margin: tuple[int, int]) -> Camera:
    return replace(
        camera,
        horizontal_aperture_mm=camera.horizontal_aperture_mm * (1 + 2 * margin[0] / settings.width),
        vertical_aperture_mm=camera.vertical_aperture_mm * (1 + 2 * margin[1] / settings.height),
    )
