"""Looks of materials by MaterialX: documents that a stage references, and networks of its nodes in USD."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from pxr import Sdf, Usd, UsdShade

from render import colour
from render.errors import InputError
from render.model.refused_programs import REFUSED
from render.model.scene import Image, Material, SurfaceGraph, TextureLookup
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import Displacement
from render.stage.geometry.shape import PrimvarNames, ValuePrimvar
from render.stage.materials.image_files import TextureError
from render.stage.materials.material import TOO_MANY_PRIMVARS, BoundMaterial
from render.stage.materials.mtlx.displacement import WRAPS, read_displacement
from render.stage.materials.mtlx.document_networks import DocumentNetworks
from render.stage.materials.mtlx.documents import DocumentError, file_in, read_document, studio_documents
from render.stage.materials.mtlx.generation import ProgramWriter
from render.stage.materials.mtlx.library import drawn_definition
from render.stage.materials.mtlx.mixes import drawn_network, mixed_surfaces, share_of, sides_of, single_surfaces
from render.stage.materials.mtlx.network import Input, Network, NetworkError, Node
from render.stage.materials.mtlx.opacity import is_used, may_be_transparent, opacity_of
from render.stage.materials.mtlx.programs import ImageUse, Program
from render.stage.materials.mtlx.slots import DISPLAY_COLOR, NOWHERE, GeometryUse
from render.stage.materials.mtlx.surfaces import MIXED, SURFACES, SurfaceShader
from render.stage.materials.mtlx.udim import TOKEN, TileGrid, grid_of, spread_coordinates, tile_files
from render.stage.materials.mtlx.usd_networks import displacement_node, surface_network
from render.stage.materials.mtlx.values import color_of, numbers_of, parse_numbers
from render.stage.materials.textures import TextureCache
from render.stage.world import world_from_stage

_MOST_LEFT_OUT = 20
_PLAIN_GREY = 0.8
"""Base colour of plain surfaces whose own is not known."""


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
        self._drawn_by: set[str] = set()

    @property
    def has_refused(self) -> bool:
        """Whether the driver has refused the functions of a look since it was read."""
        return any(REFUSED.reason(functions) is not None for functions in self._drawn_by)

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
        if network is None:
            return None
        displacement = self._displacement(path, network.displacement, varies=False)
        look = self._look(path, network, time, False)
        return replace(look, displacement=displacement) if look is not None else None

    def displacement_of_document(self, path: str) -> Displacement | None:
        """Displacement of a material prim that a .mtlx reference should have provided; None where there is none."""
        file = self._file_for(Sdf.Path(path))
        networks = self._networks(file) if file else None
        try:
            network = networks.material(Sdf.Path(path).name) if networks is not None else None
        except NetworkError:
            return None
        return self._displacement(path, network.displacement, varies=False) if network is not None else None

    def displacement_of_shader(self, path: str, shader: UsdShade.Shader, time: Usd.TimeCode) -> Displacement | None:
        """Displacement of a material by a shader that is a node of MaterialX; None where it is not drawn."""
        try:
            node, varies = displacement_node(shader, time)
        except NetworkError:
            node, varies = Node("", "displacementshader"), False
        return self._displacement(path, node, varies=varies)

    def of_shader(
        self, material: UsdShade.Material, shader: UsdShade.Shader, time: Usd.TimeCode
    ) -> BoundMaterial | None:
        """Look of a material whose surface is a node of MaterialX; None where it is none."""
        path = str(material.GetPath())
        try:
            found = surface_network(shader, time)
        except NetworkError as problem:
            self._unread(path, str(problem))
            return None
        return self._look(path, found.network, time, found.varies) if found is not None else None

    def _displacement(self, path: str, node: Node | None, *, varies: bool) -> Displacement | None:
        if node is None:
            return None
        try:
            return read_displacement(node, lambda own, given: self._height_image(path, own, given), varies=varies)
        except NetworkError as problem:
            message = f"in material {path}, displacement is not drawn, since {problem}: surfaces stay in place"
            self._log.add("materialx_displacement", path, message)
            return None

    def _height_image(self, path: str, node: Node, given: Input) -> Image | None:
        """Image of a displacement; None, and a finding, where it cannot be read."""
        name, space = given.value or "", _space_of(given, node)
        try:
            if TOKEN in name:
                files = tile_files(given)
                if not files:
                    raise TextureError("has no tiles")
                return self._textures.tiled(name, files, space, "data")[0]
            return self._textures.image(file_in(given.folder, name), space, "data")
        except (TextureError, InputError) as problem:
            message = f"texture {name[:200]} {problem}; a constant displaces {path} instead"
            self._log.add("texture_unreadable", f"{path} {name[:200]}", message)
            return None

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
        try:
            return self._drawn(path, network, time, varies)
        except NetworkError as problem:
            self._unread(path, str(problem))
            return None

    def _drawn(self, path: str, network: Network, time: Usd.TimeCode, varies: bool) -> BoundMaterial:
        """Look of a network.

        Raises:
            NetworkError: it cannot be drawn.
        """
        drawn = drawn_network(network)
        network, left_out = drawn.network, drawn.left_out[:_MOST_LEFT_OUT]
        frame = 0.0 if time.IsDefault() else time.GetValue()
        grids = spread_coordinates(network, lambda node, given: self._grid(path, node, given))
        writer = ProgramWriter(network, frame, frame / (self._stage.GetTimeCodesPerSecond() or 24.0))
        program = writer.write()
        refusal = REFUSED.reason(program.functions)
        if refusal is not None:
            message = (
                f"in material {path}, the graphics driver refuses the program of its network, so that its UsdPreviewSurface, or "
                f"a plain surface of its base colour, is drawn instead: {refusal}"
            )
            self._log.add("materialx_refused", path, message)
            return _plain_look(path, network, varies)
        self._drawn_by.add(program.functions)
        for note in (*network.notes, *writer.notes):
            self._log.add("materialx_node", f"{path} {note}", f"in material {path}, {note}: its default is used")
        for what in left_out:
            self._log.add("materialx_lobes", f"{path} {what}", f"in material {path}, {what} is not drawn")
        for surface in single_surfaces(network.surface):
            self._note_lobes(path, surface)
        return _LookWriter(path, network, program, grids, self._stage, self._textures, self._log).look(
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

    def _note_lobes(self, path: str, surface: Node) -> None:
        used = [name for name in SURFACES[surface.category].lobes if is_used(surface.inputs.get(name))]
        if used:
            message = f"in material {path}, {', '.join(used)} of {surface.category} are not drawn"
            self._log.add("materialx_lobes", f"{path} {surface.name}", message)


def _plain_look(path: str, network: Network, varies: bool) -> BoundMaterial:
    """Plain surface of the constant base colour of a network, of that of its shader where another node gives it.

    A mix is drawn as the side of which it has most, as its ``bg`` where a node gives the share.
    """
    surface = network.surface
    while surface.category == MIXED:
        surface = sides_of(surface)[(share_of(surface) or 0.0) > 0.5]
    shader = SURFACES[surface.category]
    numbers = color_of(_plain_color(surface, shader))
    red, green, blue = colour.to_working(np.array(numbers, np.float32)).tolist()
    name = "emissive" if shader.is_unlit else "base_color"
    material = Material(path, unlit=shader.is_unlit, **{name: (red, green, blue)})  # type: ignore[arg-type]
    return BoundMaterial(material, PrimvarNames(uv=None), varies)


def _plain_color(surface: Node, shader: SurfaceShader) -> tuple[float, ...]:
    """Base colour of a surface: of lobes, that of the diffuse one, of the metal, or a grey where neither is a constant."""
    if surface.category != "surface":
        theirs = drawn_definition(surface.category).getActiveInput(shader.color)
        return numbers_of(surface.inputs.get(shader.color)) or parse_numbers(theirs.getValueString())
    known = (numbers_of(surface.inputs.get(name)) for name in (shader.color, "metal"))
    return next(filter(any, known), (_PLAIN_GREY,))


def _space_of(given: Input, node: Node | None) -> str:
    """Colour space of an image that a node reads; numbers have none."""
    is_color = node is None or node.type in ("color3", "color4", "")
    return given.color_space if is_color and given.color_space else "raw"


def _uses(surface: Node, name: str | None) -> bool:
    return name is not None and is_used(surface.inputs.get(name))


def _opacity_of(surface: Node) -> float:
    """Opacity of a surface or of a mix; where a node gives the share of a mix, that of its more opaque side."""
    known: dict[int, float] = {}
    for node in mixed_surfaces(surface):
        if node.category != MIXED:
            known[id(node)] = opacity_of(node)
            continue
        bg, fg = (known[id(side)] for side in sides_of(node))
        share = share_of(node)
        known[id(node)] = max(bg, fg) if share is None else bg + (fg - bg) * share
    return known[id(surface)]


@dataclass(eq=False)
class _LookWriter:
    path: str
    network: Network
    program: Program
    grids: Mapping[int, Image]
    stage: Usd.Stage
    textures: TextureCache
    log: FindingLog

    def look(self, varies: bool) -> BoundMaterial:
        names, is_place = self._primvars(self.program.geometry)
        singles = single_surfaces(self.network.surface)
        graph = SurfaceGraph(
            functions=self.program.functions,
            numbers=(*self._frames(), *self.program.numbers),
            reads_place=is_place,
            may_be_transparent=any(map(may_be_transparent, singles)),
            opacity=_opacity_of(self.network.surface),
            has_sheen=any(_uses(surface, SURFACES[surface.category].sheen) for surface in singles),
            has_film=any(_uses(surface, SURFACES[surface.category].film) for surface in singles),
            mixed=len(list(mixed_surfaces(self.network.surface))),
        )
        lookups = {each.sampler: self._lookup(each) for each in self.program.images}
        material = Material(
            name=self.path,
            clearcoat=float(any(_uses(surface, SURFACES[surface.category].coat) for surface in singles)),
            unlit=all(SURFACES[surface.category].is_unlit for surface in singles),
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
            WRAPS.get(
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
        own = {"color" if use.kind == "vector" else use.kind: use for use in uses if use.at == -1}
        further = {use.at: use for use in uses if use.at >= 0}
        for name in dict.fromkeys(use.primvar for use in uses if use.at == NOWHERE):
            message = f"in material {self.path}, {name[:100]} is not read, but its default: {TOO_MANY_PRIMVARS}"
            self.log.add("materialx_primvar", f"{self.path} {name}", message)
        uv, color, number = own.get("uv"), own.get("color"), own.get("number")
        values: dict[str, object] = {"uv": uv.primvar if uv else None}
        if uv is not None and len(uv.fallback) == 2:
            values |= {"uv_fallback": uv.fallback}
        if color is not None:
            values |= {"color": color.primvar}
            if len(color.fallback) >= 3:
                values |= {"color_fallback": color.fallback[:3]}
            elif color.primvar != DISPLAY_COLOR:
                values |= {"color_fallback": (0.0, 0.0, 0.0)}
        if number is not None:
            values |= {"opacity": number.primvar, "opacity_fallback": number.fallback[0] if number.fallback else 0.0}
        if "place" in own:
            values |= {"place": True}
        values["values"] = tuple(
            ValuePrimvar(use.primvar, use.numbers, use.kind == "color") for _, use in sorted(further.items())
        )
        return PrimvarNames(**values), "place" in own  # type: ignore[arg-type]
