"""Cameras: read the lens, set it, and read off what it holds sharp."""

from __future__ import annotations

from fastapi import APIRouter, Response

from service.camera_work import EditCamera, ListCameras, ReadCamera, ReadLens
from service.hub import HubDep
from service.models.cameras import CameraEdit, CameraList, CameraState, Readout
from service.routes.parameters import CameraQuery, ShotId, TermsDep, Time, problems, tagged

router = APIRouter(tags=["cameras"], responses=problems(404, 503, 504))
EDITED = problems(412)


@router.get("/shots/{shot}/cameras", operation_id="listCameras")
async def list_cameras(hub: HubDep, shot: ShotId, time: Time) -> CameraList:
    """The cameras of a shot at one time, focus points solved in."""
    return await hub.ask_stage(ListCameras(hub.store.get(shot), time))


@router.get("/shots/{shot}/camera", operation_id="getCamera")
async def get_camera(
    hub: HubDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> CameraState:
    """One camera at one time, focus points solved in. Its `ETag` is made of what is edited on it, its points aside."""
    state = await hub.ask_stage(ReadCamera(hub.store.get(shot), camera, time))
    tagged(response, state.etag)
    return state


@router.patch("/shots/{shot}/camera", operation_id="editCamera", responses=EDITED)
async def edit_camera(
    hub: HubDep, response: Response, shot: ShotId, edit: CameraEdit, terms: TermsDep, camera: CameraQuery = None
) -> CameraState:
    """Set f-number, focal length or focus distance: for all time, or as a key at `time`."""
    state = await hub.ask_stage(EditCamera(hub.store.get(shot), camera, edit, terms))
    tagged(response, state.etag)
    return state


@router.get("/shots/{shot}/readout", operation_id="getReadout")
async def get_readout(hub: HubDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> Readout:
    """Focus distance, depth of field and hyperfocal distance at one time."""
    return await hub.ask_stage(ReadLens(hub.store.get(shot), camera, time))
