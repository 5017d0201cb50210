"""Focus points and their keys."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from service.hub import HubDep
from service.models.focus import (
    FocusPoint,
    FocusPointCreate,
    FocusPointEdit,
    FocusPointList,
    KeyedAttribute,
    KeyEdit,
)
from service.routes.parameters import CameraQuery, PointNameInPath, ShotId, Time, problems
from service.stage_work import (
    AddFocusPoint,
    EditFocusPoint,
    ListFocusPoints,
    ReadFocusPoint,
    RemoveFocusPoint,
    RemoveKey,
    SetKey,
)

router = APIRouter(tags=["focus"], responses=problems(404, 503, 504))

AttributeInPath = Annotated[KeyedAttribute, Path(description="What the key is of.", examples=["weight"])]
AspectQuery = Annotated[
    float | None,
    Query(
        gt=0,
        allow_inf_nan=False,
        description="Width over height of the picture; the film gate's when left out.",
        examples=[1.7778],
    ),
]


@router.get("/shots/{shot}/focus-points", operation_id="listFocusPoints")
async def list_focus_points(
    hub: HubDep, shot: ShotId, time: Time, camera: CameraQuery = None, aspect: AspectQuery = None
) -> FocusPointList:
    """The focus points of a camera, and where they are in the picture at one time."""
    return await hub.ask_stage(ListFocusPoints(hub.store.get(shot), camera, time, aspect))


@router.post("/shots/{shot}/focus-points", operation_id="createFocusPoint", status_code=201)
async def create_focus_point(
    hub: HubDep, shot: ShotId, point: FocusPointCreate, time: Time, camera: CameraQuery = None
) -> FocusPoint:
    """Place a focus point: send the `anchor` that a pick gave, with what is wanted there."""
    return await hub.ask_stage(AddFocusPoint(hub.store.get(shot), camera, time, point))


@router.get("/shots/{shot}/focus-points/{name}", operation_id="getFocusPoint")
async def get_focus_point(
    hub: HubDep, shot: ShotId, name: PointNameInPath, time: Time, camera: CameraQuery = None
) -> FocusPoint:
    """One focus point at one time."""
    return await hub.ask_stage(ReadFocusPoint(hub.store.get(shot), camera, time, name))


@router.patch("/shots/{shot}/focus-points/{name}", operation_id="editFocusPoint")
async def edit_focus_point(
    hub: HubDep, shot: ShotId, name: PointNameInPath, edit: FocusPointEdit, time: Time, camera: CameraQuery = None
) -> FocusPoint:
    """Change a focus point: a value that has keys gets one at `time`, any other is changed for all time."""
    return await hub.ask_stage(EditFocusPoint(hub.store.get(shot), camera, time, name, edit))


@router.delete("/shots/{shot}/focus-points/{name}", operation_id="deleteFocusPoint", status_code=204)
async def delete_focus_point(hub: HubDep, shot: ShotId, name: PointNameInPath, camera: CameraQuery = None) -> None:
    """Remove a focus point and its keys."""
    await hub.ask_stage(RemoveFocusPoint(hub.store.get(shot), camera, name))


@router.put("/shots/{shot}/focus-points/{name}/keys/{attribute}", operation_id="setKey")
async def set_key(
    hub: HubDep,
    shot: ShotId,
    name: PointNameInPath,
    attribute: AttributeInPath,
    key: KeyEdit,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Set a key; one at the same time is replaced. Answers with the point at the key's time."""
    return await hub.ask_stage(SetKey(hub.store.get(shot), camera, name, attribute, key))


@router.delete("/shots/{shot}/focus-points/{name}/keys/{attribute}", operation_id="deleteKey")
async def delete_key(
    hub: HubDep,
    shot: ShotId,
    name: PointNameInPath,
    attribute: AttributeInPath,
    time: Time,
    camera: CameraQuery = None,
) -> FocusPoint:
    """Remove the key at `time`. Answers with the point at that time."""
    return await hub.ask_stage(RemoveKey(hub.store.get(shot), camera, name, attribute, time))
