"""GLSL for a network of MaterialX, by the generator of the MaterialX package.

The network is written as a document of its own first, with plain names and checked values: nothing that a file says reaches the
package as it is, but for definitions of nodes by other nodes. What the generator writes is the whole fragment shader of a surface
that is ours (`render.stage.materials.mtlx.library`), of which `render.stage.materials.mtlx.programs` keeps the functions.
"""

from __future__ import annotations

import re

import MaterialX as mx

from render.model.scene import LEAST_GLASS_OPACITY
from render.stage.materials.mtlx.library import PREFIX, drawn_definition, library
from render.stage.materials.mtlx.mixes import mixed_surfaces
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
from render.stage.materials.mtlx.programs import Program, ProgramReader
from render.stage.materials.mtlx.surfaces import MIXED, SURFACES
from render.stage.materials.mtlx.values import WIDTHS, numbers_of, parse_numbers

_WORD = re.compile(r"[A-Za-z0-9_ .,+-]{0,64}")


class ProgramWriter:
    """Writes the program of a network.

    Args:
        network: of a surface that is drawn (`render.stage.materials.mtlx.mixes.drawn_network`).
        frame: number of the frame, for nodes that read it.
        time_s: its time, seconds.
    """

    def __init__(self, network: Network, frame: float, time_s: float) -> None:
        self._network, self._frame, self._time_s = network, frame, time_s
        self._surfaces = {id(node) for node in mixed_surfaces(network.surface)}
        self._document = mx.createDocument()
        self._files: dict[str, tuple[Input, Node, tuple[float, ...]]] = {}
        self._primvars: dict[str, tuple[str, tuple[float, ...]]] = {}
        self._names: dict[int, str] = {}
        self._labels: dict[str, str] = {}
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
        wanted = self._types()
        for node in self._network.nodes():
            self._add(node, wanted[id(node)])
        self._document.upgradeVersion()
        self._leave_out_unknown()
        generator, context = library().generator(own)
        shader = generator.generate("surface", self._document.getNode("surface"), context)
        folder = self._network.folder
        return ProgramReader(self._files, self._primvars, folder, self._frame, self._time_s).read(shader)

    def _types(self) -> dict[int, str]:
        """Type of each node: its own, or that of an input that it feeds."""
        nodes = list(self._network.nodes())
        types = {id(node): "float" if id(node) in self._surfaces else node.type for node in nodes}
        for node in reversed(nodes):
            definition = drawn_definition(node.category) if id(node) in self._surfaces else None
            for name, each in node.inputs.items():
                if each.source is not None and not types[id(each.source.node)]:
                    theirs = definition.getActiveInput(name) if definition is not None else None
                    kind = theirs.getType() if theirs is not None else each.type or types[id(node)]
                    types[id(each.source.node)] = kind
        return types

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
        is_surface = id(node) in self._surfaces
        name = "surface" if node is self._network.surface else f"n{len(self._names)}"
        category, definition = PREFIX + node.category if is_surface else node.category, ""
        library_document = self._document.getDataLibrary()
        if not is_surface and node.definition:
            found = library_document.getNodeDef(node.definition)
            if found is not None:
                category, kind, definition = found.getNodeString(), found.getType(), node.definition
        if not is_surface and category.startswith(PREFIX):  # our own definitions, which only surfaces may use
            return self._leave_out(node)
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
        self._labels[name] = node.name or category
        return None

    def _leave_out_unknown(self) -> None:
        """Remove nodes of older versions that today's library does not have, and the links to them."""
        nodes = self._document.getNodes()
        unknown = {made.getName(): made.getCategory() for made in nodes if made.getNodeDef() is None}
        for name, category in unknown.items():
            self._note_unknown(self._labels.get(name, name), category)
            self._document.removeNode(name)
        for made in nodes if unknown else ():
            if made.getName() not in unknown:
                for each in made.getInputs():
                    if each.getNodeName() in unknown:
                        made.removeInput(each.getName())

    def _leave_out(self, node: Node) -> None:
        label = node.category or node.definition
        self._note_unknown(node.name or label, label)

    def _note_unknown(self, name: str, category: str) -> None:
        self.notes.append(f"node {name[:60]} is a {category[:60]}, which the library of MaterialX does not have")

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
            if id(given.source.node) in self._surfaces and (node.category != MIXED or key not in ("bg", "fg")):
                self.notes.append(f"{key} of {node.name or node.category} is a {kind}, and is fed by a surface")
                return
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
        numbers = parse_numbers(value)
        if len(numbers) != WIDTHS.get(kind):
            return None
        if id(node) in self._surfaces and node.category == "UsdPreviewSurface" and key == "opacity":
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


def _version(text: str) -> str:
    return text if re.fullmatch(r"1\.\d\d", text) else "1.38"
