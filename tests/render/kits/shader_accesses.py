"""Accesses of programs to images, buffers and textures, checked for what OpenGL 4.5 leaves undefined and no driver reports.

- An image whose format is not the one that the shader declares (section 8.26), or that the program may not read or write.
- A shader's write that is read, written or copied before `memory_barrier` (section 7.12.2), and a write after a shader's read.
- A texture that is written as an image while it may be sampled (section 8.26), or of another kind than its sampler.
- Samplers of two kinds on one texture unit (section 11.1.3.5), which is an error where a driver looks.
- A binding that nothing was bound to, or that was released.

Contents are not looked at. Draws of pyrender are not checked, only those of moderngl.
"""

from __future__ import annotations

import ctypes
import re
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import moderngl
from OpenGL.raw.GL.VERSION.GL_1_0 import glGetIntegerv
from OpenGL.raw.GL.VERSION.GL_2_0 import glGetUniformiv

from render.gl.compat import GL
from tests.render.kits.compiled_shaders import preprocess

_IMAGE = re.compile(
    r"layout\s*\(([^)]*)\)\s*((?:\w+\s+)*?)(?:uniform\s+)?((?:\w+\s+)*?)([iu]?image\w+)\s+(\w+)\s*;", re.MULTILINE
)
_BLOCK = re.compile(r"layout\s*\(\s*std430\s*,\s*binding\s*=\s*(\d+)\s*\)\s*((?:\w+\s+)*?)buffer\s+(\w+)")
_SAMPLER = re.compile(
    r"^\s*(?:layout\s*\([^)]*\)\s*)?uniform\s+([iu]?sampler\w+)\s+(\w+)\s*(?:\[\d+\])?\s*;", re.MULTILINE
)
_COMPONENTS = {1: "r", 2: "rg", 4: "rgba"}
_BINDINGS = {
    moderngl.Texture: GL.GL_TEXTURE_BINDING_2D,
    moderngl.TextureArray: GL.GL_TEXTURE_BINDING_2D_ARRAY,
    moderngl.Texture3D: GL.GL_TEXTURE_BINDING_3D,
}
_SUFFIXES = {"f4": "32f", "f2": "16f", "u1": "8ui", "u2": "16ui", "u4": "32ui", "i2": "16i", "i4": "32i", "f1": "8"}


class UndefinedAccessError(AssertionError):
    """A program's access that OpenGL leaves undefined."""


@dataclass(frozen=True)
class Block:
    """A storage buffer that a program declares."""

    unit: int
    name: str
    reads: bool
    writes: bool


@dataclass(frozen=True)
class Image:
    """An image that a program declares: its type in GLSL, and its format where one is given."""

    unit: int
    name: str
    reads: bool
    writes: bool
    kind: str
    form: str | None


@dataclass(frozen=True)
class Declarations:
    """Images, storage buffers and samplers, the last as type and name, that a program declares."""

    images: list[Image]
    blocks: list[Block]
    samplers: list[tuple[str, str]]


def declarations(source: str) -> Declarations:
    """Read the declarations of a source without comments and inactive lines."""
    images, blocks = [], []
    for layout, before, after, kind, name in _IMAGE.findall(source):
        unit = int(re.findall(r"binding\s*=\s*(\d+)", layout)[0])
        forms = [word for word in re.split(r"[\s,]+", layout) if re.fullmatch(r"(r|rg|rgba)\d+\w*", word)]
        words = f"{before} {after}".split()
        images.append(
            Image(unit, name, "writeonly" not in words, "readonly" not in words, kind, forms[0] if forms else None)
        )
    for unit, qualifiers, name in _BLOCK.findall(source):
        blocks.append(Block(int(unit), name, "writeonly" not in qualifiers, "readonly" not in qualifiers))
    return Declarations(images, blocks, _SAMPLER.findall(source))


