"""What the picture process is asked for: frames and picks. It alone owns GL, in its one thread."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from service.models.focus import Anchor, Pick
from service.models.shots import PickRequest
from service.picture.picture_size import height_at
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord

if TYPE_CHECKING:
    from render.frame import FrameRenderer
    from render.frame import Pick as SurfacePick
    from render.pictures.live_finisher import LiveFinisher
    from render.pictures.long_exposure import LongExposure
    from render.pictures.progressive.driver import Progressive
    from render.shot import Shot

MAX_WATCHED = 2
"""Shots of which the process keeps what was made for live pictures."""

PICK_WIDTH = 2048
"""Pixels of the picture in which a place is looked up: finer than what anybody points at."""


class Darkroom:
    """The picture process's state: the GL context and the opened shots.

    Both are made by the first request that needs them, so that a machine without GL gets an error that says so, and
    the process that speaks HTTP imports neither GL nor USD.
    """

    def __init__(self) -> None:
        self.opened = OpenedShots()
        self._progressives: OrderedDict[str, tuple[Shot, Progressive]] = OrderedDict()
        self.exposures: dict[str, LongExposure] = {}  # the oldest first

    @cached_property
    def renderer(self) -> FrameRenderer:
        """Raises `GraphicsError` where no context can be made."""
        from render.frame import FrameRenderer

        return FrameRenderer()

    @cached_property
    def live(self) -> LiveFinisher:
        """Finishes pictures on the renderer's device. Raises `GraphicsError` where no context can be made."""
        from render.pictures.live_finisher import LiveFinisher

        return LiveFinisher(self.renderer)

    def progressive(self, shot_id: str, shot: Shot) -> Progressive:
        """What makes live pictures of an opened shot, and holds what it needs for the next one.

        Args:
            shot_id: of the shot.
            shot: as it is open now: what was made for it when it was open before is let go of.

        Raises:
            GraphicsError: no context can be made.
        """
        from render.pictures.progressive.driver import Progressive

        kept = self._progressives.pop(shot_id, None)
        if kept is None or kept[0] is not shot:
            kept = shot, Progressive(self.renderer, shot, self.live)
        self._progressives[shot_id] = kept
        if len(self._progressives) > MAX_WATCHED:
            self._progressives.popitem(last=False)
        return kept[1]

    def forget(self, shot_id: str) -> None:
        """Close a shot, if it is open, and let go of what was made of it."""
        self.opened.forget(shot_id)
        self._progressives.pop(shot_id, None)


@dataclass(frozen=True)
class Warm:
    """Be ready: have a context."""

    def run(self, room: Darkroom) -> None:
        """Raises `GraphicsError`."""
        _ = room.renderer


@dataclass(frozen=True)
class ForgetPictures:
    """Close a shot that was removed."""

    shot_id: str

    def run(self, room: Darkroom) -> None:
        """Close it."""
        room.forget(self.shot_id)


@dataclass(frozen=True)
class RenderPicture:
    """Render one frame.

    Attributes:
        record: of which shot.
        edits: its edit layer at the moment of asking.
        camera: prim path, or None for the default camera.
        time: USD time code.
        height: pixels, or None for the film gate's shape.
        max_px: pixels of it all; more are not rendered.
        settings: the other fields of `render.frame.FrameSettings`.
        format: png, jpeg or exr.
        finish: film, display, view and look in place of the shot's; None for those that are the shot's.
        live: whether it is finished on the device, as quick as can be.
    """

    record: ShotRecord
    edits: str
    camera: str | None
    time: float
    height: int | None
    max_px: int
    settings: dict[str, Any]
    format: str
    finish: dict[str, str | None]
    live: bool = False

    def run(self, room: Darkroom) -> bytes:
        """The encoded picture: the same that `pullfocus record` writes, unless it is live. Raises what `make_picture` raises."""
        from render.film import GradeChoice
        from render.frame import FrameSettings
        from render.output import encode
        from render.pictures.picture import make_picture

        with room.opened.use(self.record, self.edits) as shot:
            height = self.height or height_at(shot, self.camera, self.time, self.settings["width"], self.max_px)
            settings = FrameSettings(**self.settings, height=height)
            said = self.finish
            choice = GradeChoice(display=said["display"], view=said["view"], look=said["look"])
            picture = make_picture(
                room.renderer,
                shot,
                self.camera,
                self.time,
                settings,
                stock=said["film"],
                choice=None if choice == GradeChoice() else choice,
                live=room.live if self.live else None,
            )
            return encode(self.format, picture.frame, picture.graded, picture.metadata)


@dataclass(frozen=True)
class PickSurface:
    """Find what is under a pixel."""

    record: ShotRecord
    edits: str
    asked: PickRequest

    def run(self, room: Darkroom) -> Pick:
        """What is there, if anything. Raises `CameraError` or `SettingsError`."""
        asked = self.asked
        with room.opened.use(self.record, self.edits) as shot:
            scene = shot.scene_at(asked.time)
            camera = shot.camera_at(asked.camera, asked.time, asked.width, asked.height)
            found = room.renderer.pick(scene, camera, asked.width, asked.height, asked.x, asked.y)
        if found is None:
            return Pick(hit=False)
        return Pick(hit=True, anchor=anchor_of(found), depth_m=found.depth_m, position_m=found.position_m)


def anchor_of(found: SurfacePick) -> Anchor:
    """What a focus point is made of that is to stick to a surface where it was picked."""
    return Anchor(
        target=(found.prim_path,) if found.prototype_path is None else (found.prim_path, found.prototype_path),
        face=found.face,
        fan_triangle=found.fan_triangle,
        barycentric=found.barycentric,
        instance=found.instance,
    )


@dataclass(frozen=True)
class FindDepth:
    """Find how far away is what a place of the picture shows.

    Attributes:
        record: of which shot.
        edits: its edit layer at the moment of asking.
        camera: prim path, or None for the default camera.
        time: USD time code.
        screen: the place, from (0, 0) top left to (1, 1) bottom right.
        aspect: width over height of the picture; None takes the film gate's.
    """

    record: ShotRecord
    edits: str
    camera: str | None
    time: float
    screen: tuple[float, float]
    aspect: float | None

    def run(self, room: Darkroom) -> float:
        """Metres along the view axis; infinite where there is nothing. Raises `CameraError` or `SettingsError`."""
        from render.pictures.picture_height import picture_height

        with room.opened.use(self.record, self.edits) as shot:
            height = (
                max(1, round(PICK_WIDTH / self.aspect))
                if self.aspect
                else picture_height(shot, self.camera, self.time, PICK_WIDTH)
            )
            scene = shot.scene_at(self.time)
            camera = shot.camera_at(self.camera, self.time, PICK_WIDTH, height)
            x, y = self.screen[0] * PICK_WIDTH, self.screen[1] * height
            found = room.renderer.pick(scene, camera, PICK_WIDTH, height, x, y)
        return math.inf if found is None else found.depth_m
