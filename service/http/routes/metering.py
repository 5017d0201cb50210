"""What an exposure is worth, and what a light meter says."""

from __future__ import annotations

from typing import Annotated, Self

from fastapi import APIRouter, Query
from pydantic import Field, model_validator

from service.http.routes.parameters import CameraQuery, ShotId, Time, problems
from service.http.service import ServiceDep
from service.models.base import Model, PointName, PrimPath, TimeCode
from service.models.metering import ExposureReadout, MeterMode, MeterReading
from service.picture.calls import metering
from service.stage.calls import exposure
from service.workers.calls import call

router = APIRouter(tags=["cameras"], responses=problems(404, 503, 504))


class MeterQuery(Model):
    """What a light meter looks at."""

    camera: PrimPath | None = Field(
        default=None, description="Prim path; the shot's default camera when left out.", examples=["/World/Camera"]
    )
    time: TimeCode = Field(description="USD time code.", examples=[24])
    mode: MeterMode | None = Field(
        default=None,
        description="Left out: what the camera's meter looks at, or the middle most where it has none.",
        examples=["center"],
    )
    point: PointName | None = Field(default=None, description="Meters a spot on a focus point.", examples=["driver"])
    x: float | None = Field(
        default=None,
        ge=0,
        le=1,
        description="With `y`, meters a spot: from the picture's left edge (0).",
        examples=[0.43],
    )
    y: float | None = Field(default=None, ge=0, le=1, description="From the picture's top edge (0).", examples=[0.55])
    client: str | None = Field(
        default=None,
        max_length=64,
        description="Names one viewer, whose newer request to meter the same shot takes the place of those that still wait.",
        examples=["viewer-1"],
    )

    @model_validator(mode="after")
    def _one_spot(self) -> Self:
        if (self.x is None) != (self.y is None) or (self.point is not None and self.x is not None):
            raise ValueError("a spot is a focus point's name, or x and y")
        if self.mode not in (None, "spot") and (self.point is not None or self.x is not None):
            raise ValueError(f"a spot is metered, and not by the mode {self.mode}")
        return self


@router.get("/shots/{shot}/readout/exposure", operation_id="getExposureReadout")
async def get_exposure_readout(
    service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None
) -> ExposureReadout:
    """EV, T-stop, bellows factor and equivalents of a camera's exposure at one time, and the light that it is right for."""
    return await service.call_stage(exposure.read_exposure, service.store.get(shot), camera, time)


@router.get("/shots/{shot}/meter", operation_id="meter", responses=problems(409))
async def meter(service: ServiceDep, shot: ShotId, query: Annotated[MeterQuery, Query()]) -> MeterReading:
    """What a light meter on the camera says at one time: EV, lux, and stops over or under."""
    record = service.store.get(shot)
    spot = query.point if query.x is None or query.y is None else (query.x, query.y)
    group = ("meter", query.client, record.id) if query.client else None
    reading = call(metering.meter_light, record, record.edit_text(), query.camera, query.time, query.mode, spot)
    return await service.picture_queue.result(reading, group)
