"""Limits of a device are asked, and what is beyond them is refused in one sentence; shaders keep to the least bindings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
import pytest

from render.errors import GraphicsError, SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.gl.context import GraphicsContext
from render.gl.limits import check_texture_array, make_storage
from render.gl.shaders import SHADER_DIR
from render.lab.reference.scenes import spheres_over_checkerboard

# OpenGL 4.5, tables 23.64 and 23.65; of textures, those of one stage
LEAST_STORAGE_BINDINGS, LEAST_IMAGE_UNITS, LEAST_TEXTURE_UNITS = 8, 8, 16
LEAST_INVOCATIONS = 1024
SETTINGS = FrameSettings(48, 32, rays=4, supersample=1)


class Limited:
    """A context with other limits.

    Args:
        ctx: the context.
        limits: by OpenGL's names.
    """

    def __init__(self, ctx: moderngl.Context, **limits: int) -> None:
        self._ctx = ctx
        self.info = ctx.info | limits

    def __getattr__(self, name: str) -> Any:
        return getattr(self._ctx, name)


@pytest.fixture
def limit(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, int]]:
    """Limits that contexts have from here on, in place of their own."""
    limits: dict[str, int] = {}
    own = moderngl.Context.info.fget  # type: ignore[attr-defined]
    monkeypatch.setattr(moderngl.Context, "info", property(lambda ctx: own(ctx) | limits))
    return limits


@pytest.mark.gl
def test_a_device_that_lacks_what_is_optional_is_refused(limit: dict[str, int]) -> None:
    limit["GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"] = 0
    with pytest.raises(GraphicsError, match=r"offers 0 storage buffers in a vertex shader .*, and 2 are needed"):
        GraphicsContext()


@pytest.mark.gl
@pytest.mark.parametrize(
    ("engine", "name", "most", "message"),
    [
        ("importance", "GL_MAX_SHADER_STORAGE_BLOCK_SIZE", 40_000, "the sums of light would take"),
        ("flag", "GL_MAX_ARRAY_TEXTURE_LAYERS", 2, "a blur of this radius would take"),
        ("lens", "GL_MAX_TEXTURE_SIZE", 40, "at most 40 on a side"),
    ],
)
def test_a_picture_beyond_a_limit_is_refused(
    limit: dict[str, int], engine: str, name: str, most: int, message: str
) -> None:
    """And the renderer draws the next one, within the limits, as before."""
    scene, camera = spheres_over_checkerboard()
    camera = replace(camera, f_stop=1.0)
    settings = replace(SETTINGS, engine=engine)
    with FrameRenderer() as renderer:
        before = renderer.render(scene, camera, settings).color
        limit[name] = most
        with pytest.raises((GraphicsError, SettingsError), match=message):
            renderer.render(scene, camera, replace(settings, width=54, height=36))
        limit.clear()
        np.testing.assert_array_equal(renderer.render(scene, camera, settings).color, before)


@pytest.mark.gl
def test_a_size_at_the_limit_is_accepted(renderer: FrameRenderer) -> None:
    ctx = Limited(renderer.graphics.ctx, GL_MAX_SHADER_STORAGE_BLOCK_SIZE=64, GL_MAX_ARRAY_TEXTURE_LAYERS=4)
    buffer = make_storage(ctx, 64, "this")  # type: ignore[arg-type]
    assert buffer.size == 64
    buffer.release()
    check_texture_array(ctx, (8, 8, 4), "this")  # type: ignore[arg-type]
    with pytest.raises(GraphicsError, match="this would take 5 textures of 8x8"):
        check_texture_array(ctx, (8, 8, 5), "this")  # type: ignore[arg-type]


def test_bindings_are_below_the_least_numbers() -> None:
    """No binding of a shader needs more than every OpenGL 4.5 has, and no work group is larger."""
    beyond = []
    for path in sorted(path for path in SHADER_DIR.rglob("*") if path.is_file()):
        text = re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))
        for layout, rest in re.findall(r"layout\s*\(([^)]*)\)([^;{]*)", text):
            binding = re.search(r"binding\s*=\s*(\d+)", layout)
            sizes = [int(side) for side in re.findall(r"local_size_\w\s*=\s*(\d+)", layout)]
            least = LEAST_TEXTURE_UNITS
            if re.search(r"\bbuffer\b", rest):
                least = LEAST_STORAGE_BINDINGS
            elif re.search(r"\b[iu]?image", rest):
                least = LEAST_IMAGE_UNITS
            if (binding is not None and int(binding[1]) >= least) or np.prod(sizes) > LEAST_INVOCATIONS:
                beyond.append(f"{path.name}: layout({layout}){rest}")
    assert beyond == []
