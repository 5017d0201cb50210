"""Pictures of both eyes of a stereo pair at one time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from render.film import GradeChoice
from render.model.camera import Camera
from render.pictures.picture import Picture, develop_picture, expose_frame, prepare_camera
from render.shot.film.finish import Finish
from render.shot.shot import Shot
from render.stage import EYES, Eye, StereoPair

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import FrameRenderer, FrameSettings


def make_stereo_pictures(
    renderer: FrameRenderer,
    shot: Shot,
    pair: StereoPair,
    time: float,
    settings: FrameSettings,
    on_progress: Callable[[float], None] | None = None,
    *,
    stock: str | None = None,
    choice: GradeChoice | None = None,
) -> Mapping[Eye, Picture]:
    """Make the pictures of both eyes as `render.pictures.picture.make_picture` makes one.

    Where the right camera is exposed by a light meter, it has the exposure of the left one: eyes of unlike brightness tire.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        pair: its cameras.
        time: USD time code.
        settings: of each picture.
        on_progress: called with the share of the rendering of both that is done, from 0 to 1.
        stock: as in `make_picture`.
        choice: as in `make_picture`.

    Raises:
        SettingsError: as in `make_picture`.
        CameraError: as in `make_picture`.
        GraphicsError: OpenGL reports an error.
    """

    def prepare(eye: Eye) -> tuple[Camera, Finish]:
        return prepare_camera(renderer, shot, pair.of(eye), time, settings, stock=stock, choice=choice)

    prepared = {eye: prepare(eye) for eye in EYES}  # errors of either come before anything slow is done
    if shot.exposure.metering(pair.right, time).mode != "manual":
        camera, finish = prepared["right"]
        prepared["right"] = replace(camera, exposure_scale=prepared["left"][0].exposure_scale), finish
    pictures = {}
    for number, eye in enumerate(EYES):
        camera, finish = prepared[eye]

        def show_progress(share: float, done: int = number) -> None:
            if on_progress is not None:
                on_progress((done + share) / len(EYES))

        frame = expose_frame(renderer, shot, pair.of(eye), camera, time, settings, show_progress)
        picture = develop_picture(shot, frame, camera, time, settings, finish)
        pictures[eye] = replace(picture, metadata=replace(picture.metadata, view=eye))
    return pictures
