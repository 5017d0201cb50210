"""Cameras: read the lens, set it, and read off what it holds sharp."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.routes.parameters import CameraQuery, EditContextDep, ShotId, Time, problems, set_etag
from service.http.service import Service, ServiceDep
from service.models.cameras import CameraEdit, CameraList, CameraPlace, CameraState, PlaceQuery, PlaceReadout, Readout
from service.models.changes import SetCamera
from service.models.top_view import Paths, TopView
from service.picture.calls import frames
from service.stage.calls import cameras, top_view
from service.storage.store import ShotRecord

router = APIRouter(tags=["cameras"], route_class=BodyRoute, responses=problems(404, 423, 503), dependencies=READS)
EDITED = problems(412)


@router.get("/shots/{shot}/cameras", operation_id="listCameras")
async def list_cameras(service: ServiceDep, shot: ShotId, time: Time) -> CameraList:
    """The cameras of a shot at one time, focus points solved in."""
    return await service.call_stage(cameras.list_cameras, service.store.get(shot), time)


@router.get("/shots/{shot}/camera", operation_id="getCamera")
async def get_camera(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> CameraState:
    """Read one camera at one time, with its focus solved. Its `ETag` is a hash of the camera's edits, its focus points aside."""
    state = await service.call_stage(cameras.read_camera, service.store.get(shot), camera, time)
    set_etag(response, state.etag)
    return state


@router.patch("/shots/{shot}/camera", operation_id="editCamera", responses=EDITED, dependencies=EDITS)
async def edit_camera(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    edit: CameraEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> CameraState:
    """Set f-number, focal length or focus distance: for all time, or as a key at `time`."""
    change = SetCamera(values=edit)
    state = await service.call_stage(cameras.change_camera, service.store.get(shot), camera, change, edit.time, context)
    set_etag(response, state.etag)
    return state


@router.get("/shots/{shot}/camera/place", operation_id="getCameraPlace")
async def get_camera_place(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> CameraPlace:
    """Read where a camera is in the world at one time, and the keys of its place. The `ETag` is the camera's."""
    place = await service.call_stage(cameras.read_camera_place, service.store.get(shot), camera, time)
    set_etag(response, place.etag)
    return place


@router.get("/shots/{shot}/readout", operation_id="getReadout")
async def get_readout(service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> Readout:
    """Compute focus distance, depth of field and hyperfocal distance at one time."""
    return await service.call_stage(cameras.read_lens, service.store.get(shot), camera, time)


@router.get("/shots/{shot}/readout/place", operation_id="getPlaceReadout")
async def get_place_readout(service: ServiceDep, shot: ShotId, query: Annotated[PlaceQuery, Query()]) -> PlaceReadout:
    """Compute depth of field and circle of confusion at a focus point or at a point of the picture."""
    record = service.store.get(shot)
    place = query.point or await _measure(service, record, query)
    return await service.call_stage(cameras.read_place, record, query.camera, query.time, place, query.aspect)


@router.get("/shots/{shot}/top-view", operation_id="getTopView")
async def get_top_view(service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> TopView:
    """The camera from above at one time: where it is, how it is turned, and a level cut through what it holds sharp."""
    return await service.call_stage(top_view.read_top_view, service.store.get(shot), camera, time)


@router.get("/shots/{shot}/paths", operation_id="getPaths")
async def get_paths(service: ServiceDep, shot: ShotId, camera: CameraQuery = None) -> Paths:
    """The places of a camera and its focus points over the shot, frame by frame; 481 times at most, fewer for many points."""
    return await service.call_reader(top_view.read_paths, service.store.get(shot), camera)


async def _measure(service: Service, record: ShotRecord, query: PlaceQuery) -> tuple[tuple[float, float], float]:
    assert query.x is not None
    assert query.y is not None
    screen, depth_m = (query.x, query.y), query.depth_m
    if depth_m is None:
        depth_m = await service.call_picture(
            frames.measure_depth, record, record.edit_text(), query.camera, query.time, screen, query.aspect
        )
    return screen, depth_m
