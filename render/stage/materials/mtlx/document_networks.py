"""Networks of the materials of MaterialX documents.

References are followed as the specification has them (MaterialX 1.39, "Node Graph Elements"): a node by ``nodename``, a graph's
output by ``nodegraph`` and ``output``, and an input of the graph by ``interfacename``. Surfaces that a document defines by
other surfaces are taken apart; other nodes that it defines are left whole.
"""

from __future__ import annotations

import copy
import math
import xml.etree.ElementTree as ET
from collections.abc import Container
from dataclasses import dataclass, field, replace

from render.stage.materials.mtlx.documents import Document
from render.stage.materials.mtlx.library import PREFIX, is_known
from render.stage.materials.mtlx.network import (
    IDENTIFIER,
    MOST_DEPTH,
    MOST_NODES,
    MOST_WEIGHT,
    OWN,
    Input,
    Link,
    Network,
    NetworkError,
    Node,
    node_weight,
)

_ENDLESS = "/"  # category of no node
_MOST_HOPS = 30
"""Inputs and outputs of graphs from an input to the node that feeds it."""
_CLOSURES = {"surfaceshader", "BSDF", "EDF"}
"""Types of what light does: nodes that a document defines are taken apart where they give one."""
_NOT_NODES = ("input", "output", "nodedef", "nodegraph", "implementation", "token", "geominfo", "look", "collection")


@dataclass(eq=False)
class _Scope:
    """Place that names are looked up in: a document, or one of its graphs.

    Attributes:
        element: of the document or graph.
        document: that it stands in.
        interface: inputs of the graph as the node that stands for it gives them; None for the graph's own.
        children: elements by tag and name.
        nodes: those that were read, by name.
    """

    element: ET.Element
    document: Document
    prefix: str = ""
    color_space: str = ""
    interface: dict[str, Input] | None = None
    children: dict[tuple[str, str | None], ET.Element] = field(default_factory=dict)
    nodes: dict[str, Node] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.prefix += self.element.get("fileprefix") or ""
        self.color_space = self.element.get("colorspace") or self.color_space
        for child in self.element:
            self.children.setdefault((child.tag, child.get("name")), child)
            if child.tag not in _NOT_NODES:
                self.children.setdefault(("*", child.get("name")), child)

    def find(self, tag: str, name: str | None) -> ET.Element | None:
        """Child of a tag, or a node for ``*``, with a name; None where there is none."""
        return None if name is None else self.children.get((tag, name))


class DocumentNetworks:
    """Reads the materials of a document.

    Args:
        document: it.
    """

    def __init__(self, document: Document) -> None:
        self._document = document
        self._weights = _weights_of(document)
        self._definitions = tuple(_definitions(document, self._weights))
        self._own = _own_surfaces(document)

    def material(self, name: str) -> Network | None:
        """Network of the material of a name; None where there is none, or none with a surface.

        Raises:
            NetworkError: its nodes have no end, or there are too many.
        """
        for document in (self._document, *_all_included(self._document)):
            reader = _Reader(document, self._own)
            try:
                surface = reader.surface_of(name)
            except RecursionError as problem:
                raise NetworkError("its nodes lie too far behind each other") from problem
            if surface is not None:
                return Network(
                    surface,
                    self._definitions,
                    document.version,
                    document.folder,
                    self._weights,
                    reader.displacement_of(name),
                    tuple(reader.notes),
                )
        return None


def _all_included(document: Document) -> list[Document]:
    found: list[Document] = []
    for each in document.included:
        found += [each, *_all_included(each)]
    return found


