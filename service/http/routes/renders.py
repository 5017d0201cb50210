"""Routes of renders: jobs of many frames, which are kept over restarts."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Response
from fastapi import Path as PathParameter
from fastapi.responses import FileResponse
from starlette.concurrency import run_in_threadpool

from render.model.burn_in import BurnIn
from render.model.edit_history import revision_of
from service.hidden_folders import without_folders
from service.http.access import READS, RENDERS, PrincipalDep
from service.http.bodies import BodyRoute
from service.http.clients import present_client
from service.http.errors import ServiceError
from service.http.render_products import frame_file_gone
from service.http.routes.frames import BINARY, MEDIA_TYPES
from service.http.routes.parameters import problems
from service.http.service import Service, ServiceDep
from service.identity.principal import ALL_PROJECTS, Principal
from service.jobs.claims import NewRender
from service.jobs.frame_ranges import parse_frames
from service.jobs.shot_archive import ShotArchive
from service.jobs.states import not_found, state_of
from service.models.base import plain_file_name
from service.models.renders import (
    Attempt,
    FrameFormat,
    Render,
    RenderList,
    RenderRequest,
    RenderTask,
    RenderTaskList,
)
from service.picture.requests import THUMBNAIL
from service.stage.calls import render_plans
from service.stage.calls import shots as shot_calls
from service.storage.database.tables import AttemptRow, RenderRow, TaskRow
from service.storage.store import ShotRecord
from service.storage.store import not_found as no_shot

router = APIRouter(tags=["renders"], prefix="/renders", route_class=BodyRoute, dependencies=READS)

MOST_LISTED = 200
_LATER: dict[str, object] = {"after": [], "aovs": [], "burn_in": [], "lens": None, "products": []}
"""Fields that an earlier version did not know, and their defaults: with these, a request has the digest that it had then."""


def render_in_path(
    render: Annotated[str, PathParameter(description="A render's id.", examples=["r-5f0c1d2e3a4b"], max_length=80)],
    service: ServiceDep,
    principal: PrincipalDep,
) -> RenderRow:
    """Return the render of the path. Raises `NotFoundError`: there is none, as far as the sender may know."""
    row = service.renders.get(render)
    if not principal.sees(row.project):
        raise not_found(render)
    return row


RenderInPath = Annotated[RenderRow, Depends(render_in_path)]


def _render_at_hand(service: ServiceDep, render: RenderInPath) -> RenderRow:
    """Return the render of the path. Raises `ServiceError` 409: another service has its frames."""
    if not service.renders.is_at_hand(render):
        detail = f"Another service has the frames of render {render.id!r}; ask it, or let both share a bucket."
        raise ServiceError(409, "other_service", detail, path="render")
    return render


RenderAtHand = Annotated[RenderRow, Depends(_render_at_hand)]
FrameInPath = Annotated[int, PathParameter(ge=-(10**9), le=10**9, description="One of its frames.", examples=[24])]


@router.post(
    "", operation_id="sendRender", status_code=201, dependencies=RENDERS, responses=problems(404, 409, 423, 503)
)
async def send_render(
    service: ServiceDep,
    principal: PrincipalDep,
    request: RenderRequest,
    response: Response,
    idempotency_key: Annotated[
        str | None,
        Header(
            min_length=1,
            max_length=200,
            description="Makes it safe to send a render again: the same key gives the same render.",
            examples=["dailies-2026-11-27"],
        ),
    ] = None,
) -> Render:
    """Send a render: its frames are drawn one after the other, while no one else waits for the service.

    It keeps the edits that the shot has now, and goes on after a restart of the service.
    """
    row = None
    if idempotency_key is not None:
        owner = present_client().principal
        row = await run_in_threadpool(service.renders.sent_before, owner, idempotency_key, _digest(request))
    if row is None:
        record, frames = await _checked(service, principal, request)
        edits = await _edits_of(service, record, request)
        new = _new(record, principal, request, frames, edits, idempotency_key)
        row = await run_in_threadpool(_submit, service, record, new)
        service.renders_wake.set()
        service.products_wake.set()
    response.headers["Location"] = f"/v1/renders/{row.id}"
    return await run_in_threadpool(_told, service, row) if request.after else _shown(row, ())


@router.get("", operation_id="listRenders", responses=problems(404))
async def list_renders(
    service: ServiceDep,
    principal: PrincipalDep,
    most: Annotated[int, Query(ge=1, le=MOST_LISTED, description="Number of renders.", examples=[50])] = 50,
    before: Annotated[
        str | None,
        Query(max_length=80, description="Id of a render: older ones are listed.", examples=["r-5f0c1d2e3a4b"]),
    ] = None,
) -> RenderList:
    """List the renders of your project, the newest first."""
    start = None
    if before is not None:
        last = await run_in_threadpool(render_in_path, before, service, principal)
        start = (last.created_at, last.id)
    project = None if principal.project == ALL_PROJECTS else principal.project
    rows = await run_in_threadpool(service.renders.list, project, most + 1, start)
    needs = await run_in_threadpool(
        service.renders.lookups.unmet_needs, [row.id for row in rows[:most] if row.unended > 0]
    )
    shown = [_shown(row, needs.get(row.id, ())) for row in rows[:most]]
    return RenderList(renders=shown, next=shown[-1].id if len(rows) > most else None)


@router.get("/{render}", operation_id="getRender", responses=problems(404))
def get_render(service: ServiceDep, render: RenderInPath) -> Render:
    """Tell how far a render is."""
    return _told(service, render)


@router.get("/{render}/tasks", operation_id="listRenderTasks", responses=problems(404))
def list_tasks(service: ServiceDep, render: RenderInPath) -> RenderTaskList:
    """List the frames of a render, with the attempts at each."""
    return RenderTaskList(tasks=[_shown_task(task, attempts) for task, attempts in service.renders.tasks(render.id)])


@router.get(
    "/{render}/frames/{frame}",
    operation_id="getRenderedFrame",
    response_class=FileResponse,
    responses=problems(404, 409)
    | {200: {"content": dict.fromkeys(MEDIA_TYPES.values(), BINARY), "description": "The picture."}},
)
def get_rendered_frame(
    service: ServiceDep,
    render: RenderAtHand,
    frame: FrameInPath,
    format: Annotated[
        FrameFormat | None,
        Query(description="One of the render's formats; the first of them when left out.", examples=["png"]),
    ] = None,
) -> FileResponse:
    """Take a frame that a render has drawn."""
    formats = render.request["formats"]
    suffix = format or (formats[0] if formats else "exr")
    if suffix not in formats:
        detail = f"Render {render.id!r} has no {suffix} files, it has {', '.join(formats) or 'none'}."
        raise ServiceError(404, "format_not_rendered", detail, path="format")
    path, headers = file_of(service, render, service.renders.task(render.id, frame), suffix)
    name = f"{plain_file_name(render.name) or 'render'}.{frame:04d}.{suffix}"
    return FileResponse(path, media_type=MEDIA_TYPES[suffix], filename=name, headers=headers)


def file_of(service: Service, render: RenderRow, task: TaskRow, suffix: str) -> tuple[Path, dict[str, str]]:
    """Return a stored file of a frame, and the headers of an answer with it.

    Args:
        service: that has it.
        render: the render.
        task: its frame.
        suffix: of the file.

    Raises:
        ServiceError: 409, the frame is not drawn yet; 404, the file is gone or damaged.
    """
    if task.state != "done":
        detail = f"Frame {task.frame} of render {render.id!r} is not drawn yet: it is {task.state}."
        raise ServiceError(409, "frame_not_done", detail, path="frame")
    entry = task.files.get(suffix)
    if entry is None and suffix == THUMBNAIL:
        detail = (
            f"Frame {task.frame} of render {render.id!r} was drawn by an earlier version, which kept no small pictures."
        )
        raise ServiceError(404, "no_thumbnail", detail, path="frame")
    path = service.render_files.find(render.id, task.frame, task.attempts, suffix, entry)
    if entry is None or path is None:
        raise frame_file_gone(render.id, task.frame)
    return path, {"ETag": f'"{entry["sha256"]}"', "Cache-Control": "private, no-cache"}


@router.post("/{render}/pause", operation_id="pauseRender", dependencies=RENDERS, responses=problems(404, 409))
def pause_render(service: ServiceDep, render: RenderInPath) -> Render:
    """Begin no more frames of a render; those that are drawn are finished."""
    return _told(service, service.renders.pause(render.id))


@router.post("/{render}/resume", operation_id="resumeRender", dependencies=RENDERS, responses=problems(404, 409))
def resume_render(service: ServiceDep, render: RenderInPath) -> Render:
    """Go on with a render that was paused."""
    return _told(service, service.renders.resume(render.id))


@router.post("/{render}/cancel", operation_id="cancelRender", dependencies=RENDERS, responses=problems(404, 409))
def cancel_render(service: ServiceDep, render: RenderInPath) -> Render:
    """End a render. Frames that are stored stay, and what is drawn is given up within a minute."""
    return _told(service, service.renders.cancel(render.id))


@router.post("/{render}/accept", operation_id="acceptRender", dependencies=RENDERS, responses=problems(404, 409))
def accept_render(service: ServiceDep, render: RenderInPath) -> Render:
    """Take a render for done whose other frames have failed or were given up, as they are not wanted any more."""
    return _told(service, service.renders.accept(render.id))


@router.post("/{render}/retry", operation_id="retryRender", dependencies=RENDERS, responses=problems(404, 409))
def retry_render(service: ServiceDep, render: RenderAtHand) -> Render:
    """Draw those frames of a render again that have failed, were given up, or whose files are gone. Of its products those are
    made again that have failed or were given up."""
    lost = service.render_files.lost(render.id, [task for task, _ in service.renders.tasks(render.id)])
    return _told(service, service.renders.retry(render.id, lost))


@router.delete(
    "/{render}", operation_id="removeRender", status_code=204, dependencies=RENDERS, responses=problems(404, 409)
)
def remove_render(service: ServiceDep, render: RenderAtHand) -> None:
    """Remove a render that has ended, and its files."""
    service.renders.remove(render.id, lambda: service.render_files.set_aside(render.id))
    service.render_files.remove(render.id)


async def _checked(service: Service, principal: Principal, request: RenderRequest) -> tuple[ShotRecord, list[int]]:
    """Return the shot of a render, and its frames.

    Raises:
        NotFoundError: there is no such shot, or no render that it waits for, as far as the sender may know.
        SettingsError: the frames are no range, or each is beyond a limit.
    """
    record = shot_to_render(service, principal, request)
    for needed in request.after:
        await run_in_threadpool(render_in_path, needed, service, principal)
    frames = await frames_to_render(service, record, request)
    if request.formats:
        service.admission.check(record.id, request.picture(frames[0]), "body", request.aovs)
    return record, frames


def shot_to_render(service: Service, principal: Principal, request: RenderRequest) -> ShotRecord:
    """Return the shot of a render. Raises `NotFoundError`: there is no such shot, as far as the sender may know."""
    record = service.store.get(request.shot)
    if not principal.sees(record.project):
        raise no_shot(request.shot)
    return record


async def frames_to_render(service: Service, record: ShotRecord, request: RenderRequest) -> list[int]:
    """Return the frames of a render: those that were asked for, or all whole ones of the shot. Raises `SettingsError`."""
    if request.frames is not None:
        return parse_frames(request.frames)
    shot = await service.call_stage(shot_calls.describe_shot, record)
    first, last = shot.frame_range.start, shot.frame_range.end
    return parse_frames(f"{math.ceil(first)}-{math.floor(last)}")


async def _edits_of(service: Service, record: ShotRecord, request: RenderRequest) -> str:
    """Return the edits that a render keeps, with its lens. Raises `CameraError`, `SettingsError`: it cannot be mounted."""
    edits = await run_in_threadpool(record.edit_text)
    if request.lens is None:
        return edits
    return await service.call_reader_at(render_plans.mount_lens, record, edits, request.camera, request.lens)


def _new(
    record: ShotRecord,
    principal: Principal,
    request: RenderRequest,
    frames: list[int],
    edits: str,
    key: str | None,
) -> NewRender:
    return NewRender(
        name=request.name or record.name,
        project=record.project,
        owner=present_client().principal,
        owner_label=principal.label,
        idempotency_key=key,
        digest=_digest(request),
        shot=record.id,
        shot_created_at=record.created_at.isoformat(),
        files=None,
        root=record.root,
        edits=edits,
        revision=revision_of(edits),
        request=request.picture(frames[0]).model_dump(mode="json", exclude={"time", "client", "live", "format"})
        | {"formats": request.formats, "aovs": request.aovs, "lens": request.lens}
        | {"burn_in": _burn_in(record, request, edits)},
        frames=frames,
        priority=request.priority,
        after=request.after,
        products=request.products,
    )


def _burn_in(record: ShotRecord, request: RenderRequest, edits: str) -> dict[str, Any] | None:
    """Return what is burnt into the pictures of a render, as it is kept with it: all of them have one day."""
    if not request.burn_in:
        return None
    day = datetime.now(UTC).date().isoformat()
    return asdict(BurnIn(tuple(request.burn_in), record.name, revision_of(edits), day))


def _submit(service: Service, record: ShotRecord, new: NewRender) -> RenderRow:
    """Add a render to the queue, and its shot to the bucket. Raises the errors of `RenderQueue.submit`, quotas and bucket."""
    service.quotas.check_room(record.project, len(new.edits.encode()))
    if service.shared is not None:
        new = replace(new, files=_archived(service.shared.shots, record))
    return service.renders.submit(new)


def _archived(archive: ShotArchive, record: ShotRecord) -> str:
    """Store a shot in the bucket and return its hash. Raises `NotFoundError`: it was deleted meanwhile."""
    try:
        return archive.store(record.files)
    except FileNotFoundError as error:
        raise no_shot(record.id) from error


def _digest(request: RenderRequest) -> str:
    told = request.model_dump(mode="json")
    told = {name: value for name, value in told.items() if name not in _LATER or value != _LATER[name]}
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def _told(service: Service, row: RenderRow) -> Render:
    """Return a render with what it waits for."""
    needs = service.renders.lookups.unmet_needs([row.id]) if row.unended > 0 else {}
    return _shown(row, needs.get(row.id, ()))


def _shown(row: RenderRow, needs: Sequence[str]) -> Render:
    seconds_left = None
    if row.done > 0 and row.ready + row.running > 0:
        seconds_left = round(row.busy_s / row.done * (row.ready + row.running), 1)
    told = {name: getattr(row, name) for name in Render.model_fields if hasattr(row, name)}
    told |= {name: row.request[name] for name in ("width", "rays", "formats")}
    told |= {"aovs": row.request.get("aovs", []), "lens": row.request.get("lens")}  # an earlier version kept neither
    told["products"] = [
        {"name": name, **{key: entry[key] for key in ("state", "size_bytes", "error")}}
        for name, entry in row.products.items()
    ]
    told["burn_in"] = (row.request.get("burn_in") or {}).get("facts", [])
    told |= {"owner": row.owner_label, "state": state_of(row), "seconds_left": seconds_left, "waits_for": needs}
    told |= {"created_at": _time(row.created_at), "started_at": _time(row.started_at)}
    return Render.model_validate(told | {"finished_at": _time(row.finished_at)})


def _shown_task(task: TaskRow, attempts: Sequence[AttemptRow]) -> RenderTask:
    told: dict[str, Any] = {"frame": task.frame, "state": task.state}
    told["files"] = [
        {"format": suffix, **entry}
        for suffix, entry in task.files.items()
        if task.state == "done" and suffix != THUMBNAIL
    ]
    return RenderTask.model_validate(told | {"attempts": [_shown_attempt(attempt) for attempt in attempts]})


def _shown_attempt(attempt: AttemptRow) -> Attempt:
    told = {name: getattr(attempt, name) for name in ("number", "worker", "outcome")}
    told |= {"started_at": _time(attempt.started_at), "ended_at": _time(attempt.ended_at)}
    return Attempt.model_validate(told | {"error": attempt.error and without_folders(attempt.error)})


def _time(seconds: float | None) -> datetime | None:
    return None if seconds is None else datetime.fromtimestamp(seconds, UTC)