class Accesses:
    """Bindings of one process, and the accesses since the last barrier. Objects are told apart, not their names in OpenGL."""

    def __init__(self) -> None:
        self.images: dict[int, tuple[Any, bool, bool]] = {}
        self.blocks: dict[int, Any] = {}
        self.textures: dict[tuple[int, type], Any] = {}  # by unit and kind: a unit has one binding of each kind
        self.written: dict[int, str] = {}
        self.read: dict[int, str] = {}
        self.faults: list[str] = []

    def check(self, program: Any, name: str, declared: Declarations) -> None:
        """Check one dispatch or draw, and record what it reads and writes."""
        reads, writes = [], []
        for image in declared.images:
            if image.unit not in self.images:
                self._fault(f"{name}: no image is bound to unit {image.unit} ({image.name})")
                continue
            texture, may_read, may_write = self.images[image.unit]
            self._check_image(name, image, texture)
            if (image.reads and not may_read) or (image.writes and not may_write):
                self._fault(f"{name}: image {image.name} is used in a way that its binding excludes")
            reads += [texture] if image.reads else []
            writes += [texture] if image.writes else []
        for block in declared.blocks:
            buffer = self.blocks.get(block.unit)
            if buffer is None or _is_released(buffer):
                self._fault(f"{name}: no buffer is bound to {block.unit} ({block.name})")
                continue
            reads += [buffer] if block.reads else []
            writes += [buffer] if block.writes else []
        stored = {id(thing) for thing in writes}
        kinds: dict[int, str] = {}
        for kind, sampler in declared.samplers:
            for unit, texture in self._sampled(program, kind, sampler):
                if kinds.setdefault(unit, kind) != kind:
                    self._fault(f"{name}: a {kind} and a {kinds[unit]} share texture unit {unit}")
                self._check_sampler(name, kind, sampler, texture)
                if id(texture) in stored:
                    self._fault(f"{name}: {sampler} samples a texture that the program writes as an image")
                reads.append(texture)
        for thing in reads:
            if id(thing) in self.written:
                self._fault(f"{name} reads what {self.written[id(thing)]} wrote without a barrier between")
        for thing in writes:
            for past in (self.written, self.read):
                if id(thing) in past:
                    self._fault(f"{name} writes what {past[id(thing)]} used without a barrier between")
        self.written |= {id(thing): name for thing in writes}
        self.read |= {
            id(thing): name for thing in reads if not isinstance(thing, moderngl.Texture | moderngl.TextureArray)
        }

    def check_copy(self, thing: Any) -> None:
        """Check that a texture or buffer may be read or written by the CPU, or copied."""
        if id(thing) in self.written:
            self._fault(f"a {type(thing).__name__} is copied that {self.written[id(thing)]} wrote, without a barrier")

    def pass_barrier(self) -> None:
        """Forget all accesses."""
        self.written, self.read = {}, {}

    def forget(self, thing: Any) -> None:
        """Forget a released object: another one may get its id."""
        self.written.pop(id(thing), None)
        self.read.pop(id(thing), None)

    def raise_faults(self) -> None:
        """Raise `UndefinedAccessError` for the faults so far, and forget them."""
        faults, self.faults = self.faults, []
        if faults:
            raise UndefinedAccessError("\n".join(dict.fromkeys(faults)))

    def _sampled(self, program: Any, kind: str, sampler: str) -> list[tuple[int, Any]]:
        """Units of a sampler, and the textures that moderngl bound there; a unit has one for each kind."""
        if sampler not in program:
            return []
        if kind.endswith("Shadow"):  # moderngl does not know these samplers, and reads no unit
            units = [_uniform(program.glo, program[sampler].location)]
        else:
            value = program[sampler].value
            units = value if isinstance(value, (tuple, list)) else [value]
        bound = [(unit, self.textures.get((unit, _sampled_kind(kind)))) for unit in units]
        return [(unit, texture) for unit, texture in bound if texture is not None and _is_bound(texture, unit)]

    def _check_image(self, name: str, image: Image, texture: Any) -> None:
        form = _COMPONENTS.get(texture.components, "?") + _SUFFIXES[texture.dtype]
        if image.form not in (None, form):
            self._fault(f"{name}: image {image.name} is declared as {image.form} and bound as {form}")
        if not isinstance(texture, _sampled_kind(image.kind)):
            self._fault(f"{name}: image {image.name} is a {image.kind}, and {type(texture).__name__} is bound")

    def _check_sampler(self, name: str, kind: str, sampler: str, texture: Any) -> None:
        if _is_released(texture):
            self._fault(f"{name}: {sampler} samples a texture that was released")
            return
        whole = texture.dtype[0] if texture.dtype[0] in "ui" else ""
        if (kind[0] if kind[0] in "ui" else "") != whole:
            self._fault(f"{name}: {sampler} is a {kind}, and its texture holds {texture.dtype}")
        if whole and texture.filter != (moderngl.NEAREST, moderngl.NEAREST):
            self._fault(f"{name}: {sampler} filters integers, so its texture is incomplete")

    def _fault(self, text: str) -> None:
        where = [
            frame
            for frame in traceback.extract_stack()
            if "/render/" in frame.filename and "/tests/" not in frame.filename
        ]
        self.faults.append(
            f"{text} ({where[-1].filename.rpartition('/render/')[2]}:{where[-1].lineno})" if where else text
        )


