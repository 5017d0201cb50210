"""What the stage process is asked about lenses; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.errors import NotFoundError, SettingsError
from service.models.cameras import CameraState
from service.models.lenses import Lens, LensList
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms

if TYPE_CHECKING:
    from render.shot.lens.lens_choice import LensChoice


def lens_to_mount(name: str | None) -> LensChoice:
    """The lens that an edit of a camera names: of the library, or with None the thin lens.

    Raises:
        SettingsError: the library has none of that name.
    """
    from render.shot.lens.lens_choice import THIN, library_choice

    try:
        return THIN if name is None else library_choice(name)
    except NotFoundError as error:  # the address was right, what was sent to it is not
        raise SettingsError(error.detail, code=error.code, path="lens") from error


@dataclass(frozen=True)
class MountLensFile:
    """Mount the lens of a file that was sent."""

    record: ShotRecord
    camera: str | None
    name: str
    data: bytes
    terms: Terms

    def run(self, opened: OpenedShots) -> CameraState:
        """The camera as it is then. Raises `InputError`: it is no lens file, or no lens."""
        from render.shot.lens.lens_choice import file_choice
        from service.stage.read_shot import camera_tag, read_camera_state

        choice = file_choice(self.data, self.name)
        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            shot.mount_lens(self.camera, choice)
            return read_camera_state(shot, self.camera, shot.frame_range.start)


@dataclass(frozen=True)
class ListLenses:
    """The lens library."""

    def run(self, opened: OpenedShots) -> LensList:
        """All of it."""
        from service.stage.read_lenses import list_lenses

        return list_lenses()


@dataclass(frozen=True)
class ReadLibraryLens:
    """One lens of the library."""

    name: str

    def run(self, opened: OpenedShots) -> Lens:
        """Raises `NotFoundError`."""
        from service.stage.read_lenses import read_lens

        return read_lens(self.name)


@dataclass(frozen=True)
class DrawLibraryLens:
    """A small picture of one lens of the library: SVG."""

    name: str

    def run(self, opened: OpenedShots) -> bytes:
        """Raises `NotFoundError`."""
        from service.stage.read_lenses import draw_lens

        return draw_lens(self.name)


@dataclass(frozen=True)
class DrawLensSheet:
    """A sheet about one lens of the library: PNG."""

    name: str

    def run(self, opened: OpenedShots) -> bytes:
        """Raises `NotFoundError`."""
        from service.stage.read_lenses import draw_lens_sheet

        return draw_lens_sheet(self.name)
