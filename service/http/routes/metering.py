"""Routes of exposure readouts and light meter readings."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from service.http.access import READS, RENDERS
from service.http.clients import present_client
from service.http.routes.parameters import CameraQuery, ShotId, Time, problems
from service.http.service import ServiceDep
from service.models.metering import ExposureReadout, MeterQuery, MeterReading
from service.picture.calls import metering
from service.stage.calls import exposure
from service.workers.calls import call

router = APIRouter(tags=["cameras"], responses=problems(404, 423, 503), dependencies=READS)


@router.get("/shots/{shot}/readout/exposure", operation_id="getExposureReadout")
async def get_exposure_readout(
    service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None
) -> ExposureReadout:
    """Compute EV, T-stop, bellows factor and equivalents of a camera's exposure at one time, and the luminance of middle grey."""
    return await service.call_stage(exposure.read_exposure, service.store.get(shot), camera, time)


@router.get("/shots/{shot}/meter", operation_id="meter", responses=problems(409), dependencies=RENDERS)
async def meter(service: ServiceDep, shot: ShotId, query: Annotated[MeterQuery, Query()]) -> MeterReading:
    """Meter the light on a camera at one time: EV, lux, and stops over or under middle grey."""
    record = service.store.get(shot)
    spot = query.point if query.x is None or query.y is None else (query.x, query.y)
    client = present_client()
    group = ("meter", client, query.client, record.id) if query.client else None
    reading = call(metering.meter_light, record, record.edit_text(), query.camera, query.time, query.mode, spot)
    return await service.lanes.live.result(reading, service.place_of(record), client, group=group)
