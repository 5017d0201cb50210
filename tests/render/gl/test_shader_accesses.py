"""The tests' own check of what no driver reports finds each kind of fault (`tests.render.kits.shader_accesses`)."""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np
import pytest

from render.gl.context import GraphicsContext
from tests.render.kits.shader_accesses import ACCESSES, UndefinedAccessError

pytestmark = pytest.mark.gl

STORE = """#version 450 core
// Store
layout(local_size_x = 1) in;
layout(rgba32f, binding = 0) uniform writeonly image2D target;
void main() { imageStore(target, ivec2(0), vec4(1.0)); }
"""
COPY = """#version 450 core
// Copy
layout(local_size_x = 1) in;
layout(rgba32f, binding = 0) uniform writeonly image2D target;
uniform sampler2D source;
void main() { imageStore(target, ivec2(0), texelFetch(source, ivec2(0), 0)); }
"""
COUNT = """#version 450 core
// Count
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Counts { uint counts[]; };
void main() { counts[0] += 1u; }
"""


@pytest.fixture(scope="module")
def graphics() -> Iterator[GraphicsContext]:
    with GraphicsContext() as graphics:
        yield graphics


@pytest.fixture
def ctx(graphics: GraphicsContext) -> Iterator[moderngl.Context]:
    graphics.make_current()
    ACCESSES.raise_faults()
    ACCESSES.pass_barrier()
    yield graphics.ctx
    ACCESSES.pass_barrier()


def image(ctx: moderngl.Context, dtype: str = "f4") -> moderngl.Texture:
    return ctx.texture((4, 4), 4, bytes(16 * 4 * int(dtype[1])), dtype=dtype)


def test_an_image_of_another_format_than_declared_is_found(ctx: moderngl.Context) -> None:
    image(ctx, "f2").bind_to_image(0, read=False, write=True)
    ctx.compute_shader(STORE).run()
    with pytest.raises(UndefinedAccessError, match="target is declared as rgba32f and bound as rgba16f"):
        ACCESSES.raise_faults()


def test_an_image_that_is_read_before_a_barrier_is_found(ctx: moderngl.Context) -> None:
    target = image(ctx)
    target.bind_to_image(0, read=False, write=True)
    ctx.compute_shader(STORE).run()
    target.read()
    with pytest.raises(UndefinedAccessError, match="a Texture is copied that Store wrote, without a barrier"):
        ACCESSES.raise_faults()
    ctx.memory_barrier()
    assert np.frombuffer(target.read(), np.float32)[0] == 1.0
    ACCESSES.raise_faults()


def test_a_buffer_that_is_written_twice_without_a_barrier_is_found(ctx: moderngl.Context) -> None:
    counts = ctx.buffer(bytes(4))
    counts.bind_to_storage_buffer(0)
    program = ctx.compute_shader(COUNT)
    program.run()
    ctx.memory_barrier()
    program.run()
    ACCESSES.raise_faults()
    program.run()
    with pytest.raises(UndefinedAccessError, match="Count reads what Count wrote without a barrier between"):
        ACCESSES.raise_faults()


def test_a_texture_that_is_sampled_and_written_at_once_is_found(ctx: moderngl.Context) -> None:
    both, other = image(ctx), image(ctx)
    both.bind_to_image(0, read=False, write=True)
    program = ctx.compute_shader(COPY)
    program["source"] = 0
    other.use(0)
    program.run()
    ctx.memory_barrier()
    ACCESSES.raise_faults()
    both.use(0)
    program.run()
    with pytest.raises(UndefinedAccessError, match="source samples a texture that the program writes as an image"):
        ACCESSES.raise_faults()


def test_integers_behind_a_float_sampler_are_found(ctx: moderngl.Context) -> None:
    image(ctx).bind_to_image(0, read=False, write=True)
    program = ctx.compute_shader(COPY)
    program["source"] = 0
    image(ctx, "u4").use(0)
    program.run()
    with pytest.raises(UndefinedAccessError, match="source is a sampler2D, and its texture holds u4"):
        ACCESSES.raise_faults()


def test_a_binding_without_a_buffer_is_found(ctx: moderngl.Context) -> None:
    counts = ctx.buffer(bytes(4))
    counts.bind_to_storage_buffer(0)
    counts.release()
    ctx.compute_shader(COUNT).run()
    with pytest.raises(UndefinedAccessError, match="no buffer is bound to 0"):
        ACCESSES.raise_faults()
