"""GLSL for a network of MaterialX, by the generator of the MaterialX package.

The network is written as a document of its own first, with plain names and checked values: nothing that a file says reaches the
package as it is, but for definitions of nodes by other nodes. What the generator writes is the whole fragment shader of a surface
that is ours (`render.stage.materials.mtlx.library`); its functions are kept, and what it declares is given to them by
``layers/graph.glsl``.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import MaterialX as mx
from MaterialX import PyMaterialXGenShader as mx_shader

from render.model.scene import LEAST_GLASS_OPACITY
from render.stage.materials.mtlx.library import PREFIX, library
from render.stage.materials.mtlx.network import (
    IDENTIFIER,
    MOST_WEIGHT,
    OWN,
    Input,
    Network,
    NetworkError,
    Node,
    node_weight,
)
from render.stage.materials.mtlx.surfaces import SURFACES

MOST_IMAGES = 16
"""Images of one network: the units of textures that materials may have (`render.layers.renderer`)."""
MOST_OCTAVES = 16
_MOST = 1e15
"""Numbers beyond it are no colours or weights; products of two of them are kept in single precision."""
_MOST_TEXT = 1_000_000
_WIDTHS = {
    "float": 1,
    "integer": 1,
    "boolean": 1,
    "vector2": 2,
    "vector3": 3,
    "color3": 3,
    "vector4": 4,
    "color4": 4,
    "matrix33": 9,
    "matrix44": 16,
}
_GLSL = {
    "float": "{}.x",
    "integer": "int({}.x)",
    "boolean": "({}.x > 0.5)",
    "vector2": "{}.xy",
    "vector3": "{}.xyz",
    "color3": "{}.xyz",
    "vector4": "{}",
    "color4": "{}",
}
_WORD = re.compile(r"[A-Za-z0-9_ .,+-]{0,64}")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_UNIFORM = re.compile(r"^uniform (\w+) (\w+)(\[\d+\])?( = .*)?;$")


@dataclass(frozen=True)
class ImageUse:
    """Image that a network reads.

    Attributes:
        sampler: name of its sampler in the functions.
        input: the input that names the file.
        node: the node that reads it, or None for one inside a definition.
        fallback: its value where there is no image.
    """

    sampler: str
    input: Input
    node: Node | None
    fallback: tuple[float, ...]


@dataclass(frozen=True)
class GeometryUse:
    """Value of the geometry that a network reads.

    Attributes:
        kind: ``uv``, ``color``, ``number`` or ``place``.
        primvar: name of the primvar; empty for a place.
        fallback: where the geometry has none; empty for what the kind has by itself.
    """

    kind: str
    primvar: str = ""
    fallback: tuple[float, ...] = ()


@dataclass(frozen=True)
class Program:
    """Functions of a network, and what they read.

    Attributes:
        functions: GLSL for ``layers/graph.glsl``.
        numbers: for its block, four for each row.
        images: that it reads.
        geometry: that it reads.
        animated: whether it reads the time.
    """

    functions: str
    numbers: tuple[float, ...]
    images: tuple[ImageUse, ...]
    geometry: tuple[GeometryUse, ...]
    animated: bool = False


class ProgramWriter:
    """Writes the program of a network.

    Args:
        network: of a surface that is drawn (`SURFACES`).
        frame: number of the frame, for nodes that read it.
        time_s: its time, seconds.
    """

    def __init__(self, network: Network, frame: float, time_s: float) -> None:
        self._network, self._frame, self._time_s = network, frame, time_s
        self._document = mx.createDocument()
        self._files: dict[str, tuple[Input, Node, tuple[float, ...]]] = {}
        self._primvars: dict[str, tuple[str, tuple[float, ...]]] = {}
        self._names: dict[int, str] = {}
        self.notes: list[str] = []

    def write(self) -> Program:
        """The program. What is left out is in `notes`.

        Raises:
            NetworkError: it has no program.
        """
        try:
            return self._write()
        except (mx.Exception, LookupError, ValueError, TypeError, RuntimeError) as problem:
            raise NetworkError(" ".join(str(problem).split())[:300]) from problem

    def _write(self) -> Program:
        own = mx.createDocument()
        own.importLibrary(library().document)
        for text in self._network.definitions:
            definitions = mx.createDocument()
            mx.readFromXmlString(definitions, text)
            own.importLibrary(definitions)
            self._leave_out_invalid(own, definitions)
        self._document.setDataLibrary(own)
        self._document.setVersionString(_version(self._network.version))
        weight = sum(
            self._network.weights.get(node.category, node_weight(node.category)) for node in self._network.nodes()
        )
        if weight > MOST_WEIGHT:
            raise NetworkError(f"its nodes stand for more than {MOST_WEIGHT:,}")
        wanted = _types(self._network)
        for node in self._network.nodes():
            self._add(node, wanted[id(node)])
        surface = self._document.getNode("surface")
        self._document.upgradeVersion()
        surface = self._document.getNode("surface") or surface
        generator, context = library().generator(own)
        shader = generator.generate("surface", surface, context)
        return self._program(shader)

    def _leave_out_invalid(self, own: mx.Document, definitions: mx.Document) -> None:
        """Remove those of some definitions that join outputs to inputs of another type, or lack an input."""
        for name in [graph.getQualifiedName(graph.getName()) for graph in definitions.getNodeGraphs()]:
            graph = own.getNodeGraph(name)
            if graph is None:
                continue
            is_valid, message = graph.validate()
            if not is_valid:
                self.notes.append(f"the definition {name} is not valid ({' '.join(message.split())[:200]})")
                own.removeNodeDef(graph.getNodeDefString())
                own.removeNodeGraph(name)

    def _add(self, node: Node, kind: str) -> None:
        is_surface = node is self._network.surface
        name = "surface" if is_surface else f"n{len(self._names)}"
        category, definition = PREFIX + node.category if is_surface else node.category, ""
        library_document = self._document.getDataLibrary()
        if not is_surface and node.definition:
            found = library_document.getNodeDef(node.definition)
            if found is not None:
                category, kind, definition = found.getNodeString(), found.getType(), node.definition
        if not IDENTIFIER.fullmatch(category) or not IDENTIFIER.fullmatch(kind):
            return self._leave_out(node)
        made = self._document.addNode(category, name, kind)
        if definition:
            made.setNodeDefString(definition)
        if node.namespace and IDENTIFIER.fullmatch(node.namespace):
            made.setNamespace(node.namespace)
        choices = library_document.getMatchingNodeDefs(made.getQualifiedName(category))
        is_own = node.category in self._network.weights
        for key, each in node.inputs.items():
            key = OWN + key if is_own else key
            if IDENTIFIER.fullmatch(key) and (not is_surface or key in SURFACES[node.category].inputs):
                self._add_input(made, node, key, each, choices)
        if made.getNodeDef() is None and self._document.getVersionString() >= "1.39":
            self._document.removeNode(name)
            return self._leave_out(node)
        self._names[id(node)] = name
        return None

    def _leave_out(self, node: Node) -> None:
        label = node.category or node.definition
        self.notes.append(f"node {node.name or label} is a {label[:60]}, which the library of MaterialX does not have")

    def _add_input(self, made: mx.Node, node: Node, key: str, given: Input, choices: list[mx.NodeDef]) -> None:
        kind = given.type
        theirs = [each for each in (d.getActiveInput(key) for d in choices) if each is not None]
        if theirs and kind not in {each.getType() for each in theirs}:
            kind = theirs[0].getType()
        if not IDENTIFIER.fullmatch(kind):
            return
        if given.source is not None:
            name = self._names.get(id(given.source.node))
            if name is None:
                return
            output = given.source.output
            if output and given.source.node.category in self._network.weights:
                output = OWN + output
            theirs_type = self._type_of(name, output)
            if theirs_type != kind:
                self.notes.append(f"{key} of {node.name or node.category} is a {kind}, and is fed by a {theirs_type}")
                return
            element = made.addInput(key, kind)
            element.setNodeName(name)
            if output and IDENTIFIER.fullmatch(output):
                element.setOutputString(output)
            return
        if given.value is None:
            return
        text = self._value(node, key, kind, given)
        if text is None:
            self.notes.append(f"{key} of {node.name or node.category} is no {kind}: {given.value[:40]!r}")
            return
        element = made.addInput(key, kind)
        element.setValueString(text)
        if kind in ("color3", "color4") and IDENTIFIER.fullmatch(given.color_space):
            element.setColorSpace(given.color_space)

    def _type_of(self, name: str, output: str) -> str:
        """Type of an output of a node that was added."""
        made = self._document.getNode(name)
        definition = made.getNodeDef()
        found = definition.getActiveOutput(output) if definition is not None and output else None
        return str(found.getType() if found is not None else made.getType())

    def _value(self, node: Node, key: str, kind: str, given: Input) -> str | None:
        """Text of a value, or None where it cannot be used."""
        value = given.value or ""
        if kind == "filename":
            name = f"f{len(self._files)}"
            self._files[name] = (given, node, numbers_of(node.inputs.get("default")))
            return name
        if kind == "string":
            if key == "geomprop":
                return self._primvar(value, numbers_of(node.inputs.get("default")))
            return value if _WORD.fullmatch(value) else None
        if kind == "boolean":
            return value if value in ("true", "false") else None
        numbers = _numbers(value)
        if len(numbers) != _WIDTHS.get(kind):
            return None
        if node is self._network.surface and node.category == "UsdPreviewSurface" and key == "opacity":
            numbers = (max(numbers[0], LEAST_GLASS_OPACITY),)  # it keeps its highlights
        return ", ".join(str(int(number)) if kind == "integer" else f"{number:.9g}" for number in numbers)

    def _primvar(self, name: str, fallback: tuple[float, ...]) -> str | None:
        for known, (primvar, _) in self._primvars.items():
            if primvar == name:
                return known
        if not name or len(name) > 256:
            return None
        self._primvars[f"p{len(self._primvars)}"] = (name, fallback)
        return f"p{len(self._primvars) - 1}"

    def _program(self, shader: mx_shader.Shader) -> Program:
        stage = shader.getStage("pixel")
        text = shader.getSourceCode("pixel")
        if len(text) > _MOST_TEXT:
            raise NetworkError("it needs a shader that is too long")
        ports = {port.getName(): port for block in stage.getUniformBlocks().values() for port in block}
        numbers = _Numbers()
        images: list[ImageUse] = []
        declared: list[str] = []
        set_first: list[str] = []
        animated = False
        for line in text.splitlines():
            found = _UNIFORM.match(line)
            if found is None:
                continue
            kind, name, array, value = found.groups()
            if kind == "sampler2D":
                if len(images) >= MOST_IMAGES:
                    raise NetworkError(f"it reads more than {MOST_IMAGES} images")
                declared.append(f"uniform sampler2D {name}_map;\n#define {name} {name}_map")
                images.append(self._image(name, ports[name]))
            elif name in ("u_time", "u_frame"):
                animated = True
                declared.append(f"float {name};")
                set_first.append(f"{name} = {numbers.put((self._time_s if name == 'u_time' else self._frame,))}.x;")
            elif name == "u_viewPosition":
                declared.append(f"vec3 {name};")
                set_first.append(f"{name} = graph_eye;")
            elif array is None and ports[name].getType().getName() in _WIDTHS and ports[name].getValue() is not None:
                kind_name, held = ports[name].getType().getName(), _numbers(ports[name].getValue().getValueString())
                declared.append(f"{kind} {name};")
                set_first.append(f"{name} = {numbers.as_glsl(kind_name, held)};")
            else:
                declared.append(f"const {kind} {name}{array or ''}{value or f' = {kind}(0)'};")
        members, geometry = [], []
        for block in stage.getInputBlocks().values():
            for port in block:
                use, expression = self._geometry(port.getName(), port.getType().getName())
                geometry.append(use)
                members.append(f"{_glsl_type(port.getType().getName())} {port.getName()};")
                set_first.append(f"vd.{port.getName()} = {expression};")
        if members:
            declared.append("struct GraphVertex { " + " ".join(members) + " } vd;")
        functions = _functions(text, "\n".join(declared), "\n    ".join(set_first))
        kept = tuple(dict.fromkeys(use for use in geometry if use is not None))
        return Program(functions, numbers.all(), tuple(images), kept, animated)

    def _image(self, name: str, port: mx_shader.ShaderPort) -> ImageUse:
        value = port.getValue()
        file = value.getValueString() if value is not None else ""
        if file in self._files:
            given, node, fallback = self._files[file]
            return ImageUse(name, given, node, fallback)
        return ImageUse(name, Input("filename", file, folder=self._network.folder), None, ())

    def _geometry(self, name: str, kind: str) -> tuple[GeometryUse | None, str]:
        """Use of the geometry by a member of the vertex data, and the expression of its value."""
        glsl = _glsl_type(kind)
        if name.startswith("texcoord_"):
            number = name.removeprefix("texcoord_")
            use = GeometryUse("uv", "st" if number == "0" else f"st{number}")
            return use, "graph_uv" if glsl == "vec2" else f"{glsl}(graph_uv, 0.0)"
        if name.startswith("color_"):
            return GeometryUse("color", "displayColor"), _part(glsl, "graph_color")
        if name.startswith("i_geomprop_"):
            primvar, fallback = self._primvars.get(
                name.removeprefix("i_geomprop_"), (name.removeprefix("i_geomprop_"), ())
            )
            if glsl == "vec2":
                return GeometryUse("uv", primvar, fallback), "graph_uv"
            if glsl in ("vec3", "vec4"):
                return GeometryUse("color", primvar, fallback), _part(glsl, "graph_color")
            return GeometryUse("number", primvar, fallback), f"{glsl}(graph_color.a)"
        place = {
            "positionWorld": "graph_position",
            "normalWorld": "graph_normal",
            "tangentWorld": "graph_tangent",
            "bitangentWorld": "graph_bitangent",
            "tangentObject": "graph_tangent",
            "bitangentObject": "graph_bitangent",
        }
        if name in place:
            return None, place[name]
        if name == "positionObject":
            return GeometryUse("place"), "graph_color.xyz"
        if name == "normalObject":
            return GeometryUse("place"), "graph_object_normal()"
        raise NetworkError(f"it reads {name} of the geometry")


class _Numbers:
    """Numbers of a program, in rows of four."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []

    def put(self, values: tuple[float, ...]) -> str:
        """Keep up to four numbers, and return the row."""
        self._rows.append((*values, *(0.0,) * (4 - len(values))))
        return f"graph.numbers[{len(self._rows) - 1}]"

    def as_glsl(self, kind: str, values: tuple[float, ...]) -> str:
        """Keep the value of a type, and return the expression that reads it."""
        if kind == "matrix33":
            return "mat3(" + ", ".join(self.put(values[i : i + 3]) + ".xyz" for i in (0, 3, 6)) + ")"
        if kind == "matrix44":
            return "mat4(" + ", ".join(self.put(values[i : i + 4]) for i in (0, 4, 8, 12)) + ")"
        return _GLSL[kind].format(self.put(values))

    def all(self) -> tuple[float, ...]:
        """All numbers, at least one row."""
        return tuple(number for row in self._rows or [(0.0,) * 4] for number in row)


