"""What the picture process is asked for while somebody watches: pictures that get better and better, until the exact one."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

from service.models.cameras import Readout
from service.models.focus import FocusPointEdit
from service.models.live import Stage, UnsavedEdit
from service.picture.frames import Darkroom, anchor_of
from service.picture.picture_size import height_at
from service.stage.applying import (
    apply_key,
    apply_to_camera,
    apply_to_exposure,
    apply_to_film,
    apply_to_focus,
    apply_to_point,
)
from service.storage.store import ShotRecord
from service.workers.streaming import IsStale

if TYPE_CHECKING:
    from render.frame import FrameSettings
    from render.pictures.progressive import Shown
    from render.shot import Shot


@dataclass(frozen=True)
class ShownPicture:
    """A picture of a live request.

    Attributes:
        stage: how good it is.
        format: of ``data``.
        width: px.
        height: px.
        took_ms: by what, as `service.models.live.LiveTiming` has it, but for when it was answered.
        rays: for each pixel.
        scale: pixels for each that was asked for, along a side.
        share: of the final picture's work that is done.
        data: the encoded picture.
    """

    stage: Stage
    format: Literal["jpeg", "png"]
    width: int
    height: int
    took_ms: dict[str, float]
    rays: int
    scale: float
    share: float
    data: bytes

    @property
    def is_final(self) -> bool:
        """Whether no better one comes."""
        return self.stage == "final"


@dataclass(frozen=True)
class ShowLive:
    """Render one frame for somebody who watches.

    Attributes:
        record: of which shot.
        edits: its edit layer at the moment of asking.
        unsaved: what is tried on top of that, or None.
        camera: prim path, or None for the default camera.
        time: USD time code.
        height: pixels, or None for the film gate's shape.
        max_px: pixels of it all; more are not rendered.
        settings: the other fields of `render.frame.FrameSettings`.
        finish: film, display, view and look in place of the shot's; None for those that are the shot's.
        budget_ms: what the first picture may take.
        is_moving: whether the first picture is enough, since the next one is asked for soon.
    """

    record: ShotRecord
    edits: str
    unsaved: UnsavedEdit | None
    camera: str | None
    time: float
    height: int | None
    max_px: int
    settings: dict[str, Any]
    finish: dict[str, str | None]
    budget_ms: float
    is_moving: bool

    def stream(self, room: Darkroom, is_stale: IsStale) -> Iterator[ShownPicture | Readout]:
        """Better and better pictures, and the last is the one that `RenderPicture` makes.

        With an unsaved edit, what the lens does comes after the first of them. Raises what `RenderPicture` raises.
        """
        from render.film import GradeChoice
        from render.pictures.progressive import PreviewRequest
        from service.stage.read_shot import as_readout

        with room.opened.use(self.record, self.edits) as shot:
            settings = self._settings(shot)
            if self.unsaved is not None:
                self._try(room, shot, self.unsaved, settings)
            said = self.finish
            choice = GradeChoice(display=said["display"], view=said["view"], look=said["look"])
            asked = PreviewRequest(
                self.camera,
                self.time,
                settings,
                stock=said["film"],
                choice=None if choice == GradeChoice() else choice,
                budget_ms=self.budget_ms,
                is_moving=self.is_moving,
            )
            is_first = True
            for shown in room.progressive(self.record.id, shot).pictures(asked, is_stale=is_stale):
                yield _encoded(shown, settings.width)
                if is_first and self.unsaved is not None:
                    yield as_readout(shot.readout(self.camera, self.time), self.time)
                is_first = False

    def _settings(self, shot: Shot) -> FrameSettings:
        from render.frame import FrameSettings

        height = self.height or height_at(shot, self.camera, self.time, self.settings["width"], self.max_px)
        return FrameSettings(**self.settings, height=height)

    def _try(self, room: Darkroom, shot: Shot, edit: UnsavedEdit, settings: FrameSettings) -> None:
        """Make an edit on the shot as this process has it open; the next request puts back what is saved."""
        # Picked before anything is edited: where a pointer is, is a place of the picture that is seen.
        placed = {name: self._picked(room, shot, place, settings) for name, place in edit.places.items()}
        with shot.one_edit("try"):
            if edit.camera is not None:
                apply_to_camera(shot, self.camera, edit.camera)
            if edit.focus is not None:
                apply_to_focus(shot, self.camera, edit.focus)
            if edit.exposure is not None:
                apply_to_exposure(shot, self.camera, edit.exposure)
            if edit.film is not None:
                apply_to_film(shot, self.camera, edit.film)
            for name, point in (*edit.points.items(), *placed.items()):
                if point is not None:
                    apply_to_point(shot, self.camera, self.time, name, point)
            for key in edit.keys:
                apply_key(shot, self.camera, key.point, key.attribute, key.key)

    def _picked(
        self, room: Darkroom, shot: Shot, place: tuple[float, float], settings: FrameSettings
    ) -> FocusPointEdit | None:
        """What puts a focus point on what is seen at a place; None where nothing is."""
        width, height = settings.width, settings.height
        camera = shot.camera_at(self.camera, self.time, width, height)
        x, y = place[0] * width, place[1] * height
        found = room.renderer.pick(shot.scene_at(self.time), camera, width, height, x, y)
        return None if found is None else FocusPointEdit(**anchor_of(found).model_dump())


def _encoded(shown: Shown, asked_width: int) -> ShownPicture:
    """A picture as a file: lossless where it is the exact one."""
    from render.output.encode import encode_jpeg, encode_png

    began_s = time.perf_counter()
    final = shown.picture
    data = encode_jpeg(shown.graded) if final is None else encode_png(shown.graded, final.metadata)
    encode_ms = 1e3 * (time.perf_counter() - began_s)
    height, width = shown.graded.shape[:2]
    return ShownPicture(
        shown.stage,
        "png" if shown.is_final else "jpeg",
        width,
        height,
        asdict(shown.timing) | {"encode_ms": encode_ms},
        shown.rays,
        width / asked_width,
        shown.share,
        data,
    )
