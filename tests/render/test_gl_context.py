"""Contexts come and go within one process, as when one command renders after another."""

from __future__ import annotations

from render.frame import FrameRenderer


def test_a_context_can_be_made_again_after_one_was_closed() -> None:
    names = []
    for _ in range(2):
        with FrameRenderer() as renderer:
            names.append(renderer.graphics.renderer)
            assert renderer.graphics.ctx.error == "GL_NO_ERROR"
    assert names[0] == names[1]
