"""Programs of networks, out of the fragment shaders that MaterialX's generator writes.

The functions of such a shader are kept. What it declares, uniforms and the data of vertices, they get from ``layers/graph.glsl``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from MaterialX import PyMaterialXGenShader as mx_shader

from render.stage.materials.mtlx.network import Input, NetworkError, Node
from render.stage.materials.mtlx.slots import COORDINATES, DISPLAY_COLOR, GeometryUse, expression_of, place_uses
from render.stage.materials.mtlx.values import WIDTHS, parse_numbers

MOST_IMAGES = 16
"""Images of one network: the units of textures that materials may have (`render.layers.renderer`)."""
MOST_OCTAVES = 16
_MOST_TEXT = 1_000_000
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


@dataclass(eq=False)
class ProgramReader:
    """Reads the program of a network from its shader.

    Attributes:
        files: the input, node and fallback of each image, by the name that stands for its file.
        primvars: name and fallback of each primvar, by the name that stands for it.
        folder: of the files that definitions of the network name.
        frame: number of the frame.
        time_s: its time, seconds.
    """

    files: Mapping[str, tuple[Input, Node, tuple[float, ...]]]
    primvars: Mapping[str, tuple[str, tuple[float, ...]]]
    folder: str
    frame: float
    time_s: float

    def read(self, shader: mx_shader.Shader) -> Program:
        """The program.

        Raises:
            NetworkError: it is too long, reads too many images, or reads what geometries do not have.
        """
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
                set_first.append(f"{name} = {numbers.put((self.time_s if name == 'u_time' else self.frame,))}.x;")
            elif name == "u_viewPosition":
                declared.append(f"vec3 {name};")
                set_first.append(f"{name} = graph_eye;")
            elif array is None and ports[name].getType().getName() in WIDTHS and ports[name].getValue() is not None:
                kind_name, held = (
                    ports[name].getType().getName(),
                    parse_numbers(ports[name].getValue().getValueString()),
                )
                declared.append(f"{kind} {name};")
                set_first.append(f"{name} = {numbers.as_glsl(kind_name, held)};")
            else:
                declared.append(f"const {kind} {name}{array or ''}{value or f' = {kind}(0)'};")
        members, vertex_ports = [], [port for block in stage.getInputBlocks().values() for port in block]
        read = [self._geometry(port.getName(), port.getType().getName()) for port in vertex_ports]
        geometry = iter(place_uses(use for use, _ in read if use is not None))
        kept: dict[GeometryUse, None] = {}
        for port, (use, expression) in zip(vertex_ports, read, strict=True):
            glsl = _glsl_type(port.getType().getName())
            if use is not None:
                use = next(geometry)
                kept[use] = None
            members.append(f"{glsl} {port.getName()};")
            value = expression_of(use, glsl) if use is not None and not expression else expression
            set_first.append(f"vd.{port.getName()} = {value};")
        if members:
            declared.append("struct GraphVertex { " + " ".join(members) + " } vd;")
        functions = _functions(text, "\n".join(declared), "\n    ".join(set_first))
        return Program(functions, numbers.all(), tuple(images), tuple(kept), animated)

    def _image(self, name: str, port: mx_shader.ShaderPort) -> ImageUse:
        value = port.getValue()
        file = value.getValueString() if value is not None else ""
        if file in self.files:
            given, node, fallback = self.files[file]
            return ImageUse(name, given, node, fallback)
        return ImageUse(name, Input("filename", file, folder=self.folder), None, ())

    def _geometry(self, name: str, kind: str) -> tuple[GeometryUse | None, str]:
        """Use of the geometry by a member of the vertex data, and the expression of its value where it has no primvar."""
        if name.startswith("texcoord_"):
            number = name.removeprefix("texcoord_")
            return GeometryUse("uv", COORDINATES if number == "0" else f"{COORDINATES}{number}"), ""
        if name.startswith("color_"):
            return GeometryUse("color", DISPLAY_COLOR), ""
        if name.startswith("i_geomprop_"):
            known = name.removeprefix("i_geomprop_")
            primvar, fallback = self.primvars.get(known, (known, ()))
            uses = {"vector2": "uv", "color3": "color", "color4": "color", "vector3": "vector", "vector4": "vector"}
            return GeometryUse(uses.get(kind, "number"), primvar, fallback), ""
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


def _glsl_type(kind: str) -> str:
    return {"vector2": "vec2", "vector3": "vec3", "color3": "vec3", "vector4": "vec4", "color4": "vec4"}.get(
        kind, {"integer": "int", "boolean": "bool"}.get(kind, "float")
    )


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
