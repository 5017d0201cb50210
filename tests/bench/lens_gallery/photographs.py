"""Takes the gallery's pictures: a camera for each entry, its frame, and the detail out of it."""

from __future__ import annotations

import math
import time as clock
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from render.files import write_atomic
from render.film import Grade, develop
from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.limits import MAX_RAYS
from render.output import FrameMetadata
from render.output.encode import encode_png
from render.pictures.long_exposure import LongExposure
from render.pictures.picture import make_picture
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens
from tests.bench.lens_gallery.camera import CameraEntry
from tests.bench.lens_gallery.entries import Entry, Shown

DETAIL = 4
"""The detail is the picture's width and height over this."""
ENLARGED = 2


@dataclass(frozen=True)
class Size:
    """Size and sampling of the gallery's pictures.

    Attributes:
        width: pixels.
        height: likewise.
        rays: of each pixel, where neither the entry nor its view says.
    """

    width: int = 640
    height: int = 360
    rays: int = 64


@dataclass(frozen=True, eq=False)
class Photograph:
    """An entry's picture as it was taken.

    Attributes:
        entry: what was asked for.
        picture: name of its file.
        detail: name of the detail's file.
        caption: what the camera says of itself.
        seconds: that the frame took.
    """

    entry: Shown
    picture: str
    detail: str
    caption: str
    seconds: float


class Photographer:
    """Takes pictures of one shot, of one size, into one folder."""

    def __init__(self, shot: Shot, renderer: FrameRenderer, size: Size, folder: Path) -> None:
        self._shot = shot
        self._renderer = renderer
        self._size = size
        self._folder = folder
        self._unedited = shot.edits.export()

    def take(self, entry: Shown) -> Photograph:
        """Render an entry, and write its picture and detail.

        Raises:
            InputError: its lens is none.
            GraphicsError: OpenGL reports an error.
            OutputError: a file cannot be written.
        """
        began = clock.perf_counter()
        if isinstance(entry, CameraEntry):
            graded, metadata, said = self._by_the_camera(entry)
        else:
            assert isinstance(entry, Entry)
            graded, metadata, said = self._by_the_lens(entry)
        seconds = clock.perf_counter() - began
        names = f"{entry.slug}.png", f"{entry.slug}-detail.png"
        for name, pixels in zip(names, (graded, detail_of(graded, entry.detail)), strict=True):
            write_atomic(self._folder / name, encode_png(pixels, metadata))
        return Photograph(entry, *names, said, seconds)

    def _by_the_lens(self, entry: Entry) -> tuple[FloatArray, FrameMetadata, str]:
        """A picture of what the lens does, on no film; what it is, and its caption."""
        camera = self._camera(entry)
        settings = FrameSettings(
            self._size.width,
            self._size.height,
            rays=entry.rays or self._rays_for(entry),
            wavelengths=entry.wavelengths,
        )
        frame = self._renderer.render(self._shot.scene_at(entry.view.frame), camera, settings)
        metadata = FrameMetadata(camera=camera, time=entry.view.frame, grade=Grade(), stage=self._shot.path.name)
        return develop(frame.color, camera.exposure_scale, Grade()), metadata, caption(camera, entry, settings)

    def _by_the_camera(self, entry: CameraEntry) -> tuple[FloatArray, FrameMetadata, str]:
        """A picture as `pullfocus record` makes it."""
        size, stock = self._size, entry.stock or None
        rays = max(size.rays * entry.finer, entry.motion)
        settings = FrameSettings(size.width, size.height, rays=rays, motion=entry.motion)
        try:
            entry.prepare(self._shot)
            exposure = self._shot.exposure.read(None, entry.frame)
            if entry.opening is None:
                picture = make_picture(self._renderer, self._shot, None, entry.frame, settings, stock=stock)
                angle = f"{math.degrees(exposure.shutter_angle_rad):.0f}°"
                shutter = f"{angle} in {entry.motion} moments" if entry.motion > 1 else "motion stopped"
            else:
                few = replace(settings, rays=max(1, size.rays // 2), motion_by="velocities")
                taken = LongExposure(
                    self._renderer, self._shot, None, entry.frame, few, nd_stops=entry.nd_stops, stock=stock
                )
                for begin, end in entry.opening.intervals():
                    taken.expose(begin, end)
                picture, state = taken.develop(), taken.state
                shutter = f"{state.open_seconds:.2g} s, ND {state.nd_stops:.1f} stops"
        finally:
            self._shot.edits.replace(self._unedited)
        lens = picture.camera
        numbers = (
            f"{lens.focal_length_mm:.4g} mm · f/{lens.f_stop:.3g} · EV {exposure.ev100:.1f} · {shutter}",
            f"focus {lens.focus_distance_m:.3g} m · {settings.rays} rays · frame {entry.frame:g}",
        )
        return picture.graded, picture.metadata, " · ".join(numbers)

    def _rays_for(self, entry: Entry) -> int:
        """Many wavelengths are many rays as it is."""
        finer = entry.view.finer if entry.wavelengths <= 3 else 1
        return min(self._size.rays * finer, MAX_RAYS)

    def _camera(self, entry: Entry) -> Camera:
        """The shot's camera with the entry's lens, where the entry wants it."""
        if entry.lens is not None:
            self._shot.camera.mount_lens(None, choose_lens(entry.lens))
        try:
            camera = self._shot.camera_at(None, entry.view.frame, self._size.width, self._size.height)
        finally:
            self._shot.edits.replace(self._unedited)
        return entry.change(entry.view.placed(camera))


def detail_of(picture: FloatArray, centre: tuple[float, float]) -> FloatArray:
    """The part around a place, each pixel as a square of pixels.

    Args:
        picture: ``(height, width, 3)``.
        centre: in shares of width and height; a part that would stick out is moved in.
    """
    height, width = picture.shape[:2]
    high, wide = height // DETAIL, width // DETAIL
    top = int(np.clip(round(centre[1] * height - high / 2), 0, height - high))
    left = int(np.clip(round(centre[0] * width - wide / 2), 0, width - wide))
    part = picture[top : top + high, left : left + wide]
    return np.ascontiguousarray(part.repeat(ENLARGED, axis=0).repeat(ENLARGED, axis=1))


def caption(camera: Camera, entry: Entry, settings: FrameSettings) -> str:
    """Focal length, f-number, focus and sampling in one line."""
    opening = f"f/{camera.f_stop:g}" if camera.f_stop > 0 else "pinhole"
    return (
        f"{camera.focal_length_mm:.4g} mm · {opening} · focus {camera.focus_distance_m:.3g} m · "
        f"{settings.rays} rays · {settings.wavelengths} wavelength{'s' if settings.wavelengths > 1 else ''} · "
        f"frame {entry.view.frame:g}, {entry.view.name}"
    )
