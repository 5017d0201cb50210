"""Function of the picture process that streams pictures of a live request, each better than the last, up to the exact one."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from render.frame import FrameSettings
from render.output.encode import encode_jpeg, encode_png
from render.pictures.progressive import PreviewRequest, ProgressivePicture
from render.shot import Shot
from service.models.changes import Change, PictureSpot, anchor_spots, picture_spots
from service.models.focus import Anchor
from service.picture.focus_maps import encode_focus_map
from service.picture.frames import anchor_of, frame_settings, grade_choice, pick_at
from service.picture.requests import FrameRequest, LiveNumbers, LivePicture
from service.picture.state import PictureWorkerState, picture_function
from service.stage.camera_changes import EditedCamera
from service.stage.changes import apply_changes
from service.stage.read_cameras import readout_model
from service.stage.read_points import point_sharpness
from service.workers.streaming import StaleCheck


@picture_function
def stream_pictures(
    state: PictureWorkerState,
    is_stale: StaleCheck,
    request: FrameRequest,
    unsaved: Sequence[Change],
    budget_ms: float,
    is_moving: bool,
    maps_focus: bool,
) -> Iterator[LivePicture | LiveNumbers]:
    """Render one frame progressively. The last picture is the one that `service.picture.frames.render_frame` makes.

    Args:
        state: the worker's state.
        is_stale: polled between pieces of work; the stream ends once it returns True. In a crowd the first picture is hurried.
        request: the frame.
        unsaved: changes that are applied for these pictures only. The lens readout follows the first picture then.
        budget_ms: time for the first picture.
        is_moving: whether the first picture is enough, because the next request follows soon.
        maps_focus: as in `render.pictures.progressive.PreviewRequest`.

    Raises:
        PullfocusError: as `service.picture.frames.render_frame`.
    """
    with state.opened.use(request.record, request.edits) as shot:
        settings = frame_settings(request, shot)
        if unsaved:
            _apply_unsaved(state, shot, request, unsaved, settings)
        preview = PreviewRequest(
            request.camera,
            request.time,
            settings,
            stock=request.finish["film"],
            choice=grade_choice(request),
            budget_ms=budget_ms,
            is_moving=is_moving,
            is_hurried=is_stale.is_crowded,
            maps_focus=maps_focus,
        )
        is_first = True
        for shown in state.progressive(shot).pictures(preview, is_stale=is_stale):
            yield _encode(shown, settings.width)
            if is_first and unsaved:
                yield _read_numbers(shot, request, settings.width / settings.height)
            is_first = False


@picture_function
def draw_ahead(state: PictureWorkerState, request: FrameRequest) -> None:
    """Draw a preview that nobody waits for: the shot is open then, and the second time the layers of its previews are kept.

    Args:
        state: the worker's state.
        request: the frame.

    Raises:
        PullfocusError: as `service.picture.frames.render_frame`.
    """
    with state.opened.use(request.record, request.edits) as shot:
        preview = PreviewRequest(request.camera, request.time, frame_settings(request, shot), is_moving=True)
        for _ in state.progressive(shot).pictures(preview):
            pass


def _apply_unsaved(
    state: PictureWorkerState,
    shot: Shot,
    request: FrameRequest,
    changes: Sequence[Change],
    settings: FrameSettings,
) -> None:
    """Apply changes to the shot as this process has it open; the next request restores the saved edits."""

    def find(spot: PictureSpot) -> Anchor | None:
        (x, y), time_code = spot
        size = settings.width, settings.height
        pick = pick_at(state, shot, request.camera, time_code, size, (x * settings.width, y * settings.height))
        return None if pick is None else anchor_of(pick)

    # Picked before anything is edited: the position is one of the picture that the user sees.
    anchors = {spot: find(spot) for spot in picture_spots(changes)}
    with shot.edits.transaction("try"):
        apply_changes(EditedCamera(shot, request.camera), anchor_spots(changes, anchors))


def _read_numbers(shot: Shot, request: FrameRequest, aspect: float) -> LiveNumbers:
    camera, time_code = request.camera, request.time
    points = shot.focus.points(camera, time_code, aspect=aspect)
    return LiveNumbers(readout_model(shot.focus.read(camera, time_code), time_code), [*map(point_sharpness, points)])


def _encode(shown: ProgressivePicture, requested_width: int) -> LivePicture:
    """Encode a picture: lossless where it is the exact one."""
    began_s = time.perf_counter()
    final = shown.picture
    data = encode_jpeg(shown.graded) if final is None else encode_png(shown.graded, final.metadata)
    encode_ms = 1e3 * (time.perf_counter() - began_s)
    height, width = shown.graded.shape[:2]
    return LivePicture(
        shown.stage,
        "png" if shown.is_final else "jpeg",
        width,
        height,
        asdict(shown.timing) | {"encode_ms": encode_ms},
        shown.rays,
        width / requested_width,
        shown.share,
        data,
        b"" if shown.focus is None else encode_focus_map(shown.focus),
    )
