"""MaterialX files that a stage references, read roughly: usd-core cannot open .mtlx, so the reference itself stays empty.

A ``standard_surface`` gives its base colour, metalness, roughness, normal and emission, as constants or as image files. That
is enough for a wooden or a painted thing to look like itself; transmission, subsurface scattering, coats and everything
computed by nodes other than ``image``, ``tiledimage`` and ``normalmap`` are left out, with a finding.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd

from render import colour
from render.errors import InputError
from render.model.scene import Material, TextureLookup
from render.stage.findings import FindingLog
from render.stage.geometry.shape import PrimvarNames
from render.stage.materials.image_files import TextureError
from render.stage.materials.material import BoundMaterial
from render.stage.materials.textures import TextureCache

_RGB_INPUTS = {"base_color": "base_color"}
_SCALAR_INPUTS = {"metalness": "metallic", "specular_roughness": "roughness"}
_SCALAR_DEFAULTS = {"metalness": 0.0, "specular_roughness": 0.2}
_GREY = (0.8, 0.8, 0.8)
_MOST = 1e15
"""Numbers beyond it are no colours or weights; products of two of them are kept in single precision."""


class MaterialXFiles:
    """Finds and reads the MaterialX documents behind materials that composition could not bring in.

    Args:
        stage: the stage.
        textures: reads the image files.
        log: receives approximations.
    """

    def __init__(self, stage: Usd.Stage, textures: TextureCache, log: FindingLog) -> None:
        self._stage, self._textures, self._log = stage, textures, log
        self._documents: dict[str, ET.Element | None] = {}
        self._names: dict[str, _Names] = {}

    def look(self, path: str) -> BoundMaterial | None:
        """Look of a material prim that a .mtlx reference should have provided; None where there is none."""
        file = self._file_for(Sdf.Path(path))
        root = self._document(file) if file else None
        if file is None or root is None:
            return None
        names = self._names.setdefault(str(file), _Names())
        surface = _surface_of(root, Sdf.Path(path).name, names)
        if surface is None:
            return None
        message = f"MaterialX file {file.name} is approximated: base colour, metalness, roughness, normal and emission are read"
        self._log.add("materialx_approximated", file.name, message)
        return _SurfaceReader(root, names, surface, file, path, self._textures, self._log).look()

    def _file_for(self, path: Sdf.Path) -> Path | None:
        """The .mtlx file that the nearest existing ancestor of a path references."""
        prim = self._stage.GetPrimAtPath(path.GetPrimPath())
        while not prim and path != Sdf.Path.absoluteRootPath:
            path = path.GetParentPath()
            prim = self._stage.GetPrimAtPath(path)
        for spec in prim.GetPrimStack() if prim else []:
            for reference in spec.referenceList.GetAppliedItems():
                if reference.assetPath.endswith(".mtlx"):
                    return Path(spec.layer.ComputeAbsolutePath(reference.assetPath))
        return None

    def _document(self, file: Path) -> ET.Element | None:
        key = str(file)
        if key not in self._documents:
            try:
                self._documents[key] = ET.parse(file).getroot()
            except (OSError, ET.ParseError, ValueError, LookupError) as problem:  # of XML and of its encodings
                reason = "it is missing" if isinstance(problem, OSError) else str(problem)
                self._log.add("materialx_unreadable", file.name, f"MaterialX file {file.name} cannot be read: {reason}")
                self._documents[key] = None
        return self._documents[key]


class _Names:
    """Elements of a document by their names, which may hold any letters."""

    def __init__(self) -> None:
        self._by_parent: dict[ET.Element, dict[tuple[str, str | None], ET.Element]] = {}

    def find(self, parent: ET.Element, tag: str, name: str | None) -> ET.Element | None:
        """The first child of a tag, or of any tag for ``*``, with a name; None where there is none."""
        children = self._by_parent.get(parent)
        if children is None:
            children = self._by_parent[parent] = {}
            for child in parent:
                children.setdefault((child.tag, child.get("name")), child)
                children.setdefault(("*", child.get("name")), child)
        return None if name is None else children.get((tag, name))


def _surface_of(root: ET.Element, name: str, names: _Names) -> ET.Element | None:
    """The standard_surface node of the surfacematerial of that name."""
    material = names.find(root, "surfacematerial", name)
    link = names.find(material, "input", "surfaceshader") if material is not None else None
    return names.find(root, "standard_surface", link.get("nodename")) if link is not None else None


class _SurfaceReader:
    def __init__(
        self,
        root: ET.Element,
        names: _Names,
        surface: ET.Element,
        file: Path,
        path: str,
        textures: TextureCache,
        log: FindingLog,
    ) -> None:
        self._root, self._names, self._surface, self._file, self._path = root, names, surface, file, path
        self._textures, self._log = textures, log
        self._lookups: dict[str, TextureLookup] = {}

    def look(self) -> BoundMaterial:
        base = self._weighted_base_color()
        self._texture("base_color", "base_color", "color")
        scalars = {ours: self._scalar(theirs, ours) for theirs, ours in _SCALAR_INPUTS.items()}
        self._texture("normal", "normal", "data")
        material = Material(
            name=self._path,
            base_color=base,
            emissive=self._emission(),
            metallic=scalars["metallic"],
            roughness=scalars["roughness"],
            lookups=self._lookups,
        )
        return BoundMaterial(material, PrimvarNames(uv="st" if self._lookups else None))

    def _weighted_base_color(self) -> tuple[float, float, float]:
        """base · base_color, and for glass its transmission colour, which it shows from afar."""
        color = self._numbers("base_color", _GREY) * self._numbers("base", (1.0,))[0]
        transmission = self._numbers("transmission", (0.0,))[0]
        through = self._numbers("transmission_color", (1.0, 1.0, 1.0))
        return _to_working_space(color * (1 - transmission) + through * transmission)

    def _emission(self) -> tuple[float, float, float]:
        return _to_working_space(
            self._numbers("emission_color", (1.0, 1.0, 1.0)) * self._numbers("emission", (0.0,))[0]
        )

    def _scalar(self, theirs: str, ours: str) -> float:
        self._texture(theirs, ours, "data")
        return float(self._numbers(theirs, (_SCALAR_DEFAULTS[theirs],))[0])

    def _numbers(self, name: str, default: tuple[float, ...]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        element = self._names.find(self._surface, "input", name)
        text = element.get("value") if element is not None else None
        if text is None:
            return np.array(default)
        try:
            values = [float(part) for part in re.findall(r"[-+0-9.eE]+", text)]
        except ValueError:
            return np.array(default)
        is_usable = len(values) == len(default) and all(abs(value) <= _MOST for value in values)
        return np.array(values if is_usable else default)

    def _texture(self, theirs: str, ours: str, purpose: str) -> None:
        element = self._names.find(self._surface, "input", theirs)
        image = self._image_node(element) if element is not None else None
        file_input = self._names.find(image, "input", "file") if image is not None else None
        if file_input is None:
            if element is not None and element.get("value") is None:
                message = (
                    f"in material {self._path}, {theirs} is computed by nodes that are not read; a constant is used"
                )
                self._log.add(f"materialx_{theirs}", self._path, message)
            return
        space = file_input.get("colorspace") or ("raw" if purpose == "data" else "lin_rec709")
        name = file_input.get("value") or ""
        path = str(self._file.parent / name)
        try:
            picture = self._textures.image(path, space, purpose)
        except (TextureError, InputError) as problem:
            message = f"texture {name} {problem}; {theirs} of {self._path} is a constant instead"
            self._log.add("texture_unreadable", f"{self._path}.{theirs}", message)
            return
        four = np.float32
        normal = ours == "normal"
        self._lookups[ours] = TextureLookup(
            image=picture,
            scale=np.array([2, 2, 2, 1] if normal else [1] * 4, four),
            bias=np.array([-1, -1, -1, 0] if normal else [0] * 4, four),
            channel=-1 if normal or purpose == "color" else 0,
        )

    def _image_node(self, source: ET.Element) -> ET.Element | None:
        """Follow an input to the image node that feeds it, through node graph outputs and normal maps."""
        scope = self._root
        graph = source.get("nodegraph")
        if graph is not None:
            element = self._names.find(self._root, "nodegraph", graph)
            if element is None:
                return None
            scope = element
            output = self._names.find(scope, "output", source.get("output"))
            if output is None:
                return None
            source = output
        for _ in range(8):
            node = self._names.find(scope, "*", source.get("nodename"))
            if node is None or node.tag in ("image", "tiledimage"):
                return node
            inner = self._names.find(node, "input", "in") if node.tag == "normalmap" else None
            if inner is None:
                return None
            source = inner
        return None


def _to_working_space(rgb: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> tuple[float, float, float]:
    return colour.rgb_to_working((float(rgb[0]), float(rgb[1]), float(rgb[2])))