def _types(network: Network) -> dict[int, str]:
    """Type of each node: its own, or that of an input that it feeds."""
    surface = library().document.getNodeDef(SURFACES[network.surface.category].definition)
    types = {id(node): node.type for node in network.nodes()}
    for node in reversed(list(network.nodes())):
        for name, each in node.inputs.items():
            if each.source is not None and not types[id(each.source.node)]:
                theirs = surface.getActiveInput(name) if node is network.surface else None
                types[id(each.source.node)] = theirs.getType() if theirs is not None else each.type or types[id(node)]
    types[id(network.surface)] = "float"
    return types


def _numbers(text: str) -> tuple[float, ...]:
    """Numbers of a value; none where some are too large or there are other words."""
    if text in ("true", "false"):
        return (float(text == "true"),)
    parts = [part for part in re.split(r"[\s,]+", text.strip()) if part] if len(text) <= 1_000 else [""]
    if not all(_NUMBER.fullmatch(part) for part in parts):
        return ()
    values = tuple(float(part) for part in parts)
    return values if all(math.isfinite(value) and abs(value) <= _MOST for value in values) else ()


def numbers_of(given: Input | None) -> tuple[float, ...]:
    """Numbers of an input's value; none where it has none, or no finite ones."""
    return _numbers(given.value) if given is not None and given.value is not None else ()


