"""Framing of a picture: how a camera's gate becomes its pixels, beyond its width and height."""

from __future__ import annotations

from dataclasses import dataclass, replace

from render.model.camera import Camera


@dataclass(frozen=True)
class Window:
    """Part of a whole picture that is rendered, or more than it, in its pixels.

    Attributes:
        left: column of the first pixel; negative for overscan.
        top: row of the first pixel, from the top.
        whole_width: pixels of the whole picture.
        whole_height: likewise.
    """

    left: int
    top: int
    whole_width: int
    whole_height: int


@dataclass(frozen=True)
class Framing:
    """Framing of a picture.

    Attributes:
        conform: how the gate becomes the picture's shape: a token of UsdRenderSettings' ``aspectRatioConformPolicy``; None for
            the stage's own.
        pixel_aspect: width of a pixel over its height.
        window: place of the picture in a larger one; None where it is the whole.
        is_sharp: whether all is in focus: the camera is a pinhole.
    """

    conform: str | None = None
    pixel_aspect: float = 1.0
    window: Window | None = None
    is_sharp: bool = False

    def aspect(self, width: int, height: int) -> float:
        """Width over height of what the whole picture shows, for a picture of these pixels."""
        whole = (self.window.whole_width, self.window.whole_height) if self.window else (width, height)
        return whole[0] * self.pixel_aspect / whole[1]

    def apply(self, camera: Camera, width: int, height: int) -> Camera:
        """Camera of the picture.

        Args:
            camera: its gate has the whole picture's shape.
            width: of the picture in pixels.
            height: likewise.
        """
        if self.is_sharp:
            camera = replace(camera, f_stop=0.0)
        return camera if self.window is None else _cut_gate(camera, self.window, width, height)

    def uncut(self, camera: Camera, width: int, height: int) -> tuple[Camera, int, int]:
        """Camera, width and height of the whole picture, from those of its window; the same where there is no window."""
        if self.window is None:
            return camera, width, height
        return _restore_gate(camera, self.window, width, height), self.window.whole_width, self.window.whole_height


WHOLE = Framing()


def _cut_gate(camera: Camera, window: Window, width: int, height: int) -> Camera:
    """Camera whose gate is a window of the camera's gate. The axis stays where it is in the whole picture."""
    pixel_width_mm = camera.horizontal_aperture_mm / window.whole_width
    pixel_height_mm = camera.vertical_aperture_mm / window.whole_height
    right, up = _off_centre(window, width, height)
    return replace(
        camera,
        horizontal_aperture_mm=width * pixel_width_mm,
        vertical_aperture_mm=height * pixel_height_mm,
        horizontal_offset_mm=camera.horizontal_offset_mm + right * pixel_width_mm,
        vertical_offset_mm=camera.vertical_offset_mm + up * pixel_height_mm,
        whole_diagonal_mm=camera.covered_mm,
    )


def _restore_gate(camera: Camera, window: Window, width: int, height: int) -> Camera:
    """Camera whose gate is that of the whole picture, of which the camera's gate is a window."""
    pixel_width_mm = camera.horizontal_aperture_mm / width
    pixel_height_mm = camera.vertical_aperture_mm / height
    right, up = _off_centre(window, width, height)
    return replace(
        camera,
        horizontal_aperture_mm=window.whole_width * pixel_width_mm,
        vertical_aperture_mm=window.whole_height * pixel_height_mm,
        horizontal_offset_mm=camera.horizontal_offset_mm - right * pixel_width_mm,
        vertical_offset_mm=camera.vertical_offset_mm - up * pixel_height_mm,
    )


def _off_centre(window: Window, width: int, height: int) -> tuple[float, float]:
    """Pixels that the middle of a window lies to the right of, and above, that of the whole picture."""
    return window.left + width / 2 - window.whole_width / 2, window.whole_height / 2 - window.top - height / 2
