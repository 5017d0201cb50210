"""A lens by its data sheet before engines that trace no rays through it: its errors are put on the finished picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from render.engines import engine_of
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.moment import Moment
from render.optics.view import PinholeView
from render.postblur.picture_errors import PictureErrors, picture_errors

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer


def renders_in_image_space(camera: Camera, settings: FrameSettings) -> bool:
    """Whether the camera's lens is put on the finished picture: the engine's rays do not pass it."""
    has_sheet = camera.lens.model == "dataSheet" and camera.lens.data_sheet is not None
    return engine_of(settings).uses_image_space and has_sheet and camera.f_stop > 0


@dataclass(frozen=True, eq=False)
class ImageSpace:
    """How a frame is rendered so that a lens can be put on it: larger, since what is bent and blurred into it must be there.

    Attributes:
        asked: how the frame was asked for.
        settings: how it is rendered.
        margin: pixels more on the left and right, and at the top and bottom.
        view: of the larger picture.
        errors: None where the frame is to be left as it is.
    """

    asked: FrameSettings
    settings: FrameSettings
    margin: tuple[int, int] = (0, 0)
    view: PinholeView | None = None
    errors: PictureErrors | None = None

    @classmethod
    def of(cls, camera: Camera, settings: FrameSettings) -> ImageSpace:
        """For a camera, and how its frame is asked for."""
        sheet = camera.lens.data_sheet
        if sheet is None or not renders_in_image_space(camera, settings):
            return cls(settings, settings)
        view = PinholeView.from_camera(camera, settings.width, settings.height)

        def errors(seen: PinholeView) -> PictureErrors:
            x, y = max(seen.cx, seen.width - seen.cx) / seen.fx, max(seen.cy, seen.height - seen.cy) / seen.fy
            return picture_errors(
                sheet,
                camera.lens.scales,
                focal_length_mm=camera.focal_length_mm,
                f_stop=camera.f_stop,
                last_slope=float(np.hypot(x, y)),
                squeeze=camera.lens.squeeze,
                colours=settings.wavelengths > 1,
                axis_is_drawn=engine_of(settings).draws_axis_aberrations,
            )

        margin = errors(view).margin(view)
        wider = replace(settings, width=settings.width + 2 * margin[0], height=settings.height + 2 * margin[1])
        larger = PinholeView.from_camera(_wider(camera, settings, margin), wider.width, wider.height)
        return cls(settings, wider, margin, larger, errors(larger))

    def camera(self, camera: Camera) -> Camera:
        """The camera with as much more of film."""
        return camera if self.errors is None else _wider(camera, self.asked, self.margin)

    def moments(self, moment_at: Callable[[int], Moment]) -> Callable[[int], Moment]:
        """The shot at its moments, before the larger film."""
        return lambda index: self.moment(moment_at(index))

    def moment(self, moment: Moment) -> Moment:
        """One of them; a shutter that travels is open around the frame as at its edge."""
        if self.errors is None:
            return moment
        share = np.asarray(moment.share)
        if share.ndim > 1:
            across, up = self.margin
            around = ((up if share.shape[0] > 1 else 0,) * 2, (across if share.shape[1] > 1 else 0,) * 2, (0, 0))
            share = np.pad(share, around, "edge")
        return replace(moment, camera=self.camera(moment.camera), share=share)

    def finished(self, renderer: FrameRenderer, frame: Frame) -> Frame:
        """The frame through the lens, as large as it was asked for; what is measured is that of where each pixel sees it.

        Args:
            renderer: that rendered it, of the calling thread.
            frame: of the larger film.

        Raises:
            GraphicsError: the device refuses.
        """
        if self.errors is None or self.view is None:
            return frame
        from render.postblur.aberrate_passes import aberrate_on_device

        renderer.graphics.make_current()
        color = aberrate_on_device(renderer.graphics.ctx, frame.color, self.view, self.errors)
        return replace(
            frame,
            color=np.ascontiguousarray(self._cropped(color)),
            aovs={name: self._cropped(self._bent(values)) for name, values in frame.aovs.items()},
        )

    def _cropped(self, picture: NDArray[Any]) -> NDArray[Any]:
        x, y = self.margin
        return picture[y : y + self.asked.height, x : x + self.asked.width]

    def _bent(self, values: NDArray[Any]) -> NDArray[Any]:
        """Of the pixel that green is seen in."""
        if self.errors is None or self.view is None:
            return values
        view = self.view
        x, y = np.meshgrid(np.arange(view.width) + 0.5 - view.cx, np.arange(view.height) + 0.5 - view.cy)
        source = self.errors.at(np.hypot(x / view.fx, y / view.fy))[..., 1]
        column = np.floor(view.cx + x * (1 + (source - 1) / self.errors.squeeze)).astype(int)
        row = np.floor(view.cy + y * source).astype(int)
        bent: NDArray[Any] = values[np.clip(row, 0, view.height - 1), np.clip(column, 0, view.width - 1)]
        return bent


def _wider(camera: Camera, settings: FrameSettings, margin: tuple[int, int]) -> Camera:
    return replace(
        camera,
        horizontal_aperture_mm=camera.horizontal_aperture_mm * (1 + 2 * margin[0] / settings.width),
        vertical_aperture_mm=camera.vertical_aperture_mm * (1 + 2 * margin[1] / settings.height),
    )
