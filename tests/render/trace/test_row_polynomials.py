"""Polynomials of the lens table's rows, evaluated by the device, against those that NumPy evaluates."""

from __future__ import annotations

import re

import moderngl
import numpy as np
import pytest

from render.frame import FrameRenderer
from render.gl.shaders import SHADER_DIR
from render.trace.lens_fit import SLOPE_DEGREES, row_length, slope_errors
from render.trace.ray_buffers import _ROW_DEFINES

SOURCE = (SHADER_DIR / "lens" / "lens_polynomial.glsl").read_text(encoding="utf-8")
MAIN = """
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Nodes { vec2 nodes[]; };
layout(std430, binding = 1) writeonly buffer Errors { vec2 errors[]; };
void main()
{
    load_row(0.5 * last_slope);
    vec2 node = nodes[gl_GlobalInvocationID.x];
    float y2 = node.y * node.y;
    errors[gl_GlobalInvocationID.x] = vec2(slope_t(node.x, y2), node.y * slope_s(node.x, y2));
}
"""


@pytest.mark.gl
@pytest.mark.parametrize("degree", SLOPE_DEGREES)
def test_the_device_evaluates_rows_of_each_degree(renderer: FrameRenderer, degree: int) -> None:
    """Halfway between two rows, whose mean it takes."""
    rng = np.random.default_rng(degree)
    rows = rng.normal(size=(2, row_length(degree))).astype(np.float32)
    nodes = (rng.uniform(-1, 1, (128, 2)) * np.sqrt(0.5)).astype(np.float32)
    defines = _ROW_DEFINES | {"SLOPE_DEGREE": degree, "PUPIL_DEGREE": 5, "ROW_VEC4": row_length(degree) // 4}
    lines = "".join(f"#define {name} {value}\n" for name, value in defines.items())
    with renderer.on_device():
        ctx = renderer.graphics.ctx
        program = ctx.compute_shader(f"#version 450 core\n{lines}{SOURCE}{MAIN}")
        table = ctx.texture((rows.shape[1] // 4, 2), 4, rows.tobytes(), dtype="f4")
        table.filter = moderngl.NEAREST, moderngl.NEAREST
        buffers = ctx.buffer(nodes.tobytes()), ctx.buffer(reserve=nodes.nbytes)
        table.use(0)
        program["lens_rows"], program["row_count"], program["last_slope"] = 0, 2, 1.0
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        program.run(2)
        ctx.memory_barrier()
        found = np.frombuffer(buffers[1].read(), np.float32).reshape(-1, 2)
        for resource in (*buffers, table, program):
            resource.release()
    expected = slope_errors(rows.astype(np.float64).mean(axis=0)[None], nodes.astype(np.float64), degree)[0]
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-5)


def test_a_row_of_the_highest_degree_is_loaded_whole() -> None:
    """Rows are loaded by fours of texels; the compiler of the tests does not count what is left out."""
    loaded = 4 + max(int(number) for number in re.findall(r"LOAD_FOUR\((\d+)\)", SOURCE))
    assert loaded == row_length(SLOPE_DEGREES[-1]) // 4
