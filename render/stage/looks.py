"""What a bound material looks like, whatever language it is written in; each material is read once."""

from __future__ import annotations

from dataclasses import replace

from pxr import Usd, UsdShade

from render.scene import Material
from render.stage.findings import FindingLog
from render.stage.materials import DEFAULT_LOOK, Look, preview_surface_look
from render.stage.materialx import MaterialXFiles
from render.stage.texture_nodes import TextureNodes
from render.stage.textures import TextureCache

_NO_PATH = ""


class LookReader:
    """Reads the looks of a stage's materials.

    Args:
        stage: the stage.
        textures: reads image files.
        log: notes what is not honoured.
    """

    def __init__(self, stage: Usd.Stage, textures: TextureCache, log: FindingLog) -> None:
        self._stage, self._log = stage, log
        self._nodes = TextureNodes(textures, log)
        self._materialx = MaterialXFiles(stage, textures, log)
        self._looks: dict[str, Look] = {_NO_PATH: DEFAULT_LOOK}

    def look(self, path: str, time: Usd.TimeCode) -> Look:
        """The look of the material at a path, or the default look for an empty path.

        A material that varies is read anew, and stays the same object where nothing came out differently.
        """
        known = self._looks.get(path)
        if known is not None and not known.varies:
            return known
        fresh = self._read(path, time)
        if known is not None and _same_material(known.material, fresh.material):
            fresh = replace(fresh, material=known.material)
        self._looks[path] = fresh
        return fresh

    def _read(self, path: str, time: Usd.TimeCode) -> Look:
        material = UsdShade.Material(self._stage.GetPrimAtPath(path))
        if not material:
            return self._materialx.look(path) or self._unread(path, "does not exist")
        shader = material.ComputeSurfaceSource()[0]
        if shader and self._nodes.kind(shader) == "UsdPreviewSurface":
            return preview_surface_look(material, shader, time, self._nodes, self._log)
        kind = self._nodes.kind(shader) if shader else ""
        return self._unread(path, f"has a surface of {kind}" if kind else "has no surface that can be read")

    def _unread(self, path: str, why: str) -> Look:
        message = f"material {path} {why}: only UsdPreviewSurface is honoured, so displayColor is drawn instead"
        self._log.add("material_unread", path, message)
        return replace(DEFAULT_LOOK, material=replace(DEFAULT_LOOK.material, name=path))


def _same_material(one: Material, other: Material) -> bool:
    """Whether two materials draw the same; texture lookups count as the same only when their images and numbers are."""
    if one.lookups.keys() != other.lookups.keys():
        return False
    for name, lookup in one.lookups.items():
        against = other.lookups[name]
        if lookup.image is not against.image or (lookup.wrap_s, lookup.wrap_t) != (against.wrap_s, against.wrap_t):
            return False
        for left, right in ((lookup.uv_transform, against.uv_transform), (lookup.scale, against.scale)):
            if not (left == right).all():
                return False
        if lookup.channel != against.channel or not (lookup.bias == against.bias).all():
            return False
    return _constants(one) == _constants(other)


def _constants(material: Material) -> dict[str, object]:
    return {name: value for name, value in vars(material).items() if name != "lookups"}
