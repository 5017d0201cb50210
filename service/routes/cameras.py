"""Cameras: read the lens, set it, and read off what it holds sharp."""

from __future__ import annotations

from fastapi import APIRouter

from service.hub import HubDep
from service.models.cameras import CameraEdit, CameraList, CameraState, Readout
from service.routes.parameters import CameraQuery, ShotId, Time, problems
from service.stage_work import EditCamera, ListCameras, ReadLens

router = APIRouter(tags=["cameras"], responses=problems(404, 503, 504))


@router.get("/shots/{shot}/cameras", operation_id="listCameras")
async def list_cameras(hub: HubDep, shot: ShotId, time: Time) -> CameraList:
    """The cameras of a shot at one time, focus points solved in."""
    return await hub.ask_stage(ListCameras(hub.store.get(shot), time))


@router.patch("/shots/{shot}/camera", operation_id="editCamera")
async def edit_camera(hub: HubDep, shot: ShotId, edit: CameraEdit, camera: CameraQuery = None) -> CameraState:
    """Set f-number, focal length or focus distance: for all time, or as a key at `time`."""
    return await hub.ask_stage(EditCamera(hub.store.get(shot), camera, edit))


@router.get("/shots/{shot}/readout", operation_id="getReadout")
async def get_readout(hub: HubDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> Readout:
    """Focus distance, depth of field and hyperfocal distance at one time."""
    return await hub.ask_stage(ReadLens(hub.store.get(shot), camera, time))
