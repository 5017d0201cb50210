"""Cameras: read the lens, set it, and read off what it holds sharp."""

from __future__ import annotations

from typing import Annotated, Self

from fastapi import APIRouter, Query, Response
from pydantic import Field, model_validator

from service.http.routes.parameters import CameraQuery, EditContextDep, ShotId, Time, problems, set_etag
from service.http.service import Service, ServiceDep
from service.models.base import Model, PointName, PrimPath, TimeCode
from service.models.cameras import CameraEdit, CameraList, CameraState, PlaceReadout, Readout
from service.models.changes import SetCamera
from service.picture.calls import frames
from service.stage.calls import cameras
from service.storage.store import ShotRecord

router = APIRouter(tags=["cameras"], responses=problems(404, 503, 504))
EDITED = problems(412)


@router.get("/shots/{shot}/cameras", operation_id="listCameras")
async def list_cameras(service: ServiceDep, shot: ShotId, time: Time) -> CameraList:
    """The cameras of a shot at one time, focus points solved in."""
    return await service.call_stage(cameras.list_cameras, service.store.get(shot), time)


@router.get("/shots/{shot}/camera", operation_id="getCamera")
async def get_camera(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> CameraState:
    """One camera at one time, focus points solved in. Its `ETag` is made of what is edited on it, its points aside."""
    state = await service.call_stage(cameras.read_camera, service.store.get(shot), camera, time)
    set_etag(response, state.etag)
    return state


@router.patch("/shots/{shot}/camera", operation_id="editCamera", responses=EDITED)
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


@router.get("/shots/{shot}/readout", operation_id="getReadout")
async def get_readout(service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> Readout:
    """Focus distance, depth of field and hyperfocal distance at one time."""
    return await service.call_stage(cameras.read_lens, service.store.get(shot), camera, time)


class PlaceQuery(Model):
    """Which place of the picture: a focus point's, or one that is pointed at."""

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/Camera"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    point: PointName | None = Field(
        default=None, description="A focus point's name, in place of `x` and `y`.", examples=["driver"]
    )
    x: float | None = Field(
        default=None, ge=0, le=1, description="From the picture's left edge (0) to its right one (1).", examples=[0.43]
    )
    y: float | None = Field(
        default=None, ge=0, le=1, description="From the picture's top edge (0) to its bottom one (1).", examples=[0.55]
    )
    depth_m: float | None = Field(
        default=None,
        gt=0,
        le=1e9,
        description="Depth of a thing at that place, along the view axis; left out, that of what is seen there.",
        examples=[3.42],
    )
    aspect: float | None = Field(
        default=None,
        ge=0.01,
        le=100,
        description="Width over height of the picture; the film gate's when left out.",
        examples=[1.7778],
    )

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        pointed_at = self.x is not None and self.y is not None
        if (self.point is None) != pointed_at or (self.point is not None and self.depth_m is not None):
            raise ValueError("a place is a focus point's name, or x and y, and with these a depth if need be")
        return self


@router.get("/shots/{shot}/readout/place", operation_id="getPlaceReadout")
async def get_place_readout(service: ServiceDep, shot: ShotId, query: Annotated[PlaceQuery, Query()]) -> PlaceReadout:
    """Depth of field at a focus point or at a place of the picture, and the circle of confusion of the surface there."""
    record = service.store.get(shot)
    place = query.point or await _pointed_at(service, record, query)
    return await service.call_stage(cameras.read_place, record, query.camera, query.time, place, query.aspect)


async def _pointed_at(service: Service, record: ShotRecord, query: PlaceQuery) -> tuple[tuple[float, float], float]:
    assert query.x is not None
    assert query.y is not None
    screen, depth_m = (query.x, query.y), query.depth_m
    if depth_m is None:
        depth_m = await service.call_picture(
            frames.measure_depth, record, record.edit_text(), query.camera, query.time, screen, query.aspect
        )
    return screen, depth_m
