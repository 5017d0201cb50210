"""Contexts come and go within one process, as when one command renders after another."""

from __future__ import annotations

import gc

import moderngl
import numpy as np
import pytest

from render.errors import GraphicsError
from render.frame import FrameRenderer, FrameSettings
from render.gl import compat
from render.gl.context import GraphicsContext
from render.lab.reference.scenes import spheres_over_checkerboard


def test_a_context_can_be_made_again_after_one_was_closed() -> None:
    names = []
    for _ in range(2):
        with FrameRenderer() as renderer:
            names.append(renderer.graphics.renderer)
            assert renderer.graphics.ctx.error == "GL_NO_ERROR"
    assert names[0] == names[1]


def test_one_renderer_does_not_disturb_another() -> None:
    scene, camera = spheres_over_checkerboard()
    settings = FrameSettings(64, 48, rays=4, supersample=1)
    with FrameRenderer() as first:
        alone = first.render(scene, camera, settings).color
        with FrameRenderer() as second:
            beside = second.render(scene, camera, settings).color
            np.testing.assert_array_equal(first.render(scene, camera, settings).color, alone)
        np.testing.assert_array_equal(first.render(scene, camera, settings).color, alone)
        assert first.graphics.ctx.error == "GL_NO_ERROR"
    np.testing.assert_array_equal(beside, alone)


def test_a_context_that_cannot_be_made_costs_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its remains are collected, which must not close the display that all contexts share."""
    scene, camera = spheres_over_checkerboard()
    settings = FrameSettings(64, 48, rays=4, supersample=1)
    with FrameRenderer() as other:
        before = other.render(scene, camera, settings).color
        with monkeypatch.context() as patched:
            patched.setattr(moderngl, "get_context", lambda: 1 / 0)
            with pytest.raises(GraphicsError, match="ZeroDivisionError"):
                GraphicsContext()
        gc.collect()
        np.testing.assert_array_equal(other.render(scene, camera, settings).color, before)


def test_where_the_wanted_version_is_refused_the_devices_own_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Mesa gives its newest for 4.1; a driver that gives exactly that is refused in one clear error."""
    monkeypatch.setattr(compat, "_VERSION", (9, 9))
    try:
        with FrameRenderer() as renderer:
            assert renderer.graphics.ctx.version_code >= 450
    except GraphicsError as error:
        assert "OpenGL 4.5 is needed" in str(error)  # noqa: PT017  # which of both depends on the driver
