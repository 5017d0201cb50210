"""Fixtures that several rooms share."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings

from render.frame import FrameRenderer

# No deadline: on a busy machine an example is slow, not wrong. In CI the examples are always the same, so that a change is
# judged by what it changes; at a desk each run tries others.
settings.register_profile("pullfocus", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("pullfocus")


@pytest.fixture(scope="session")
def _session_renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as renderer:
        yield renderer


@pytest.fixture
def renderer(_session_renderer: FrameRenderer) -> Iterator[FrameRenderer]:
    """The session's renderer; no OpenGL error before a test, and none after it."""
    ctx = _session_renderer.graphics.ctx
    _session_renderer.graphics.make_current()
    assert ctx.error == "GL_NO_ERROR"
    yield _session_renderer
    assert ctx.error == "GL_NO_ERROR"


def pytest_sessionfinish(session: pytest.Session) -> None:
    """A run in which no test passed or failed has shown nothing: it ends as one that collected none."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    ran = any(reporter.stats.get(outcome) for outcome in ("passed", "failed", "error", "xfailed", "xpassed"))
    if not ran and session.exitstatus == pytest.ExitCode.OK and not session.config.option.collectonly:
        session.exitstatus = pytest.ExitCode.NO_TESTS_COLLECTED
