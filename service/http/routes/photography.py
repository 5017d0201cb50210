"""Routes of exposure, film and grade settings, of their keys, and of the grades to choose from."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Response

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.routes.parameters import CameraQuery, EditContextDep, ShotId, Time, problems, set_etag
from service.http.service import ServiceDep
from service.models.changes import KeySetting, SetExposure, SetFilm, UnkeySetting
from service.models.exposure import ExposureKeyed, ExposureSettings, ExposureSettingsEdit
from service.models.film_settings import FilmKeyed, FilmSettings, FilmSettingsEdit, GradeChoices
from service.models.focus import KeyEdit
from service.stage.calls import photography

router = APIRouter(tags=["cameras"], route_class=BodyRoute, responses=problems(404, 423, 503), dependencies=READS)
EDITED = problems(412)

_KEYED = "The keyed setting, in the unit of its name."
ExposureInPath = Annotated[ExposureKeyed, Path(alias="attribute", description=_KEYED, examples=["compensationStops"])]
FilmInPath = Annotated[FilmKeyed, Path(alias="attribute", description=_KEYED, examples=["push"])]


@router.get("/shots/{shot}/camera/exposure", operation_id="getExposureSettings")
async def get_exposure_settings(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> ExposureSettings:
    """Exposure settings of a camera at one time, and their keys. The `ETag` is the camera's."""
    settings = await service.call_stage(photography.read_exposure_settings, service.store.get(shot), camera, time)
    set_etag(response, settings.etag)
    return settings


@router.patch(
    "/shots/{shot}/camera/exposure", operation_id="editExposureSettings", responses=EDITED, dependencies=EDITS
)
async def edit_exposure_settings(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    edit: ExposureSettingsEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> ExposureSettings:
    """Change exposure settings: for all time, or as keys at `time`."""
    change = SetExposure(values=edit)
    settings = await service.call_stage(
        photography.change_exposure_settings, service.store.get(shot), camera, change, edit.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.put(
    "/shots/{shot}/camera/exposure/keys/{attribute}",
    operation_id="setExposureKey",
    responses=EDITED,
    dependencies=EDITS,
)
async def set_exposure_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: ExposureInPath,
    key: KeyEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> ExposureSettings:
    """Set a key; one at the same time is replaced."""
    change = KeySetting(setting=attribute, key=key)
    settings = await service.call_stage(
        photography.change_exposure_settings, service.store.get(shot), camera, change, key.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.delete(
    "/shots/{shot}/camera/exposure/keys/{attribute}",
    operation_id="deleteExposureKey",
    responses=EDITED,
    dependencies=EDITS,
)
async def delete_exposure_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: ExposureInPath,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> ExposureSettings:
    """Remove the key at `time`; after the last one its value stays for all time."""
    change = UnkeySetting(setting=attribute, time=time)
    settings = await service.call_stage(
        photography.change_exposure_settings, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.get("/shots/{shot}/camera/film", operation_id="getFilmSettings")
async def get_film_settings(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> FilmSettings:
    """Film, sensor and grade of a camera at one time, and their keys. The `ETag` is the camera's."""
    settings = await service.call_stage(photography.read_film_settings, service.store.get(shot), camera, time)
    set_etag(response, settings.etag)
    return settings


@router.patch("/shots/{shot}/camera/film", operation_id="editFilmSettings", responses=EDITED, dependencies=EDITS)
async def edit_film_settings(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    edit: FilmSettingsEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FilmSettings:
    """Change film and grade: for all time, or as keys at `time`. Settings that make no picture are refused."""
    change = SetFilm(values=edit)
    settings = await service.call_stage(
        photography.change_film_settings, service.store.get(shot), camera, change, edit.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.put(
    "/shots/{shot}/camera/film/keys/{attribute}", operation_id="setFilmKey", responses=EDITED, dependencies=EDITS
)
async def set_film_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: FilmInPath,
    key: KeyEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FilmSettings:
    """Set a key; one at the same time is replaced."""
    change = KeySetting(setting=attribute, key=key)
    settings = await service.call_stage(
        photography.change_film_settings, service.store.get(shot), camera, change, key.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.delete(
    "/shots/{shot}/camera/film/keys/{attribute}", operation_id="deleteFilmKey", responses=EDITED, dependencies=EDITS
)
async def delete_film_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: FilmInPath,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FilmSettings:
    """Remove the key at `time`; after the last one its value stays for all time."""
    change = UnkeySetting(setting=attribute, time=time)
    settings = await service.call_stage(
        photography.change_film_settings, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.get("/shots/{shot}/camera/grades", operation_id="listGrades")
async def list_grades(service: ServiceDep, shot: ShotId, time: Time, camera: CameraQuery = None) -> GradeChoices:
    """Displays, views and looks of the OpenColorIO configuration that the camera's picture is graded by."""
    return await service.call_stage(photography.read_grade_choices, service.store.get(shot), camera, time)
