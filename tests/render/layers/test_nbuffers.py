"""Ranges of inverse depth: what the buffers hold, what a look-up over a rectangle finds, and the memory that it all takes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from render.frame import FrameRenderer
from render.gl.compat import GL
from render.gl.shaders import SHADER_DIR, ProgramCache
from render.lab.reference.scenes import rectangle
from render.layers.limits import BLOCK_PX, EMPTY_MIN
from render.layers.nbuffers import NBufferBuilder, NBuffers
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.scene import Batch, Material, Scene
from render.optics.view import PinholeView

SIZE = (157, 118)
UMBRA = 0.004
MEGABYTE = 1_000_000
VIEW = PinholeView.from_camera(Camera(np.eye(4), 36, 36, 27), *SIZE)
STEEPEST, LONGEST_REACH = 1.0, 0.05
"""Constants of `trace/slopes.glsl`."""
ROUNDING = 1e-5
Built = tuple[Layers, NBuffers, FloatArray]


@pytest.fixture
def ctx(renderer: FrameRenderer) -> moderngl.Context:
    return renderer.graphics.ctx


@pytest.fixture
def peeler(renderer: FrameRenderer) -> Iterator[Peeler]:
    made = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def cards() -> Scene:
    """Two hundred cards that crowd in the left half of the view, so that layers are many there and much is empty elsewhere;
    they lean by as much as 60 degrees."""
    rng = np.random.default_rng(0)
    batches = []
    for z in rng.uniform(1.5, 9, 200):
        x, y = z * rng.normal(-0.25, 0.08), z * rng.normal(0, 0.12)
        lean = rng.uniform(-1.7, 1.7)
        card = rectangle((x, y, -z), (0.04 * z, 0, 0.04 * z * lean), (0, 0.03 * z, 0))
        batches.append(Batch(card, Material(), np.eye(4)[None]))
    return Scene(tuple(batches))


@pytest.fixture(params=[1, 3, 4, 5, 8])
def built(ctx: moderngl.Context, peeler: Peeler, request: pytest.FixtureRequest) -> Iterator[Built]:
    """Layers, N-buffers and ``(height, width, count, 2)``, least and most w of each pixel's surfaces, 0 where there is none.
    Eight layers are peeled before, so that what they left behind is there to be mistaken for the layers' own."""
    peeler.load(cards())
    peeler.peel(VIEW, layers=8, umbra=UMBRA)
    layers = peeler.peel(VIEW, layers=request.param, umbra=UMBRA)
    assert layers.count == request.param
    targets, shape = layers.targets, (*SIZE[::-1], 4)
    w = [np.abs(np.frombuffer(pack.read(), np.float32).reshape(shape)) for pack in targets.packed_w]
    reach = [reach_of(np.frombuffer(pack.read(), np.uint16).reshape(shape)) for pack in targets.packed_slopes]
    ranges = np.stack(
        [of_w * (1 + side * of_reach) for of_w, of_reach in zip(w, reach, strict=True) for side in (-1, 1)]
    )
    ranges = ranges.reshape(len(w), 2, *shape).transpose(2, 3, 0, 4, 1).reshape(*SIZE[::-1], -1, 2)
    builder = NBufferBuilder(ctx, ProgramCache(ctx))
    yield layers, builder.build(layers, peeler.nearest_w(VIEW)), ranges[:, :, : layers.count]
    builder.release()


def reach_of(slopes: NDArray[np.uint16]) -> FloatArray:
    """Return the reach of surfaces from the middle of a pixel to its corners, as a share of w."""
    x, y = (((bits & 255).astype(np.float32) - 128) / 127 for bits in (slopes, slopes >> 8))
    return np.asarray(np.minimum(0.5 * STEEPEST * (np.abs(x) ** 3 + np.abs(y) ** 3), LONGEST_REACH), np.float32)


def range_of(ranges: FloatArray) -> tuple[float, float]:
    filled = ranges[ranges[..., 1] > 0]
    return (
        (float(filled[:, 0].min()), float(filled[:, 1].max())) if len(filled) else (float(np.float32(EMPTY_MIN)), 0.0)
    )