class _Reader:
    def __init__(self, document: Document, own: dict[str, tuple[ET.Element, ET.Element, Document]]) -> None:
        self._root = _Scope(document.root, document)
        self._graphs: dict[str, _Scope] = {}
        self._own = own
        self._count = 0
        self._depth = self._hops = 0
        self.notes: list[str] = []

    def surface_of(self, name: str) -> Node | None:
        material = self._root.find("surfacematerial", name)
        link = _child(material, "input", "surfaceshader") if material is not None else None
        if link is None:
            return None
        found = self._input(link, self._root)
        return found.source.node if found.source is not None else None

    def displacement_of(self, name: str) -> Node | None:
        """Node of the displacement of the material of a name: one of no category where it cannot be read."""
        material = self._root.find("surfacematerial", name)
        link = _child(material, "input", "displacementshader") if material is not None else None
        if link is None:
            return None
        try:
            found = self._input(link, self._root)
        except (NetworkError, RecursionError):
            return Node("", "displacementshader")
        return found.source.node if found.source is not None else Node("", "displacementshader")

    def _node(self, scope: _Scope, name: str) -> Node | None:
        if name in scope.nodes:
            return scope.nodes[name]
        element = scope.find("*", name)
        if element is None:
            return None
        self._count += 1
        self._depth += 1
        if self._count > MOST_NODES or self._depth > MOST_DEPTH:
            raise NetworkError(
                f"it has more than {MOST_NODES:,} nodes, or {MOST_DEPTH} behind each other, or a circle of them"
            )
        node = Node(
            element.tag,
            element.get("type") or "",
            definition=element.get("nodedef") or "",
            namespace=element.get("namespace") or "",
            name=name,
        )
        hops, self._hops = self._hops, 0
        for child in element.findall("input"):
            node.inputs[child.get("name") or ""] = self._input(child, scope, element)
        self._hops = hops
        self._depth -= 1
        node = self._taken_apart(node)
        scope.nodes[name] = node
        return node

    def _taken_apart(self, node: Node) -> Node:
        """The surface or lobe inside one that the document defines; any other node as it is."""
        if is_known(node.category) or node.category not in self._own:
            return node
        definition, graph, document = self._own[node.category]
        interface = {each.get("name") or "": self._input(each, self._root) for each in definition.findall("input")}
        scope = _Scope(graph, document, interface=interface | node.inputs)
        output = graph.find("output")
        self._depth += 1
        inside = self._node(scope, (output.get("nodename") if output is not None else None) or "")
        self._depth -= 1
        return inside or node

    def _input(self, element: ET.Element, scope: _Scope, owner: ET.Element | None = None) -> Input:
        self._hops += 1
        if self._hops > _MOST_HOPS:
            raise NetworkError(f"an input leads through more than {_MOST_HOPS} others, or a circle of them")
        found = self._read_input(element, scope, owner)
        self._hops -= 1
        return found

    def _read_input(self, element: ET.Element, scope: _Scope, owner: ET.Element | None) -> Input:
        kind = element.get("type") or ""
        space = (
            element.get("colorspace") or (owner.get("colorspace") if owner is not None else None) or scope.color_space
        )
        interface = element.get("interfacename")
        if interface is not None:
            found = self._of_interface(scope, interface) or Input(kind, element.get("value"), None, space)
            return found if found.color_space else replace(found, color_space=space)
        graph, name = element.get("nodegraph"), element.get("nodename")
        if graph is not None:
            given = self._of_graph(graph, element.get("output"))
            if given is not None:
                return given
        elif name is not None:
            node = self._node(scope, name)
            if node is not None:
                return Input(kind, source=Link(node, element.get("output") or ""))
        if graph is not None or name is not None:
            owned = f"{element.get('name')} of {owner.get('name')}" if owner is not None else element.get("name") or ""
            self.notes.append(f"{owned[:60]} is fed by {(graph or name or '')[:60]}, which the document does not have")
        value = element.get("value")
        if kind == "filename" or element.get("name") == "file":
            prefix = scope.prefix + ((owner.get("fileprefix") if owner is not None else None) or "")
            return Input("filename", prefix + (value or ""), None, space, scope.document.folder)
        return Input(kind, value, None, space)

    def _of_interface(self, scope: _Scope, name: str) -> Input | None:
        if scope.interface is not None:
            return scope.interface.get(name)
        own = _child(scope.element, "input", name)
        return self._input(own, self._root) if own is not None else None

    def _of_graph(self, name: str, output: str | None) -> Input | None:
        if name not in self._graphs:
            element = self._root.find("nodegraph", name)
            if element is None:
                return None
            self._graphs[name] = _Scope(element, self._root.document, self._root.prefix, self._root.color_space)
        scope = self._graphs[name]
        element = _child(scope.element, "output", output) if output is not None else scope.element.find("output")
        if element is None or element.get("nodegraph") is not None:
            return None
        return self._input(element, scope)


def _child(parent: ET.Element, tag: str, name: str) -> ET.Element | None:
    return next((child for child in parent.findall(tag) if child.get("name") == name), None)


def _graphs_of(document: Document) -> dict[str | None, ET.Element]:
    """Graphs that implement definitions, by the names of these."""
    graphs = document.root.findall("nodegraph")
    named = {graph.get("name"): graph for graph in graphs}
    found = {graph.get("nodedef"): graph for graph in graphs}
    for each in document.root.findall("implementation"):
        if each.get("nodegraph") in named:
            found.setdefault(each.get("nodedef"), named[each.get("nodegraph")])
    return found