ACCESSES = Accesses()
"""Accesses of this process since `watch_accesses`."""


def watch_accesses() -> None:
    """Check each access of moderngl's programs from here on; `Accesses.raise_faults` raises what was found."""
    compute, program = moderngl.Context.compute_shader, moderngl.Context.program
    sources: dict[int, tuple[Any, str, Declarations]] = {}  # of each program; it is kept, so that its id stays its own

    def made_compute(ctx: Any, source: str) -> Any:
        made = compute(ctx, source)
        sources[id(made)] = made, _title(source), declarations(preprocess(source).text)
        return made

    def made_program(ctx: Any, vertex: str, fragment: str, **others: Any) -> Any:
        made = program(ctx, vertex, fragment, **others)
        text = "\n".join(preprocess(stage).text for stage in (vertex, fragment))
        sources[id(made)] = made, _title(vertex), declarations(text)
        return made

    moderngl.Context.compute_shader, moderngl.Context.program = made_compute, made_program

    def around(kind: type, method: str, before: Callable[..., None]) -> None:
        original = getattr(kind, method)

        def watched(this: Any, *arguments: Any, **named: Any) -> Any:
            before(this, *arguments, **named)
            return original(this, *arguments, **named)

        setattr(kind, method, watched)

    def dispatch(this: Any, *_: Any, **__: Any) -> None:
        if id(this) in sources:
            ACCESSES.check(*sources[id(this)])

    def draw(this: Any, *_: Any, **__: Any) -> None:
        if id(this.program) in sources:
            ACCESSES.check(*sources[id(this.program)])

    def bind_image(this: Any, unit: int, read: bool = True, write: bool = True, **_: Any) -> None:
        ACCESSES.images[unit] = this, read, write

    def use(this: Any, location: int = 0) -> None:
        ACCESSES.textures[location, type(this)] = this

    around(moderngl.ComputeShader, "run", dispatch)
    around(moderngl.VertexArray, "render", draw)
    around(moderngl.Context, "memory_barrier", lambda this, *_, **__: ACCESSES.pass_barrier())
    around(moderngl.Buffer, "bind_to_storage_buffer", lambda this, unit=0, **_: ACCESSES.blocks.__setitem__(unit, this))
    for kind in (moderngl.Texture, moderngl.TextureArray):
        around(kind, "bind_to_image", bind_image)
    for kind in _BINDINGS:
        around(kind, "use", use)
    for kind in (moderngl.Texture, moderngl.TextureArray, moderngl.Buffer):
        for method in ("read", "write"):
            around(kind, method, lambda this, *_, **__: ACCESSES.check_copy(this))
        around(kind, "release", lambda this: ACCESSES.forget(this))
    around(moderngl.Buffer, "clear", lambda this, *_, **__: ACCESSES.check_copy(this))


def _is_bound(texture: Any, unit: int) -> bool:
    """Whether a texture is still bound where moderngl bound it; PyOpenGL may have bound another one since."""
    before = _integer(GL.GL_ACTIVE_TEXTURE)
    GL.glActiveTexture(GL.GL_TEXTURE0 + unit)
    name = _integer(_BINDINGS[type(texture)])
    GL.glActiveTexture(before)
    if _is_released(texture):
        return bool(name == 0)  # its unit is empty from then on
    return bool(name == texture.glo)


def _integer(name: int) -> int:
    """A value of the context. PyOpenGL's own ``glGetIntegerv`` makes an array for each; this is asked at every dispatch."""
    value = ctypes.c_int()
    glGetIntegerv(name, ctypes.byref(value))
    return value.value


def _uniform(program: int, location: int) -> int:
    """An integer uniform of a program."""
    value = ctypes.c_int()
    glGetUniformiv(program, location, ctypes.byref(value))
    return value.value


def _sampled_kind(kind: str) -> type:
    """Class of the textures that a sampler or image type of GLSL stands for."""
    if "3D" in kind:
        return moderngl.Texture3D
    return moderngl.TextureArray if "Array" in kind else moderngl.Texture


def _is_released(thing: Any) -> bool:
    return isinstance(thing.mglo, moderngl.mgl.InvalidObject)


def _title(source: str) -> str:
    return next((line[3:] for line in source.splitlines() if line.startswith("// ")), "a program")