def test_ranges_hold_every_filled_pixel_and_nothing_else(built: Built) -> None:
    """Level i holds at each texel what is in the square of 2^i blocks that begins there, as far as the layers go."""
    _, buffers, w = built
    columns, rows, levels = buffers.ranges.size
    assert (columns, rows, levels) == (-(-SIZE[0] // BLOCK_PX), -(-SIZE[1] // BLOCK_PX), buffers.levels)
    assert 2 ** (levels - 1) >= max(columns, rows)
    stored = np.frombuffer(buffers.ranges.read(), np.float32).reshape(levels, rows, columns, 2)
    empties = 0
    for level in range(levels):
        side = BLOCK_PX << level
        for y, x in np.random.default_rng(level).integers(0, (rows, columns), (40, 2)):
            square = w[y * BLOCK_PX :, x * BLOCK_PX :][:side, :side]
            assert tuple(stored[level, y, x]) == pytest.approx(range_of(square), rel=ROUNDING)
            empties += not square.any()
    assert empties > 5
    assert tuple(stored[-1, 0, 0]) == pytest.approx(range_of(w), rel=ROUNDING)


def bins_of(ranges: FloatArray, w_range: tuple[float, float], wider: float) -> int:
    """Bits of the bins that a patch of layers fills, of 64 over the bins' range, each range wider by this share of w."""
    low, high = w_range
    filled = ranges[ranges[..., 1] > 0] * np.array([1 - wider, 1 + wider])
    bins = ((filled - low) / (high - low) * 64).clip(0, 63).astype(int)
    return sum(1 << int(number) for number in {n for first, last in bins for n in range(first, last + 1)})


def test_bins_hold_what_is_filled_and_nothing_else(built: Built) -> None:
    """Sixty-four bins of w, for the square of 2^i blocks that begins at a texel of level i."""
    _, buffers, w = built
    columns, rows, levels = buffers.bins.size
    assert buffers.bins.size == buffers.ranges.size
    assert buffers.w_range[0] <= w[w > 0].min()
    assert buffers.w_range[1] >= w.max()
    stored = np.frombuffer(buffers.bins.read(), np.uint64).reshape(levels, rows, columns)
    sparse = 0
    for level in range(levels):
        side = BLOCK_PX << level
        for y, x in np.random.default_rng(level).integers(0, (rows, columns), (40, 2)):
            found = int(stored[level, y, x])
            square = w[y * BLOCK_PX :, x * BLOCK_PX :][:side, :side]
            assert found & ~bins_of(square, buffers.w_range, ROUNDING) == 0
            assert bins_of(square, buffers.w_range, -ROUNDING) & ~found == 0
            sparse += 0 < found.bit_count() < 10
    assert sparse > 20
    assert int(stored[-1, 0, 0]).bit_count() > 10


def ask(ctx: moderngl.Context, buffers: NBuffers, rectangles: NDArray[np.int32]) -> FloatArray:
    """``(n, 2)`` ranges that the tracer's shader finds in ``(n, 4)`` rectangles."""
    source = Path(__file__).with_name("range_queries.comp").read_text(encoding="utf-8")
    for name in ("trace/footprints.glsl", "layers/bins.glsl"):
        source = source.replace(f'#include "{name}"', (SHADER_DIR / name).read_text(encoding="utf-8"))
    program = ctx.compute_shader(source)
    asked, found = ctx.buffer(rectangles.tobytes()), ctx.buffer(reserve=8 * len(rectangles))
    try:
        buffers.ranges.use(0)
        program["ranges"], program["last_level"] = 0, buffers.levels - 1
        program["layer_first"], program["layer_last"] = (0, 0), (SIZE[0] - 1, SIZE[1] - 1)
        asked.bind_to_storage_buffer(0)
        found.bind_to_storage_buffer(1)
        program.run(-(-len(rectangles) // 64))
        ctx.memory_barrier()
        return np.frombuffer(found.read(), np.float32).reshape(-1, 2)
    finally:
        for held in (program, asked, found):
            held.release()


def test_a_look_up_finds_the_range_of_any_rectangle(ctx: moderngl.Context, built: Built) -> None:
    """The range of a square footprint is that of the whole blocks it touches, bit for bit, also beyond the picture's edges.

    The range of a long one holds at least that, and nothing farther away than it is long.
    """
    _, buffers, w = built
    rng = np.random.default_rng(7)
    low = rng.integers(-40, [SIZE[0] + 30, SIZE[1] + 30], (400, 2))
    extent = rng.integers(0, 120, (400, 1)).repeat(2, axis=1)
    extent[200:] = rng.integers(0, 120, (200, 2))
    rectangles = np.concatenate([low, low + extent], axis=1).astype(np.int32)
    found = ask(ctx, buffers, rectangles)
    last = (np.array(SIZE) - 1) // BLOCK_PX
    exact = 0
    for (x0, y0, x1, y1), (lowest, highest) in zip(rectangles, found, strict=True):
        ax, bx = (np.clip(np.trunc(v / BLOCK_PX), 0, last[0]).astype(int) for v in (x0, x1))
        ay, by = (np.clip(np.trunc(v / BLOCK_PX), 0, last[1]).astype(int) for v in (y0, y1))
        own = range_of(w[ay * BLOCK_PX : (by + 1) * BLOCK_PX, ax * BLOCK_PX : (bx + 1) * BLOCK_PX])
        assert lowest <= own[0] * (1 + ROUNDING)
        assert highest >= own[1] * (1 - ROUNDING)
        side = max(bx - ax, by - ay) + 1
        if bx - ax == by - ay:
            exact += 1
            assert (lowest, highest) == pytest.approx(own, rel=ROUNDING)
        around = range_of(w[ay * BLOCK_PX : (ay + side) * BLOCK_PX, ax * BLOCK_PX : (ax + side) * BLOCK_PX])
        assert around[0] * (1 - ROUNDING) <= lowest
        assert highest <= around[1] * (1 + ROUNDING)
    assert exact > 30


def gl_bytes(texture: moderngl.Texture | moderngl.TextureArray) -> int:
    """Return the size of a texture's level 0 as OpenGL reports it, in bytes."""
    target = GL.GL_TEXTURE_2D_ARRAY if isinstance(texture, moderngl.TextureArray) else GL.GL_TEXTURE_2D
    texture.use(0)

    def ask_for(name: int) -> int:
        return int(np.ravel(GL.glGetTexLevelParameteriv(target, 0, name))[0])

    sizes = (GL.GL_TEXTURE_RED_SIZE, GL.GL_TEXTURE_GREEN_SIZE, GL.GL_TEXTURE_BLUE_SIZE, GL.GL_TEXTURE_ALPHA_SIZE)
    texels = np.prod([ask_for(name) for name in (GL.GL_TEXTURE_WIDTH, GL.GL_TEXTURE_HEIGHT, GL.GL_TEXTURE_DEPTH)])
    return int(texels) * sum(map(ask_for, sizes)) // 8


def test_four_layers_of_1024_by_768_take_at_most_64_megabytes(ctx: moderngl.Context, peeler: Peeler) -> None:
    """Radiance, inverse depths, background, depth buffer and N-buffers of an unlit lens's picture; eight layers, less than twice.
    What light falls on takes 18 megabytes more."""
    peeler.load(cards())
    view = replace(VIEW, width=1024, height=768)
    held = {}
    for count in (4, 8):
        layers = peeler.peel(view, layers=count, umbra=UMBRA, unlit=True)
        assert layers.count == count
        builder = NBufferBuilder(ctx, ProgramCache(ctx))
        buffers = builder.build(layers, peeler.nearest_w(view))
        targets = layers.targets
        depth = 4 * 1024 * 768
        textures = [targets.background, *targets.packed_w, *targets.packed_slopes]
        assert targets.bytes == gl_bytes(targets.radiance) + sum(map(gl_bytes, textures)) + depth
        assert buffers.bytes == gl_bytes(buffers.ranges) + gl_bytes(buffers.bins)
        held[count] = targets.bytes + buffers.bytes
        builder.release()
    assert held[4] <= 64 * MEGABYTE
    assert held[8] < 2 * held[4]


def test_unused_nbuffers_take_no_memory(peeler: Peeler) -> None:
    """One layer for a pinhole; and all that eight took is given back where the size changes."""
    peeler.load(cards())
    wide = replace(VIEW, width=200, height=150)
    one = peeler.peel(wide, layers=8, umbra=1e30).targets
    assert (one.radiance.layers, len(one.packed_w)) == (1, 1)
    eight = peeler.peel(wide, layers=8, umbra=UMBRA).targets
    assert (eight.radiance.layers, len(eight.packed_w)) == (8, 2)
    assert peeler.peel(wide, layers=2, umbra=UMBRA).targets is eight, "layers that are there are used again"
    assert peeler.peel(VIEW, layers=2, umbra=UMBRA).targets.radiance.layers == 2
