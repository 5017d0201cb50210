"""Sources of the programs that the tests compile, and the branches of shader files that they take."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import moderngl

from render.gl.shaders import SHADER_DIR, load_source
from render.layers.source_program import SourceProgram

_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(\w+)[ \t]*(.*?)[ \t]*(?://.*)?$")
_INCLUDE = re.compile(r'^#include "([^"]+)"', re.MULTILINE)
_WORD = re.compile(r"defined\s*\(\s*(\w+)\s*\)|([A-Za-z_]\w*)")


@dataclass
class CompiledShaders:
    """Sources by stage, and programs of two stages.

    Attributes:
        sources: of each stage, ``vert``, ``frag`` or ``comp``.
        pairs: vertex and fragment source of each program that has both.
    """

    sources: dict[str, set[str]] = field(default_factory=lambda: {"vert": set(), "frag": set(), "comp": set()})
    pairs: set[tuple[str, str]] = field(default_factory=set)

    def add_compute(self, source: str) -> None:
        """Record a compute program."""
        self.sources["comp"].add(source)

    def add_pair(self, vertex: str, fragment: str) -> None:
        """Record a program that draws."""
        self.sources["vert"].add(vertex)
        self.sources["frag"].add(fragment)
        self.pairs.add((vertex, fragment))

    def write(self, file: Path) -> None:
        """Write the programs to a file that `read` reads."""
        sources = {stage: sorted(found) for stage, found in self.sources.items()}
        file.write_text(json.dumps({"sources": sources, "pairs": sorted(self.pairs)}), encoding="utf-8")

    def read(self, file: Path) -> None:
        """Add the programs that another process wrote."""
        written = json.loads(file.read_text(encoding="utf-8"))
        for stage, found in written["sources"].items():
            self.sources[stage].update(found)
        self.pairs.update((vertex, fragment) for vertex, fragment in written["pairs"])

    def of_file(self, name: str) -> list[str]:
        """Recorded sources of a shader file, which they are recognised by: its title is unique."""
        title = load_source(name).splitlines()[1]
        return [source for source in self.sources[name.rpartition(".")[2]] if f"\n{title}\n" in source]


COMPILED = CompiledShaders()
"""Programs that this process has compiled since `record_programs`, and those that it has read."""


def record_programs() -> None:
    """Record each program that moderngl or pyrender compiles from here on."""
    compute, program, add = (
        moderngl.Context.compute_shader,
        moderngl.Context.program,
        SourceProgram._add_to_context,
    )

    def recorded_compute(ctx: moderngl.Context, source: str) -> moderngl.ComputeShader:
        made = compute(ctx, source)
        COMPILED.add_compute(source)
        return made

    def recorded_program(ctx: moderngl.Context, vertex: str, fragment: str, **others: Any) -> moderngl.Program:
        made = program(ctx, vertex, fragment, **others)
        COMPILED.add_pair(vertex, fragment)
        return made

    def recorded_add(made: SourceProgram) -> None:
        add(made)
        COMPILED.add_pair(made._load(made.vertex_shader), made._load(made.fragment_shader))

    moderngl.Context.compute_shader = recorded_compute
    moderngl.Context.program = recorded_program
    SourceProgram._add_to_context = recorded_add  # type: ignore[method-assign]


def shader_files() -> list[str]:
    """Files that are compiled by themselves, relative to the folder of shaders."""
    return sorted(
        path.relative_to(SHADER_DIR).as_posix()
        for path in SHADER_DIR.rglob("*")
        if path.suffix in (".vert", ".frag", ".comp")
    )


def included_files(name: str) -> set[str]:
    """A shader file and those that it includes, directly or not."""
    text = (SHADER_DIR / name).read_text(encoding="utf-8")
    return {name}.union(*(included_files(one) for one in _INCLUDE.findall(text)))


def own_conditions(name: str) -> set[str]:
    """Conditions in a shader file itself, as `Preprocessed.branches` has them."""
    directives = map(_DIRECTIVE.match, (SHADER_DIR / name).read_text(encoding="utf-8").splitlines())
    return {f"#{one[1]} {one[2]}" for one in directives if one and one[1] in ("if", "ifdef", "ifndef", "elif")}


@dataclass(frozen=True)
class Preprocessed:
    """A source without the lines that the preprocessor leaves out.

    Attributes:
        text: active lines, without comments.
        branches: conditions that were reached, and whether each holds.
    """

    text: str
    branches: tuple[tuple[str, bool], ...]


def preprocess(source: str) -> Preprocessed:
    """Evaluate the conditions of a source that has its includes put in and its defines after ``#version``."""
    defines: dict[str, str] = {}
    blocks: list[list[bool]] = []  # for each open #if whether a branch was taken, and whether this one is
    lines, reached = [], []
    for line in source.splitlines():
        directive = _DIRECTIVE.match(line)
        is_active = all(block[1] for block in blocks)
        if directive is None:
            lines += [line.partition("//")[0]] if is_active else []
            continue
        word, rest = directive.groups()
        if word in ("if", "ifdef", "ifndef"):
            holds = is_active and _holds(word, rest, defines)
            reached += [(f"#{word} {rest}", holds)] if is_active else []
            blocks.append([holds, holds])
        elif word == "elif":
            is_reached = all(outer[1] for outer in blocks[:-1]) and not blocks[-1][0]
            holds = is_reached and _holds("if", rest, defines)
            reached += [(f"#{word} {rest}", holds)] if is_reached else []
            blocks[-1] = [blocks[-1][0] or holds, holds]
        elif word == "else":
            blocks[-1][1] = not blocks[-1][0]
        elif word == "endif":
            blocks.pop()
        elif word == "define" and is_active:
            name, _, value = rest.partition(" ")
            defines[name.partition("(")[0]] = value.strip()
    return Preprocessed("\n".join(lines), tuple(reached))


def _holds(word: str, condition: str, defines: Mapping[str, str]) -> bool:
    if word != "if":
        return (condition in defines) == (word == "ifdef")
    text = _WORD.sub(lambda match: str(match[1] in defines) if match[1] else defines.get(match[2], "0"), condition)
    text = re.sub(r"!(?!=)", " not ", text.replace("&&", " and ").replace("||", " or "))
    return bool(eval(text, {"__builtins__": {}}))
