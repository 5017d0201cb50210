"""Route that tries renders: it tells the frames and settings of one, what it costs, and what stands against it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool

from render.errors import NotFoundError, PullfocusError, SettingsError
from render.model.edit_history import revision_of
from service.http.access import RENDERS, PrincipalDep
from service.http.bodies import BodyRoute
from service.http.errors import ServiceError
from service.http.routes.parameters import problems
from service.http.routes.renders import frames_to_render, render_in_path, shot_to_render
from service.http.service import Service, ServiceDep
from service.identity.principal import Principal
from service.jobs.frame_ranges import format_frames
from service.models.render_plans import PlanFinding, PlannedSettings, RenderPlan
from service.models.renders import RenderRequest
from service.models.shots import FrameRange
from service.stage.calls import render_plans
from service.storage.store import ShotRecord

router = APIRouter(tags=["renders"], prefix="/render-plans", route_class=BodyRoute, dependencies=RENDERS)


@router.post("", operation_id="planRender", responses=problems(404, 423, 503))
async def plan_render(service: ServiceDep, principal: PrincipalDep, request: RenderRequest) -> RenderPlan:
    """Try a render and send nothing.

    The answer has its frames, the settings of the first one, the processor time that is expected, and findings: what it would be
    refused for, and what of the shot is not honoured. A body that is no `RenderRequest` is answered 422, as by `sendRender`.
    """
    record = shot_to_render(service, principal, request)
    edits = await run_in_threadpool(record.edit_text)
    findings = await run_in_threadpool(_refusals, service, principal, record, len(edits.encode()), request)
    frames, frame_s = list[int](), 0.0
    try:
        frames = await frames_to_render(service, record, request)
        if request.formats:
            frame_s = service.admission.check(
                record.id, request.picture(frames[0]), "body", request.aovs
            ).cost.expected_s
    except SettingsError as error:
        findings.append(_error(error, "frames" if request.frames is not None and not frames else ""))
    settings = None
    if frame_s or (frames and not request.formats):
        first = request.picture(frames[0])
        planned = await service.call_reader_at(render_plans.plan_picture, record, edits, first, request.lens)
        findings += [*planned.findings, *_outside(planned.frame_range, frames)]
        if planned.picture is not None:
            asked = request.model_dump(include={"engine", "rays", "formats", "aovs"})
            settings = PlannedSettings(**planned.picture.model_dump(), **asked, revision=revision_of(edits))
    return RenderPlan(
        frames=format_frames(frames) if frames else "",
        count=len(frames) if request.formats else 0,
        seconds_of_processor=round(frame_s * len(frames), 1),
        settings=settings,
        findings=sorted(findings, key=lambda one: one.severity != "error"),
    )


def _refusals(
    service: Service, principal: Principal, record: ShotRecord, edit_bytes: int, request: RenderRequest
) -> list[PlanFinding]:
    """Return what a render would be refused for, whatever its frames are."""
    found = []
    for needed in request.after:
        try:
            render_in_path(needed, service, principal)
        except NotFoundError as error:
            found.append(_error(error, "after"))
    try:
        service.quotas.check_room(record.project, edit_bytes)
    except ServiceError as error:
        found.append(_error(error, ""))
    return found


def _error(error: PullfocusError | ServiceError, path: str) -> PlanFinding:
    """Return an error as a finding about a field of the request; empty for the request as a whole."""
    return PlanFinding(severity="error", code=error.code, path=path, message=error.detail)


def _outside(whole: FrameRange, frames: Sequence[int]) -> Iterator[PlanFinding]:
    """Yield whether frames are outside the frame range of the shot."""
    outside = [frame for frame in frames if not whole.start <= frame <= whole.end]
    if outside:
        told = f"Frame {outside[0]} is" if len(outside) == 1 else f"Frames {format_frames(outside)} are"
        message = (
            f"{told} outside the shot, which is {whole.start:g} to {whole.end:g}: its first and last values hold there."
        )
        yield PlanFinding(severity="warning", code="frames_outside_shot", path="frames", message=message)
