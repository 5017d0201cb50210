"""Looks of stand-ins (`render.stage.geometry.stand_ins`): ``model:drawModeColor``, and the textures of cards."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render import colour
from render.errors import InputError
from render.model.scene import Material, TextureLookup
from render.stage.findings import FindingLog
from render.stage.geometry.shape import PrimvarNames
from render.stage.geometry.stand_ins import COLOR, TEXTURES, Card, StandIn
from render.stage.materials.image_files import TextureError
from render.stage.materials.material import BoundMaterial
from render.stage.materials.shading import finite_numbers
from render.stage.materials.textures import TextureCache
from render.stage.values import format_value

_SIDES = tuple(TEXTURES)
_GEOMETRIES = ("cross", "box", "fromTexture")
_CUT_OUT = 0.1  # UsdImaging's
_COLOR = (0.18, 0.18, 0.18)
_MATRICES = ("worldtoscreen", "worldToNDC")
"""Names of the matrix in a texture's header; the second is what OpenImageIO before 2.2 wrote for the first."""


def is_stand_in(path: str) -> bool:
    """Whether the path of a look is that of an attribute of a stand-in rather than a material's."""
    return "." in path


def stand_in_look(
    stage: Usd.Stage, path: str, time: Usd.TimeCode, textures: TextureCache, log: FindingLog
) -> BoundMaterial:
    """The look that an attribute gives a stand-in.

    Args:
        stage: the stage.
        path: path of the attribute.
        time: when.
        textures: reads image files.
        log: for findings.
    """
    place = Sdf.Path(path)
    prim = stage.GetPrimAtPath(place.GetPrimPath())
    plain = Material(name=path, base_color=_color(prim, log))
    attribute = prim.GetAttribute(place.name)
    asset = attribute.Get(time) if place.name in TEXTURES.values() else None
    if not isinstance(asset, Sdf.AssetPath):
        return BoundMaterial(plain, PrimvarNames(uv=None))
    varies = bool(attribute.ValueMightBeTimeVarying())
    try:
        image = textures.image(str(asset.resolvedPath), "auto")
    except (TextureError, InputError) as problem:
        log.add("texture_unreadable", path, f"texture {asset.path} {problem}; the draw mode's colour is used for it")
        return BoundMaterial(plain, PrimvarNames(uv=None), varies)
    color = TextureLookup(image, wrap_s="clamp", wrap_t="clamp")
    opacity = TextureLookup(image, wrap_s="clamp", wrap_t="clamp", channel=3)
    lookups = {"base_color": color, "opacity": opacity} if image.channels in (2, 4) else {"base_color": color}
    material = Material(name=path, opacity_threshold=_CUT_OUT if "opacity" in lookups else 0.0, lookups=lookups)
    return BoundMaterial(material, PrimvarNames(), varies)


def read_stand_in(prim: Usd.Prim, mode: str, textures: TextureCache, log: FindingLog) -> StandIn:
    """The stand-in of a model.

    Args:
        prim: the model.
        mode: one of `render.stage.geometry.stand_ins.MODES`.
        textures: reads image files.
        log: notes what cannot be used.
    """
    if mode != "cards":
        return StandIn(mode)
    geometry = _token(prim, "model:cardGeometry", "cross")
    if geometry not in _GEOMETRIES:
        path = prim.GetPath()
        log.add(
            "draw_mode", path, f"model:cardGeometry of {path} must be one of {', '.join(_GEOMETRIES)}, got {geometry}"
        )
        geometry = "cross"
    textured = {side: asset for side in TEXTURES if (asset := _asset(prim, side)) is not None}
    cards = list(_placed(prim, textured, textures, log) if geometry == "fromTexture" else _standing(textured))
    if _is_simple(prim):
        up = str(UsdGeom.GetStageUpAxis(prim.GetStage()))
        cards = [card for card in cards if not card.side.startswith(up)]
    if not cards:
        path = prim.GetPath()
        log.add("draw_mode", path, f"{path} is not drawn: its draw mode is cards, and no card is left")
    return StandIn(mode, tuple(cards), crossed=geometry == "cross")


def _standing(textured: Container[str]) -> Iterator[Card]:
    """Cards of axes with a texture; all of them, without one, where there is none."""
    for number, side in enumerate(_SIDES):
        other = _SIDES[(number + 3) % 6]
        if side in textured:
            yield Card(side, TEXTURES[side])
        elif other in textured:
            yield Card(side, TEXTURES[other], flipped=True)
        elif not textured:
            yield Card(side, COLOR)


def _placed(
    prim: Usd.Prim, textured: Mapping[str, Sdf.AssetPath], textures: TextureCache, log: FindingLog
) -> Iterator[Card]:
    """Cards that stand where their textures say."""
    for side, asset in textured.items():
        path = f"{prim.GetPath()}.{TEXTURES[side]}"
        try:
            stated = textures.header(str(asset.resolvedPath), _MATRICES)
            matrix = np.array(stated, np.float64)
            if matrix.size != 16:
                raise TextureError("has no matrix worldtoscreen in its header")
            inverse = np.linalg.inv(matrix.reshape(4, 4))
            if not np.isfinite(inverse).all():
                raise TextureError("has a matrix worldtoscreen that is not finite")
        except np.linalg.LinAlgError:
            log.add(
                "draw_mode", path, f"texture {asset.path} has a worldtoscreen without an inverse: its card is not drawn"
            )
        except (TextureError, InputError, TypeError, ValueError) as problem:
            log.add("draw_mode", path, f"texture {asset.path} {problem}: its card is not drawn")
        else:
            yield Card(side, TEXTURES[side], model_from_clip=tuple(map(tuple, inverse.tolist())))


def _asset(prim: Usd.Prim, side: str) -> Sdf.AssetPath | None:
    attribute = prim.GetAttribute(TEXTURES[side])
    value = attribute.Get(Usd.TimeCode.EarliestTime()) if attribute else None
    return value if isinstance(value, Sdf.AssetPath) and value.path else None


def _is_simple(prim: Usd.Prim) -> bool:
    """Whether the cards of the stage's up axis are left out; by the nearest prim that says so or not."""
    while prim:
        visibility = _token(prim, "model:cardVisibility", "inherited")
        if visibility != "inherited":
            return visibility == "simple"
        prim = prim.GetParent()
    return False


def _token(prim: Usd.Prim, name: str, fallback: str) -> str:
    attribute = prim.GetAttribute(name)
    value = attribute.Get() if attribute else None
    return value if isinstance(value, str) else fallback


def _color(prim: Usd.Prim, log: FindingLog) -> tuple[float, float, float]:
    attribute = prim.GetAttribute(COLOR)
    value = attribute.Get() if attribute else None
    found = finite_numbers(value, 3)
    if found is None and value is not None:
        path = prim.GetPath()
        log.add(
            "draw_mode", path, f"{COLOR} of {path} must be 3 finite numbers, got {format_value(value)}: grey is used"
        )
    red, green, blue = found or _COLOR
    return colour.rgb_to_working((red, green, blue))
