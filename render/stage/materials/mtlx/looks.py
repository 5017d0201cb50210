"""Looks of materials by MaterialX: documents that a stage references, and networks of its nodes in USD."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pxr import Sdf, Usd, UsdShade

from render import colour
from render.errors import InputError
from render.model.scene import Image, Material, SurfaceGraph, TextureLookup, Wrap
from render.stage.findings import FindingLog
from render.stage.geometry.shape import PrimvarNames
from render.stage.materials.image_files import TextureError
from render.stage.materials.material import BoundMaterial
from render.stage.materials.mtlx.document_networks import DocumentNetworks
from render.stage.materials.mtlx.documents import DocumentError, file_in, read_document, studio_documents
from render.stage.materials.mtlx.generation import ProgramWriter
from render.stage.materials.mtlx.network import Input, Network, NetworkError, Node
from render.stage.materials.mtlx.opacity import is_used, may_be_transparent, opacity_of
from render.stage.materials.mtlx.programs import GeometryUse, ImageUse, Program
from render.stage.materials.mtlx.surfaces import SURFACES, SurfaceShader
from render.stage.materials.mtlx.udim import TileGrid, grid_of, spread_coordinates, tile_files
from render.stage.materials.mtlx.usd_networks import surface_network
from render.stage.materials.mtlx.values import color_of, numbers_of
from render.stage.materials.textures import TextureCache
from render.stage.world import world_from_stage

_WRAPS: dict[str, Wrap] = {"constant": "black", "clamp": "clamp", "periodic": "repeat", "mirror": "mirror"}


class MaterialXLooks:
    """Reads looks of materials by MaterialX.

    Args:
        stage: the stage.
        textures: reads the image files.
        log: receives what is not honoured.
    """

    def __init__(self, stage: Usd.Stage, textures: TextureCache, log: FindingLog) -> None:
        self._stage, self._textures, self._log = stage, textures, log
        self._documents: dict[str, DocumentNetworks | None] = {}
        self._grids: dict[tuple[int, tuple[float, ...]], TileGrid] = {}

    def of_document(self, path: str, time: Usd.TimeCode) -> BoundMaterial | None:
        """Look of a material prim that a .mtlx reference should have provided; None where there is none."""
        file = self._file_for(Sdf.Path(path))
        networks = self._networks(file) if file else None
        if networks is None:
            return None
        try:
            network = networks.material(Sdf.Path(path).name)
        except NetworkError as problem:
            self._unread(path, str(problem))
            return None
        if network is not None and network.displaces:
            self._note_displacement(path)
        return self._look(path, network, time, False) if network is not None else None

    def of_shader(
        self, material: UsdShade.Material, shader: UsdShade.Shader, time: Usd.TimeCode
    ) -> BoundMaterial | None:
        """Look of a material whose surface is a node of MaterialX; None where it is none."""
        path = str(material.GetPath())
        source = material.ComputeDisplacementSource("mtlx")[0]
        if source and str(source.GetIdAttr().Get() or "").startswith("ND_"):
            self._note_displacement(path)
        try:
            found = surface_network(shader, time)
        except NetworkError as problem:
            self._unread(path, str(problem))
            return None
        return self._look(path, found.network, time, found.varies) if found is not None else None

    def _note_displacement(self, path: str) -> None:
        message = f"in material {path}, displacement by MaterialX is not drawn: surfaces stay in place"
        self._log.add("materialx_displacement", path, message)

    def _unread(self, path: str, why: str) -> None:
        self._log.add("materialx_unread", path, f"material {path} is not read: {why}")

    def _file_for(self, path: Sdf.Path) -> str | None:
        """The .mtlx file that the nearest existing ancestor of a path references."""
        prim = self._stage.GetPrimAtPath(path.GetPrimPath())
        while not prim and path != Sdf.Path.absoluteRootPath:
            path = path.GetParentPath()
            prim = self._stage.GetPrimAtPath(path)
        for spec in prim.GetPrimStack() if prim else []:
            for reference in spec.referenceList.GetAppliedItems():
                if reference.assetPath.endswith(".mtlx"):
                    return str(spec.layer.ComputeAbsolutePath(reference.assetPath))
        return None

    def _networks(self, file: str) -> DocumentNetworks | None:
        if file not in self._documents:
            try:
                document = read_document(file, self._textures.confined_to)
                studio = replace(document, included=(*document.included, *studio_documents()))
                self._documents[file] = DocumentNetworks(studio)
            except DocumentError as problem:
                name = file.rsplit("/", 1)[-1]
                self._log.add("materialx_unreadable", name, f"MaterialX file {name} cannot be read: {problem}")
                self._documents[file] = None
        return self._documents[file]

    def _look(self, path: str, network: Network, time: Usd.TimeCode, varies: bool) -> BoundMaterial | None:
        category = network.surface.category
        shader = SURFACES.get(category)
        if shader is None:
            self._unread(path, f"its surface is a {category[:60]}; {', '.join(SURFACES)} are drawn")
            return None
        frame = 0.0 if time.IsDefault() else time.GetValue()
        grids = spread_coordinates(network, lambda node, given: self._grid(path, node, given))
        writer = ProgramWriter(network, frame, frame / (self._stage.GetTimeCodesPerSecond() or 24.0))
        try:
            program = writer.write()
        except NetworkError as problem:
            self._unread(path, str(problem))
            return None
        for note in writer.notes:
            self._log.add("materialx_node", f"{path} {note}", f"in material {path}, {note}: its default is used")
        self._note_lobes(path, network, shader)
        return _LookWriter(path, network, shader, program, grids, self._stage, self._textures, self._log).look(
            varies or program.animated
        )

    def _grid(self, path: str, node: Node, given: Input) -> TileGrid | None:
        """The tiles of a UDIM set; None, and a finding, where there are none."""
        name, files = given.value or "", tile_files(given)
        try:
            if not files:
                raise TextureError("has no tiles")
            tiles, problems = self._textures.tiled(name, files, _space_of(given, node), "data")
        except (TextureError, InputError) as problem:
            message = f"texture {name[:200]} {problem}; a constant is used in {path} instead"
            self._log.add("texture_unreadable", f"{path} {name[:200]}", message)
            return None
        for number, reason in problems.items():
            message = f"tile {number} of texture {name[:200]} {reason}; a constant is used in {path} instead"
            self._log.add("texture_unreadable", f"{path} tile {number}", message)
        key = id(tiles), numbers_of(node.inputs.get("default"))
        if key not in self._grids:
            grid = self._grids[key] = grid_of(tiles, key[1])
            height, width = grid.image.pixels.shape[0] // grid.size[1], grid.image.pixels.shape[1] // grid.size[0]
            if (height, width) != tiles.pixels.shape[1:3]:
                message = f"tiles of texture {name[:200]} are drawn with {width} × {height} pixels each in {path}"
                self._log.add("texture_scaled", f"{path} {name[:200]}", message)
        return self._grids[key]

    def _note_lobes(self, path: str, network: Network, shader: SurfaceShader) -> None:
        used = [name for name in shader.lobes if is_used(network.surface.inputs.get(name))]
        if used:
            message = f"in material {path}, {', '.join(used)} of {network.surface.category} are not drawn"
            self._log.add("materialx_lobes", path, message)


def _space_of(given: Input, node: Node | None) -> str:
    """Colour space of an image that a node reads; numbers have none."""
    is_color = node is None or node.type in ("color3", "color4", "")
    return given.color_space if is_color and given.color_space else "raw"


@dataclass(eq=False)
class _LookWriter:
    path: str
    network: Network
    shader: SurfaceShader
    program: Program
    grids: Mapping[int, Image]
    stage: Usd.Stage
    textures: TextureCache
    log: FindingLog

    def look(self, varies: bool) -> BoundMaterial:
        names, is_place = self._primvars(self.program.geometry)
        graph = SurfaceGraph(
            functions=self.program.functions,
            numbers=(*self._frames(), *self.program.numbers),
            reads_place=is_place,
            may_be_transparent=may_be_transparent(self.network.surface),
            opacity=opacity_of(self.network.surface),
        )
        lookups = {each.sampler: self._lookup(each) for each in self.program.images}
        has_coat = self.shader.coat is not None and is_used(self.network.surface.inputs.get(self.shader.coat))
        material = Material(
            name=self.path,
            clearcoat=1.0 if has_coat else 0.0,
            unlit=self.shader.is_unlit,
            lookups=lookups,
            graph=graph,
        )
        return BoundMaterial(material, names, varies)

    def _frames(self) -> tuple[float, ...]:
        """Rows of the block of `layers/graph.glsl` before the network's own numbers."""
        to_working = colour.to_working(np.eye(3, dtype=np.float32)).astype(np.float64)
        columns = np.zeros((10, 4))
        columns[:3, :3] = to_working
        columns[3:6, :3] = np.linalg.inv(to_working)
        columns[6:] = np.linalg.inv(world_from_stage(self.stage)).T
        return tuple(columns.ravel().tolist())

    def _lookup(self, use: ImageUse) -> TextureLookup:
        wraps = [
            _WRAPS.get(
                (use.node.inputs[name].value or "") if use.node is not None and name in use.node.inputs else "",
                "repeat",
            )
            for name in ("uaddressmode", "vaddressmode")
        ]
        coordinates = use.node.inputs.get("texcoord") if use.node is not None else None
        is_plain = use.node is not None and use.node.category == "image" and coordinates is None
        return TextureLookup(
            image=self._image(use),
            # what a network does to coordinates is not known: the whole image is held
            uv_transform=np.array([[1, 0, 0], [0, 1, 0]] if is_plain else [[0, 0, 0], [0, 0, 0]], np.float32),
            wrap_s=wraps[0],
            wrap_t=wraps[1],
        )

    def _image(self, use: ImageUse) -> Image:
        if id(use.input) in self.grids:
            return self.grids[id(use.input)]
        name = use.input.value or ""
        space = _space_of(use.input, use.node)
        try:
            if not name:
                raise TextureError("is not named")
            return self.textures.image(file_in(use.input.folder, name), space, "data")
        except (TextureError, InputError) as problem:
            message = f"texture {name[:200]} {problem}; a constant is used in {self.path} instead"
            self.log.add("texture_unreadable", f"{self.path} {name[:200]}", message)
            return Image(np.array([[[*color_of(use.fallback), 1.0]]], np.float16), name)

    def _primvars(self, uses: Sequence[GeometryUse]) -> tuple[PrimvarNames, bool]:
        names = PrimvarNames(uv=None)
        uv = self._one("texture coordinates", [use for use in uses if use.kind == "uv"])
        color = self._one("colours", [use for use in uses if use.kind == "color"])
        number = self._one("numbers", [use for use in uses if use.kind == "number"])
        is_place = any(use.kind == "place" for use in uses)
        if is_place and (color or number):
            left_out = (color or number).primvar  # type: ignore[union-attr]
            message = f"in material {self.path}, {left_out} is not read: a place in the prim's own space is"
            self.log.add("materialx_primvar", self.path, message)
            color = number = None
        values: dict[str, object] = {"uv": uv.primvar if uv else None}
        if uv is not None and len(uv.fallback) == 2:
            values |= {"uv_fallback": uv.fallback}
        if color is not None:
            values |= {"color": color.primvar}
            if len(color.fallback) >= 3:
                values |= {"color_fallback": color.fallback[:3]}
            elif color.primvar != "displayColor":
                values |= {"color_fallback": (0.0, 0.0, 0.0)}
        if number is not None:
            values |= {"opacity": number.primvar, "opacity_fallback": number.fallback[0] if number.fallback else 0.0}
        if is_place:
            values |= {"place": True}
        names = PrimvarNames(**values)  # type: ignore[arg-type]
        return names, is_place

    def _one(self, what: str, uses: list[GeometryUse]) -> GeometryUse | None:
        names = list(dict.fromkeys(use.primvar for use in uses))
        if len(names) > 1:
            message = (
                f"in material {self.path}, several {what} are read ({', '.join(names)}); only {names[0]} is honoured"
            )
            self.log.add("materialx_primvar", f"{self.path} {what}", message)
        return uses[0] if uses else None
