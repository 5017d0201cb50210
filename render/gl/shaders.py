"""Shader sources: files in ``render/shaders``, with ``#include "name"`` and defines put in after ``#version``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import moderngl

from render.errors import GraphicsError

SHADER_DIR = Path(__file__).parent.parent / "shaders"
_INCLUDE = re.compile(r'^[ \t]*#include[ \t]+"([^"]+)"[ \t]*$', re.MULTILINE)
_VERSION = re.compile(r"^[ \t]*#version[^\n]*\n", re.MULTILINE)

Defines = Mapping[str, int | float | str]


@cache
def _expand(name: str, open_files: tuple[str, ...] = ()) -> str:
    path = SHADER_DIR / name
    if name in open_files:
        raise GraphicsError(f"shader {name} includes itself through {' > '.join(open_files)}")
    if not path.is_file():
        raise GraphicsError(f"shader {name} is missing from {SHADER_DIR.name}/")
    return _INCLUDE.sub(lambda match: _expand(match[1], (*open_files, name)), path.read_text(encoding="utf-8"))


def load_source(name: str, defines: Defines | None = None) -> str:
    """Source text of a shader file with its includes and the given defines.

    Raises:
        GraphicsError: the file or one that it includes is missing or includes itself, or there is no ``#version`` line.
    """
    text = _expand(name)
    version = _VERSION.search(text)
    if version is None:
        raise GraphicsError(f"shader {name} has no #version line")
    lines = "".join(f"#define {key} {value}\n" for key, value in (defines or {}).items())
    return text[: version.end()] + lines + text[version.end() :]


def set_uniforms(program: moderngl.ComputeShader | moderngl.Program, **values: object) -> None:
    """Set uniforms by name; those that this variant of a shader does not read are passed over."""
    for name, value in values.items():
        if name in program:
            program[name] = value


class ProgramCache:
    """Compiled moderngl programs by file names and defines, for one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._compute: dict[tuple[object, ...], moderngl.ComputeShader] = {}
        self._drawing: dict[tuple[object, ...], moderngl.Program] = {}

    def compute(self, name: str, defines: Defines | None = None) -> moderngl.ComputeShader:
        """The compute program of a ``.comp`` file.

        Raises:
            GraphicsError: the driver refuses it; the message holds its log.
        """
        key = (name, *sorted((defines or {}).items()))
        if key not in self._compute:
            try:
                self._compute[key] = self._ctx.compute_shader(load_source(name, defines))
            except moderngl.Error as error:
                raise GraphicsError(f"shader {name} did not compile: {error}") from error
        return self._compute[key]

    def drawing(self, vertex: str, fragment: str, defines: Defines | None = None) -> moderngl.Program:
        """The program of a ``.vert`` and a ``.frag`` file, both with the same defines.

        Raises:
            GraphicsError: the driver refuses it; the message holds its log.
        """
        key = (vertex, fragment, *sorted((defines or {}).items()))
        if key not in self._drawing:
            try:
                self._drawing[key] = self._ctx.program(load_source(vertex, defines), load_source(fragment, defines))
            except moderngl.Error as error:
                raise GraphicsError(f"shaders {vertex} and {fragment} did not compile: {error}") from error
        return self._drawing[key]
