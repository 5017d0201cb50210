"""Looks of bound materials, in any supported shading language; each material is read once."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import replace
from typing import TYPE_CHECKING

from pxr import Usd, UsdShade

from render.model.scene import TextureLookup
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Displacement
from render.stage.geometry.stand_ins import StandIn
from render.stage.materials.material import (
    DEFAULT_LOOK,
    BoundMaterial,
    preview_surface_displacement,
    preview_surface_look,
)
from render.stage.materials.stand_in_looks import is_stand_in, read_stand_in, stand_in_look
from render.stage.materials.texture_nodes import TextureNodes
from render.stage.materials.textures import TextureCache

if TYPE_CHECKING:
    from render.stage.materials.mtlx.looks import MaterialXLooks

_NO_PATH = ""
_CONTEXT = "mtlx"  # of outputs:mtlx:surface
_MATERIALX = "ND_"  # beginning of the identifiers of its nodes


class LookReader:
    """Reads the looks of a stage's materials.

    Args:
        stage: the stage.
        textures: reads image files.
        log: receives requests that are not honoured.
    """

    def __init__(self, stage: Usd.Stage, textures: TextureCache, log: FindingLog) -> None:
        self._stage, self._textures, self._log = stage, textures, log
        self._nodes = TextureNodes(textures, log)
        self._materialx: MaterialXLooks | None = None
        self._looks: dict[str, BoundMaterial] = {_NO_PATH: DEFAULT_LOOK}
        self._representatives: dict[Hashable, str] = {_signature(DEFAULT_LOOK): _NO_PATH}
        self._representative_of: dict[str, str] = {}
        self._undisplaced: set[str] = set()

    @property
    def has_refused(self) -> bool:
        """Whether the driver has refused the functions of a look since it was read."""
        return self._materialx is not None and self._materialx.has_refused

    def look(self, path: str, time: Usd.TimeCode) -> BoundMaterial:
        """The look of the material, or of a stand-in's attribute, at a path; or the default look for an empty path.

        A varying material is read at each time, and stays the same object where nothing has changed.
        """
        known = self._looks.get(path)
        if known is not None and not known.varies:
            return known
        fresh = self._read(path, time)
        if known is not None and _signature(known) == _signature(fresh):
            fresh = replace(fresh, material=known.material)
        self._looks[path] = fresh
        return fresh

    def representative(self, path: str, time: Usd.TimeCode) -> str:
        """The first material path whose look is the same as this one's, so that copies of an asset are drawn together."""
        if path not in self._representative_of:
            look = self.look(path, time)
            if look.varies:
                return path
            self._representative_of[path] = self._representatives.setdefault(_signature(look), path)
        return self._representative_of[path]

    def displacement(self, path: str, time: Usd.TimeCode) -> Displacement | None:
        """The displacement of surfaces that wear the material at a path; its other textures are not read."""
        material = UsdShade.Material(self._stage.GetPrimAtPath(path))
        if not material and path and not is_stand_in(path) and path not in self._undisplaced:
            displacement = self._of_materialx().displacement_of_document(path)
            self._undisplaced |= {path} if displacement is None else set()
            return displacement
        is_own = bool(material) and self._surface(material)[1].startswith(_MATERIALX)
        own = material.ComputeDisplacementSource(_CONTEXT)[0] if is_own else None
        if own and self._nodes.kind(own).startswith(_MATERIALX):
            return self._of_materialx().displacement_of_shader(path, own, time)
        shader = material.ComputeDisplacementSource()[0] if material else None
        if not shader or self._nodes.kind(shader) != "UsdPreviewSurface":
            return None
        return preview_surface_displacement(material, shader, time, self._nodes, self._log)

    def stand_in(self, prim: Usd.Prim, mode: str) -> StandIn:
        """The stand-in of a model with a draw mode; its looks are at the paths of the attributes that give them."""
        return read_stand_in(prim, mode, self._textures, self._log)

    def _read(self, path: str, time: Usd.TimeCode) -> BoundMaterial:
        if is_stand_in(path):
            return stand_in_look(self._stage, path, time, self._textures, self._log)
        material = UsdShade.Material(self._stage.GetPrimAtPath(path))
        if not material:
            return self._of_materialx().of_document(path, time) or self._unread(path, "does not exist")
        shader, kind = self._surface(material)
        if kind == "UsdPreviewSurface":
            return preview_surface_look(material, shader, time, self._nodes, self._log)
        if kind.startswith(_MATERIALX):
            look = self._of_materialx().of_shader(material, shader, time)
            shader = material.ComputeSurfaceSource()[0]
            is_drawn = look is not None and look.material.graph is not None
            if not is_drawn and shader and self._nodes.kind(shader) == "UsdPreviewSurface":
                look = preview_surface_look(material, shader, time, self._nodes, self._log)
            if look is not None:
                return self._displaced(look, path, time)
        return self._unread(path, f"has a surface of {kind}" if kind else "has no surface that can be read")

    def _displaced(self, look: BoundMaterial, path: str, time: Usd.TimeCode) -> BoundMaterial:
        """Look with the displacement of the material, whose surface is another shader."""
        displacement = self.displacement(path, time)
        varies = look.varies or (displacement is not None and displacement.varies)
        return replace(look, displacement=displacement, varies=varies)

    def _surface(self, material: UsdShade.Material) -> tuple[UsdShade.Shader, str]:
        """The surface for MaterialX where there is one, else that for all; and its kind, which may be empty."""
        if material.GetSurfaceOutput(_CONTEXT):
            own = material.ComputeSurfaceSource(_CONTEXT)[0]
            if own and self._nodes.kind(own).startswith(_MATERIALX):
                return own, self._nodes.kind(own)
        shader = material.ComputeSurfaceSource()[0]
        return shader, self._nodes.kind(shader) if shader else ""

    def _of_materialx(self) -> MaterialXLooks:
        """Reader of materials by MaterialX, whose library is loaded where one is met."""
        if self._materialx is None:
            from render.stage.materials.mtlx.looks import MaterialXLooks

            self._materialx = MaterialXLooks(self._stage, self._textures, self._log)
        return self._materialx

    def _unread(self, path: str, why: str) -> BoundMaterial:
        message = f"material {path} {why}: only UsdPreviewSurface and MaterialX are honoured, so displayColor is drawn instead"
        self._log.add("material_unread", path, message)
        return replace(DEFAULT_LOOK, material=replace(DEFAULT_LOOK.material, name=path))


def _signature(look: BoundMaterial) -> Hashable:
    """Equal for looks that draw the same and want the same primvars, whatever their names."""
    own = {**vars(look.material), "values": tuple(look.material.values.items())}
    constants = tuple((name, value) for name, value in own.items() if name not in ("name", "lookups"))
    lookups = tuple((name, _of_lookup(lookup)) for name, lookup in look.material.lookups.items())
    return constants, lookups, look.primvars, _of_displacement(look.displacement)


def _of_displacement(displacement: Displacement | None) -> Hashable:
    if displacement is None:
        return None
    lookup = None if displacement.lookup is None else _of_lookup(displacement.lookup)
    return displacement.amount, displacement.primvar, lookup


def _of_lookup(lookup: TextureLookup) -> Hashable:
    arrays = tuple(a.tobytes() for a in (lookup.uv_transform, lookup.scale, lookup.bias, lookup.fallback))
    return id(lookup.image), arrays, lookup.wrap_s, lookup.wrap_t, lookup.channel, lookup.uv_at