def _own_surfaces(document: Document) -> dict[str, tuple[ET.Element, ET.Element, Document]]:
    """Definition, graph and document of the surfaces and lobes that a document defines, by category."""
    found = {}
    for each in (document, *_all_included(document)):
        graphs = _graphs_of(each)
        for definition in each.root.findall("nodedef"):
            outputs = [output.get("type") for output in definition.findall("output")]
            graph = graphs.get(definition.get("name"))
            if len(outputs) == 1 and outputs[0] in _CLOSURES and graph is not None:
                found[definition.get("node") or ""] = (definition, graph, each)
    return found


def _definitions(document: Document, usable: Container[str]) -> list[str]:
    """Documents that hold the usable definitions of nodes, other than surfaces, of a document and of those that it includes.

    Definitions whose code lies in a file are left out. Not usable are those that lead back to themselves or to too many nodes,
    those that inherit from others, those of a category that the library has, and those with names that GLSL does not take.
    """
    found = []
    for each in (document, *_all_included(document)):
        root = ET.Element("materialx", {"version": each.version})
        namespace = each.root.get("namespace")
        if namespace is not None and IDENTIFIER.fullmatch(namespace):
            root.set("namespace", namespace)
        graphs = _graphs_of(each)
        for definition in each.root.findall("nodedef"):
            graph = graphs.get(definition.get("name"))
            types = [output.get("type") for output in definition.findall("output")]
            if graph is not None and not set(types) & _CLOSURES and definition.get("node") in usable:
                root.extend(_with_own_names(definition, graph, usable))
        if len(root):
            found.append(ET.tostring(root, encoding="unicode"))
    return found


def _with_own_names(definition: ET.Element, graph: ET.Element, usable: Container[str]) -> tuple[ET.Element, ET.Element]:
    """Copies of a definition and its graph, in which what they declare has the prefix `OWN`."""
    definition, graph = copy.deepcopy(definition), copy.deepcopy(graph)
    graph.set("nodedef", definition.get("name") or "")
    for element in (*definition.findall("input"), *definition.findall("output"), *graph.findall("output"), graph):
        element.set("name", OWN + (element.get("name") or ""))
    own = {node.get("name") for node in graph if node.tag in usable}
    for node in graph:
        if node.tag not in _NOT_NODES:
            node.set("name", OWN + (node.get("name") or ""))
        for element in (node, *node.findall("input")):
            if element.get("output") is not None and element.get("nodename") in own:
                element.set("output", OWN + (element.get("output") or ""))
            for key in ("nodename", "interfacename"):
                if element.get(key) is not None:
                    element.set(key, OWN + (element.get(key) or ""))
            if element is not node and node.tag in usable:
                element.set("name", OWN + (element.get("name") or ""))
    return definition, graph


def _weights_of(document: Document) -> dict[str, float]:
    """Weights of the nodes that a document and those that it includes define by other nodes, by category."""
    inside: dict[str, list[str]] = {}
    for each in (document, *_all_included(document)):
        graphs = _graphs_of(each)
        for definition in each.root.findall("nodedef"):
            graph = graphs.get(definition.get("name"))
            if graph is not None and not is_known(definition.get("node") or ""):
                nodes = [child.tag for child in graph if child.tag not in _NOT_NODES]
                names = [
                    *_primvars(graph),
                    *(element.get("name") or "" for element in (*graph.iter(), *definition.iter())),
                ]
                plain = all(IDENTIFIER.fullmatch(name) and not name.startswith("gl_") for name in names)
                plain = plain and definition.get("inherit") is None and not any(map(_is_ours, graph))
                inside.setdefault(definition.get("node") or "", []).extend(nodes if plain else [_ENDLESS])
    weights: dict[str, float] = {_ENDLESS: math.inf}
    found = {category: _weight(category, inside, weights, 0) for category in inside}
    return {category: weight for category, weight in found.items() if weight <= MOST_WEIGHT}


def _is_ours(node: ET.Element) -> bool:
    """Whether a node is of our own surfaces' definitions."""
    return node.tag.startswith(PREFIX) or (node.get("nodedef") or "").startswith(f"ND_{PREFIX}")


def _weight(category: str, inside: dict[str, list[str]], weights: dict[str, float], depth: int) -> float:
    """Weight of the nodes that a node stands for; infinite where they have no end."""
    if category not in inside and category not in weights:
        return node_weight(category)
    if category not in weights:
        weights[category] = math.inf  # for one that leads back here
        if depth < MOST_DEPTH:
            weights[category] = sum(_weight(each, inside, weights, depth + 1) for each in inside[category])
    return weights[category]


def _primvars(graph: ET.Element) -> list[str]:
    return [each.get("value") or "" for each in graph.iter("input") if each.get("name") == "geomprop"]
