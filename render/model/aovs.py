"""AOVs: what can be measured beside the colour of a picture. Each is declared here once: its name, channels and meaning.

Names in camel case, ``normal`` and ``primvars:NAME`` are Hydra's, with Hydra's meaning: scene units, USD's camera space (+X
right, +Y up, looking along -Z), ids that are -1 where nothing is, and 0 where nothing is for the others. ``depth`` is the
exception: it is linear and in metres, where Hydra's is a position between the clipping planes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from render.errors import SettingsError
from render.model.mattes import MATERIAL, OBJECT, RANKS

Kind = Literal["float", "half", "uint"]
_MATTE_LAYERS = RANKS // 2


@dataclass(frozen=True)
class Aov:
    """Declaration of an AOV.

    Attributes:
        name: value of ``--aov``, and the name of the file's part.
        channels: channels in a file.
        kind: type of the file's samples; a negative id becomes 4294967295.
        help: meaning, for people.
        is_color: whether it is a colour in the working space.
    """

    name: str
    channels: tuple[str, ...]
    kind: Kind
    help: str
    is_color: bool = False


def _matte(name: str, of: str) -> Aov:
    """Matte: two ranks to a layer of four channels, id and coverage of each."""
    channels = tuple(f"{name}{layer:02}.{channel}" for layer in range(_MATTE_LAYERS) for channel in "RGBA")
    return Aov(name, channels, "float", f"Cryptomatte of {of}, through the lens")


_XYZ = ("X", "Y", "Z")
PRIMVAR_PREFIX = "primvars:"
PRIMVAR_CHANNELS = ("R", "G", "B", "A")
"""Channels of a primvar's AOV, of which one with fewer numbers has the first."""
AOVS = (
    Aov("depth", ("Z",), "float", "metres along the view axis; infinite where nothing is"),
    Aov("coc", ("radius",), "float", "radius of the circle of confusion in pixels; negative in front of the focus"),
    Aov("defocus", ("w",), "float", "inverse depth less that in focus, 1/m; negative behind the focus"),
    Aov("focus_depth", ("Z",), "float", "metres along the view axis at which the pixel is sharpest"),
    Aov("albedo", ("R", "G", "B"), "half", "base colour through the lens, as blurred as the picture", is_color=True),
    Aov("prim_id", ("id",), "uint", "index of the prim plus one; 0 where nothing is"),
    Aov("face_id", ("id",), "uint", "index of the authored face; -1 where nothing is"),
    Aov("cameraDepth", ("Z",), "float", "scene units along the view axis, positive; 0 where nothing is"),
    Aov("normal", _XYZ, "float", "unit normal in the stage's world space, facing the camera; 0 where nothing is"),
    Aov("Neye", _XYZ, "float", "unit normal in camera space; 0 where nothing is"),
    Aov("Peye", _XYZ, "float", "position in camera space, scene units; 0 where nothing is"),
    Aov("primId", ("id",), "uint", "index of the prim; -1 where nothing is"),
    Aov("instanceId", ("id",), "uint", "id of a PointInstancer's instance, its index without ids; -1 elsewhere"),
    Aov("elementId", ("id",), "uint", "index of the authored face; -1 where nothing is"),
    _matte(OBJECT, "prims"),
    _matte(MATERIAL, "bound materials"),
)
AOV_NAMES = ("color", *(aov.name for aov in AOVS), f"{PRIMVAR_PREFIX}NAME")
"""Names for help texts, ``color`` first."""
_BY_NAME = {aov.name: aov for aov in AOVS}


def check_aov(name: str) -> None:
    """Raise `SettingsError` unless there is an AOV of this name."""
    if name != "color" and name not in _BY_NAME and not primvar_of(name):
        raise SettingsError(f"aov must be one of {', '.join(AOV_NAMES)}, got {name!r}")


def primvar_of(aov: str) -> str:
    """Return the name of the primvar that an AOV holds, empty for other AOVs."""
    return aov.removeprefix(PRIMVAR_PREFIX) if aov.startswith(PRIMVAR_PREFIX) else ""


def file_order(names: Sequence[str]) -> list[str]:
    """Sort names of AOVs as the parts of a file are sorted: those declared, then primvars by name; ``color`` is left out."""
    primvars = sorted(name for name in set(names) if primvar_of(name))
    return [aov.name for aov in AOVS if aov.name in names] + primvars


def find_aov(name: str, numbers: int) -> Aov:
    """Return the declaration of an AOV.

    Args:
        name: its name; not ``color``.
        numbers: per pixel, for a primvar: 1 to 4.

    Raises:
        SettingsError: there is none of that name.
    """
    check_aov(name)
    if primvar := primvar_of(name):
        return Aov(name, PRIMVAR_CHANNELS[:numbers], "float", f"primvar {primvar}")
    return _BY_NAME[name]
