"""Routes of the focus settings of a camera, of its keys, and of racks."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Response

from service.http.access import EDITS, READS
from service.http.bodies import BodyRoute
from service.http.routes.parameters import CameraQuery, EditContextDep, ShotId, Time, problems, set_etag
from service.http.service import ServiceDep
from service.models.changes import KeySetting, MakeRack, SetFocus, UnkeySetting
from service.models.focus import KeyEdit
from service.models.solving import CameraKeyed, FocusSettings, FocusSettingsEdit, Rack, RackCreate
from service.stage.calls import solving

router = APIRouter(tags=["focus"], route_class=BodyRoute, responses=problems(404, 423, 503), dependencies=READS)
EDITED = problems(412)

AttributeInPath = Annotated[
    CameraKeyed, Path(description="The keyed setting, in the unit of its name.", examples=["focusDistanceM"])
]


@router.get("/shots/{shot}/camera/focus", operation_id="getFocusSettings")
async def get_focus_settings(
    service: ServiceDep, response: Response, shot: ShotId, time: Time, camera: CameraQuery = None
) -> FocusSettings:
    """Focus settings of a camera at one time, and the keys of those and of its lens. The `ETag` is the camera's."""
    settings = await service.call_stage(solving.read_focus_settings, service.store.get(shot), camera, time)
    set_etag(response, settings.etag)
    return settings


@router.patch("/shots/{shot}/camera/focus", operation_id="editFocusSettings", responses=EDITED, dependencies=EDITS)
async def edit_focus_settings(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    edit: FocusSettingsEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusSettings:
    """Change focus settings: for all time, or as keys at `time`."""
    change = SetFocus(values=edit)
    settings = await service.call_stage(
        solving.change_focus_settings, service.store.get(shot), camera, change, edit.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.put("/shots/{shot}/camera/keys/{attribute}", operation_id="setCameraKey", responses=EDITED, dependencies=EDITS)
async def set_camera_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: AttributeInPath,
    key: KeyEdit,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusSettings:
    """Set a key; one at the same time is replaced. A key of `focusDistanceM` gives the focus back to the hand."""
    change = KeySetting(setting=attribute, key=key)
    settings = await service.call_stage(
        solving.change_focus_settings, service.store.get(shot), camera, change, key.time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.delete(
    "/shots/{shot}/camera/keys/{attribute}", operation_id="deleteCameraKey", responses=EDITED, dependencies=EDITS
)
async def delete_camera_key(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    attribute: AttributeInPath,
    time: Time,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> FocusSettings:
    """Remove the key at `time`; after the last one its value stays for all time."""
    change = UnkeySetting(setting=attribute, time=time)
    settings = await service.call_stage(
        solving.change_focus_settings, service.store.get(shot), camera, change, time, context
    )
    set_etag(response, settings.etag)
    return settings


@router.post("/shots/{shot}/racks", operation_id="createRack", status_code=201, responses=EDITED, dependencies=EDITS)
async def create_rack(
    service: ServiceDep,
    response: Response,
    shot: ShotId,
    rack: RackCreate,
    context: EditContextDep,
    camera: CameraQuery = None,
) -> Rack:
    """Rack from one focus point to another: keys that let their weights cross, no faster than the ring turns.

    `If-Match` takes the tag of the list of focus points.
    """
    authored = await service.call_stage(
        solving.make_rack, service.store.get(shot), camera, MakeRack(rack=rack), context
    )
    set_etag(response, authored.etag)
    return authored
