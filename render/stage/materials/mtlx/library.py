"""MaterialX's standard library of nodes, with the surfaces that are drawn here; loaded when a material needs it."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import MaterialX as mx
from MaterialX import PyMaterialXGenGlsl as mx_glsl
from MaterialX import PyMaterialXGenShader as mx_shader

from render.stage.materials.mtlx.surfaces import SURFACES

_FOLDERS = ("targets", "stdlib", "pbrlib", "bxdf", "cmlib")
PREFIX = "drawn_"
"""Prefix of the categories of our own surfaces."""


@dataclass(frozen=True, eq=False)
class Library:
    """Definitions, and what writes GLSL for nodes of them.

    Attributes:
        document: the definitions.
        search_path: where their code lies.
    """

    document: mx.Document
    search_path: mx.FileSearchPath

    def generator(self, definitions: mx.Document) -> tuple[mx_shader.ShaderGenerator, mx_shader.GenContext]:
        """Generator of GLSL, and its context, for nodes of some definitions."""
        generator = mx_glsl.GlslShaderGenerator.create()
        context = mx_shader.GenContext(generator)
        options = context.getOptions()
        options.shaderInterfaceType = mx_shader.ShaderInterfaceType.SHADER_INTERFACE_COMPLETE
        options.fileTextureVerticalFlip = True
        options.hwMaxActiveLightSources = 0
        options.targetColorSpaceOverride = "lin_rec709"
        options.elideConstantNodes = False
        context.registerSourceCodeSearchPath(self.search_path)
        colors = mx_shader.DefaultColorManagementSystem.create(generator.getTarget())
        colors.loadLibrary(definitions)
        generator.setColorManagementSystem(colors)
        return generator, context


@functools.cache
def library() -> Library:
    """The library, which takes about 50 ms to read."""
    search_path = mx.getDefaultDataSearchPath()
    document = mx.createDocument()
    mx.loadLibraries([f"libraries/{folder}" for folder in _FOLDERS], search_path, document)
    own = mx.createDocument()
    for category, surface in SURFACES.items():
        theirs = document.getNodeDef(surface.definition) if surface.definition else None
        definition = own.addNodeDef(f"ND_{PREFIX}{category}", "float", PREFIX + category)
        for name in surface.inputs:
            if theirs is not None:
                definition.addInput(name).copyContentFrom(theirs.getActiveInput(name))
                continue
            kind, value = surface.own[name]
            if value:
                definition.addInput(name, kind).setValueString(value)
            else:
                definition.addInput(name, kind).setDefaultGeomPropString("Nworld")
        implementation = own.addImplementation(f"IM_{PREFIX}{category}")
        implementation.setNodeDef(definition)
        implementation.setTarget("genglsl")
        implementation.setFunction(f"surface_{category}")
        implementation.setAttribute("sourcecode", "// in layers/graph_surfaces.glsl")
    document.importLibrary(own)
    return Library(document, search_path)


def drawn_definition(category: str) -> mx.NodeDef:
    """Definition of our own surface of a category of `SURFACES`."""
    return library().document.getNodeDef(f"ND_{PREFIX}{category}")


@functools.cache
def is_known(category: str) -> bool:
    """Whether the library has nodes of a category."""
    return bool(library().document.getMatchingNodeDefs(category))