def _version(text: str) -> str:
    return text if re.fullmatch(r"1\.\d\d", text) else "1.38"


def _glsl_type(kind: str) -> str:
    return {"vector2": "vec2", "vector3": "vec3", "color3": "vec3", "vector4": "vec4", "color4": "vec4"}.get(
        kind, {"integer": "int", "boolean": "bool"}.get(kind, "float")
    )


def _part(glsl: str, color: str) -> str:
    return {"vec4": color, "vec3": f"{color}.xyz", "vec2": f"{color}.xy"}.get(glsl, f"{glsl}({color}.x)")


def _functions(text: str, declared: str, set_first: str) -> str:
    """The functions of a fragment shader, with other declarations, and ``main`` under the name that we call."""
    lines, in_block = [], False
    for line in text.splitlines():
        if line.startswith("in VertexData"):
            in_block = True
        elif in_block:
            in_block = not line.startswith("}")
        elif not line.startswith(("#version", "uniform ", "#define material ")):
            lines.append("vec4 out1;" if line.startswith("out vec4 out1") else line)
    body = "\n".join(lines)
    first = body.index("vec4 out1;")
    body = f"{body[:first]}{declared}\n{body[first:]}"
    body = re.sub(r"\btexture\(", "graph_texture(", body)
    body = re.sub(r"(for \(int \w+ = 0;\s+\w+ < )octaves;", rf"\1min(octaves, {MOST_OCTAVES});", body)
    before, after = body.split("void main()\n{\n", 1)
    return f"{before}void evaluate_nodes()\n{{\n    {set_first}\n{after}"
