"""GPU objects of a construction that fails are released, so that a context that lives for days does not fill up."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import moderngl
import numpy as np
import pytest

from render.errors import GraphicsError
from render.gl.compat import GL
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.lab.bench.rig import LensRig
from render.layers.nbuffers import NBufferBuilder
from render.layers.targets import LayerTargets, SurfaceTargets
from render.model.lens import HeightField
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import focus_lens
from render.trace.surface_tracer import SurfaceTracer
from tests.render.kits.lenses import PLANAR

pytestmark = pytest.mark.gl

_KINDS = ("Texture", "Buffer", "Renderbuffer", "Framebuffer")
Maker = Callable[[Any, ProgramCache], object]


class Refusing:
    """A context that makes some objects, and then no more.

    Args:
        ctx: that makes them.
        left: how many it makes.
    """

    def __init__(self, ctx: moderngl.Context, left: int) -> None:
        self._ctx, self.left = ctx, left

    def __getattr__(self, name: str) -> Any:
        made = getattr(self._ctx, name)
        return self._counted(made) if name in ("texture", "texture_array", "buffer") else made

    def _counted(self, make: Callable[..., Any]) -> Callable[..., Any]:
        def counted(*arguments: Any, **named: Any) -> Any:
            if not self.left:
                raise moderngl.Error("the device is full")
            self.left -= 1
            return make(*arguments, **named)

        return counted


@pytest.fixture(scope="module")
def graphics() -> Iterator[GraphicsContext]:
    with GraphicsContext() as graphics:
        yield graphics


@pytest.fixture
def ctx(graphics: GraphicsContext) -> moderngl.Context:
    graphics.make_current()
    return graphics.ctx


def living() -> dict[str, list[int]]:
    """Names of all objects of the current context."""
    return {kind: [name for name in range(1, 200) if getattr(GL, f"glIs{kind}")(name)] for kind in _KINDS}


def layers(ctx: Any, programs: ProgramCache) -> object:
    return LayerTargets.allocate(ctx, 40, 30, 8, lit=True)


def surfaces(ctx: Any, programs: ProgramCache) -> object:
    return SurfaceTargets.allocate(ctx, 40, 30)


def nbuffers(ctx: Any, programs: ProgramCache) -> object:
    builder = NBufferBuilder(ctx, programs)
    return builder.build(SimpleNamespace(view=SimpleNamespace(width=40, height=30)), 1.0)  # type: ignore[arg-type]


def lens_rays(ctx: Any, programs: ProgramCache) -> object:
    lens = focus_lens(complete_prescription(PLANAR.prescription), 2.0, 2.8)
    field = HeightField(np.zeros((4, 4)), np.zeros((4, 4)))
    return SurfaceTracer(ctx, programs).trace(lens, np.zeros((1, 2)), np.zeros((1, 2)), [550.0], field)


@pytest.mark.parametrize(
    ("make", "needed"),
    [(layers, 6), (surfaces, 2), (nbuffers, 2), (lens_rays, 6)],
    ids=["layers", "surfaces", "nbuffers", "lens rays"],
)
def test_objects_are_released_when_a_later_one_cannot_be_made(make: Maker, needed: int, ctx: moderngl.Context) -> None:
    programs = ProgramCache(ctx)
    with pytest.raises((moderngl.Error, GraphicsError)):
        make(Refusing(ctx, 0), programs)  # compiles what it needs
    before = living()
    for left in range(needed):
        refusing = Refusing(ctx, left)
        with pytest.raises((moderngl.Error, GraphicsError), match="the device is full"):
            make(refusing, programs)
        assert refusing.left == 0
        assert living() == before


@pytest.mark.parametrize(("make", "framebuffers"), [(layers, 9), (surfaces, 2)], ids=["layers", "surfaces"])
def test_framebuffers_are_released_when_a_later_one_is_refused(
    make: Maker, framebuffers: int, ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    programs, before = ProgramCache(ctx), living()
    for refused in range(framebuffers):
        answers = iter([GL.GL_FRAMEBUFFER_COMPLETE] * refused + [GL.GL_FRAMEBUFFER_UNSUPPORTED])
        with monkeypatch.context() as patched:
            patched.setattr(GL, "glCheckFramebufferStatus", lambda _, answers=answers: next(answers))
            with pytest.raises(GraphicsError, match="refuses the layers' framebuffer"):
                make(ctx, programs)
        assert living() == before


def test_rays_through_a_lens_leave_nothing_on_the_device(ctx: moderngl.Context) -> None:
    programs = ProgramCache(ctx)
    lens_rays(ctx, programs)
    before = living()
    lens_rays(ctx, programs)
    assert living() == before


def test_a_bench_that_is_closed_leaves_other_contexts_alone(graphics: GraphicsContext) -> None:
    rig = LensRig()
    graphics.make_current()
    buffers = [graphics.ctx.buffer(bytes([i] * 16)) for i in range(8)]
    before = living()
    rig.close()
    graphics.make_current()
    assert living() == before
    assert [buffer.read()[0] for buffer in buffers] == list(range(8))
