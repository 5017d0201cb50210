"""Focus points and their keys."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Response

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.links import point_links
from service.http.routes.parameters import (
    AspectQuery,
    CameraQuery,
    EditContextDep,
    PointNameInPath,
    ShotId,
    Time,
    problems,
    set_etag,
)
from service.http.service import ServiceDep
from service.models.changes import AddPoint, AlterPoint, KeyPoint, RemovePoint, UnkeyPoint
from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    KeyedAttribute,
    KeyEdit,
)
from service.stage.calls import focus_points

router = APIRouter(tags=["focus"], route_class=BodyRoute, responses=problems(404, 423, 503), dependencies=READS)
EDITED = problems(412)

AttributeInPath = Annotated[KeyedAttribute, Path(description="The keyed attribute.", examples=["weight"])]


@router.get("/shots/{shot}/focus-points", operation_id="listFocusPoints")
async def list_focus_points(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    time: Time,
    camera: CameraQuery = None,
    aspect: AspectQuery = None,
) -> FocusPointList:
    """The focus points of a camera, and where they are in the picture at one time."""
    points = await service.call_stage(focus_points.list_focus_points, service.store.get(shot), camera, time, aspect)
    set_etag(response, points.etag)
    return points


@router.post(
    "/shots/{shot}/focus-points",
    operation_id="createFocusPoint",
    status_code=201,
    responses=EDITED | point_links(201),
    dependencies=EDITS,
)
async def create_focus_point(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    point: FocusPointCreate,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Place a focus point: send the `anchor` that a pick gave, with the values of the point. `If-Match` takes the list's tag."""
    change = AddPoint(point=point)
    added = await service.call_stage(
        focus_points.add_focus_point, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, added.etag)
    return added


@router.get("/shots/{shot}/focus-points/{name}", operation_id="getFocusPoint")
async def get_focus_point(
    service: ServiceDep, response: Response, shot: ShotId, name: PointNameInPath, time: Time, camera: CameraQuery = None
) -> FocusPoint:
    """One focus point at one time. Its `ETag` is made of what is edited on it."""
    point = await service.call_stage(focus_points.read_focus_point, service.store.get(shot), camera, time, name)
    set_etag(response, point.etag)
    return point


@router.patch("/shots/{shot}/focus-points/{name}", operation_id="editFocusPoint", responses=EDITED, dependencies=EDITS)
async def edit_focus_point(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    name: PointNameInPath,
    edit: FocusPointEdit,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Change a focus point: a value that has keys gets one at `time`, any other is changed for all time."""
    change = AlterPoint(name=name, values=edit, time=time)
    point = await service.call_stage(
        focus_points.change_focus_point, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, point.etag)
    return point


@router.delete(
    "/shots/{shot}/focus-points/{name}",
    operation_id="deleteFocusPoint",
    status_code=204,
    responses=EDITED,
    dependencies=EDITS,
)
async def delete_focus_point(
    service: ServiceDep, shot: ShotId, name: PointNameInPath, context: EditContextDep, camera: CameraQuery = None
) -> None:
    """Remove a focus point and its keys."""
    change = RemovePoint(name=name)
    await service.call_stage(focus_points.remove_focus_point, service.store.get(shot), camera, change, context)


@router.put(
    "/shots/{shot}/focus-points/{name}/keys/{attribute}", operation_id="setKey", responses=EDITED, dependencies=EDITS
)
async def set_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    name: PointNameInPath,
    attribute: AttributeInPath,
    key: KeyEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Set a key; one at the same time is replaced. Answers with the point at the key's time; `If-Match` takes its tag."""
    change = KeyPoint(name=name, attribute=attribute, key=key)
    point = await service.call_stage(
        focus_points.change_focus_point, service.store.get(shot), camera, change, key.time, context
    )
    set_etag(response, point.etag)
    return point


@router.delete(
    "/shots/{shot}/focus-points/{name}/keys/{attribute}", operation_id="deleteKey", responses=EDITED, dependencies=EDITS
)
async def delete_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    name: PointNameInPath,
    attribute: AttributeInPath,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Remove the key at `time`. Answers with the point at that time; `If-Match` takes its tag."""
    change = UnkeyPoint(name=name, attribute=attribute, time=time)
    point = await service.call_stage(
        focus_points.change_focus_point, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, point.etag)
    return point
