"""State of a picture: what the camera and the edits contribute to it, as a digest.

Two pictures of one shot, at one time and with equal settings, are the same where their states are. Most edits change the focus of
some frames only, so that the pictures of all other frames stay of use.
"""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Sdf, Usd

from render.errors import PullfocusError
from render.model.content import digest_of
from render.shot.shot import Shot

_SIZE_PX = (1920, 1080)
"""Picture that cameras are fitted to: what changes the gate changes its state, whatever the shape of the picture."""
_SOLVED = "focus"
"""Beginning of the names of attributes that act through the focus alone: settings of the solver, and focus points."""


def picture_states(shot: Shot, camera_path: str | None, times: Sequence[float]) -> list[str | None]:
    """Digest what the pictures of a camera depend on, apart from the shot's files: its lens, exposure, film and solved focus, and
    the edits of anything else.

    Pictures without motion blur are meant: those with it see the camera at other times too.

    Args:
        shot: the shot.
        camera_path: prim path; None for the shot's default camera.
        times: USD time codes.

    Returns:
        A digest for each time; None where no picture can be made.
    """
    path = camera_path or shot.default_camera().path or ""
    elsewhere = digest_of(_edits_elsewhere(shot.edits.layer, path))
    return [_state_at(shot, path, time, elsewhere) for time in times]


def _state_at(shot: Shot, path: str, time: float, elsewhere: str) -> str | None:
    try:
        camera = shot.camera_at(path or None, time, *_SIZE_PX)
        finish = shot.film.finish(camera, time)
    except PullfocusError:
        return None
    own = _own_values(shot.stage.GetPrimAtPath(path), time) if path else []
    return digest_of((camera, finish, own, elsewhere))


def _own_values(prim: Usd.Prim, time: float) -> list[tuple[str, str]]:
    """List the authored values of a camera prim that act otherwise than through the focus, such as those of its light meter."""
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
    rest.documentation = rest.comment = ""
    rest.customLayerData = {}
    text: str = rest.ExportToString()
    return text
