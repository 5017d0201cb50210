"""State of a picture: what the camera and the edits contribute to it, as a digest.

Two pictures of one shot, at one time and with equal settings, are the same where their states are. Most edits change the focus of
some frames only, so that the pictures of all other frames stay of use.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from pxr import Sdf, Usd

from render.errors import CameraError, PullfocusError
from render.model.content import digest_of
from render.shot.shot import Shot
from render.stage.notes import NOTES

_SIZE_PX = (1920, 1080)
"""Picture that cameras are fitted to: what changes the gate changes its state, whatever the shape of the picture."""
_SOLVED = "focus"
"""Beginning of the names of attributes that act through the focus alone: settings of the solver, and focus points."""
_LABEL = re.compile(r"focusPoint:\w+:(color|group)")
"""Names of attributes that no picture depends on."""


def picture_states(shot: Shot, camera_path: str | None, times: Sequence[float]) -> list[str | None]:
    """Digest what the pictures of a camera depend on, apart from the shot's files: its lens, exposure, film and solved focus, and
    the edits of anything else.

    A picture that a light meter exposes depends on all edits, as the meter looks at the frames around it too. Pictures without
    motion blur are meant: others see the camera at other moments.

    Args:
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        times: USD time codes.

    Returns:
        A digest for each time; None where the camera makes no picture.

    Raises:
        CameraError: there is no such camera.
    """
    path = camera_path or shot.default_camera().path or ""
    if camera_path is not None and camera_path not in shot.cameras():
        known = ", ".join(shot.cameras()) or "none"
        raise CameraError(f"there is no camera at {camera_path!r}, the cameras are: {known}", path=camera_path)
    layer = shot.edits.layer
    elsewhere, everywhere = digest_of(_edits_elsewhere(layer, path)), digest_of(_text_of(layer))
    return [_state_at(shot, path, time, elsewhere, everywhere) for time in times]


def _state_at(shot: Shot, path: str, time: float, elsewhere: str, everywhere: str) -> str | None:
    try:
        camera = shot.camera_at(path or None, time, *_SIZE_PX)
        finish = shot.film.finish(camera, time)
        is_metered = camera.path and shot.exposure.metering(camera.path, time).mode != "manual"
    except PullfocusError:
        return None
    if camera.shutter_close < camera.shutter_open:
        return None
    own = _own_values(shot.stage.GetPrimAtPath(path), time) if path else []
    return digest_of((camera, finish, own, everywhere if is_metered else elsewhere))


def _own_values(prim: Usd.Prim, time: float) -> list[tuple[str, str]]:
    """List the authored values of a camera prim that act otherwise than through the focus."""
    return [
        (attribute.GetName(), repr(attribute.Get(time)))
        for attribute in prim.GetAuthoredAttributes()
        if not attribute.GetName().startswith(_SOLVED)
    ]


def _edits_elsewhere(layer: Sdf.Layer, path: str) -> str:
    """Text of the edits without what a camera prim itself has: its properties and its applied schemas."""
    rest = Sdf.Layer.CreateAnonymous(".usda")
    rest.TransferContent(layer)
    camera = rest.GetPrimAtPath(path) if path else None
    if camera is not None:
        for one in list(camera.properties):
            camera.RemoveProperty(one)
        camera.ClearInfo("apiSchemas")
    rest.RemoveInertSceneDescription()
    return _text_of(rest)


def _text_of(layer: Sdf.Layer) -> str:
    """Text of a layer without what it says of itself, without notes, and without what only tells focus points from each other."""
    copy = Sdf.Layer.CreateAnonymous(".usda")
    copy.TransferContent(layer)
    copy.documentation = copy.comment = ""
    copy.customLayerData = {}
    labels: list[Sdf.Path] = []
    copy.Traverse(Sdf.Path.absoluteRootPath, lambda path: labels.append(path) if _LABEL.fullmatch(path.name) else None)
    for label in labels:
        prim = copy.GetPrimAtPath(label.GetPrimPath())
        prim.RemoveProperty(prim.properties[label.name])
    if NOTES.name in copy.rootPrims:
        del copy.rootPrims[NOTES.name]
    copy.RemoveInertSceneDescription()
    text: str = copy.ExportToString()
    return text
