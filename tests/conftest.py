"""Fixtures that several rooms share."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from render.demo.shot import write_demo
from render.frame import FrameRenderer
from render.gl.compat import GL
from render.layers.targets import Slot
from tests.render.kits.compiled_shaders import COMPILED, record_programs
from tests.render.kits.shader_accesses import ACCESSES, watch_accesses

# Every context of the tests, also of processes that they start, reports what OpenGL leaves undefined (render/gl/debug.py).
os.environ["PULLFOCUS_GL_DEBUG"] = "1"

# Tests compute what the product keeps on disk; those of the cache name a folder of their own.
os.environ["PULLFOCUS_CACHE"] = "off"

if os.environ.get("MESA_LOADER_DRIVER_OVERRIDE") == "zink":  # scripts/test_on_zink
    _begin_colour = Slot.begin_colour

    def _begin_colour_anew(slot: Slot, *, fill: bool = False) -> None:
        """Mesa 25.0's zink ignores the colour masks of single buffers where the same batch has drawn without colour before."""
        GL.glFinish()
        _begin_colour(slot, fill=fill)

    Slot.begin_colour = _begin_colour_anew  # type: ignore[method-assign]

# `make test` tries the same examples in every run, so that its result depends on the code alone; `make fuzz` tries new ones.
# Neither judges by the clock: on a busy machine an example is slow, not wrong.
settings.register_profile("test", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("fuzz", settings.get_profile("test"), derandomize=False, max_examples=500, print_blob=True)
settings.load_profile("test")


record_programs()
watch_accesses()


def pytest_addoption(parser: pytest.Parser) -> None:
    """``--compiled-shaders`` takes the programs of the processes of one run to the tests marked ``last`` of another."""
    parser.addoption(
        "--compiled-shaders",
        type=Path,
        metavar="FOLDER",
        help="folder that each process writes the programs to that it compiled, and reads those of the others from",
    )


def pytest_sessionstart(session: pytest.Session) -> None:
    """Read the programs that another run compiled."""
    folder: Path | None = session.config.option.compiled_shaders
    for file in sorted(folder.glob("*.json")) if folder else ():
        COMPILED.read(file)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests marked ``last`` judge what the other tests did."""
    items.sort(key=lambda item: item.get_closest_marker("last") is not None)


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
    _session_renderer.graphics.raise_faults()
    ACCESSES.raise_faults()
    assert ctx.error == "GL_NO_ERROR"


@pytest.fixture(scope="session")
def demo_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Root layer of the demo shot, which is for reading alone: its folder is shared by all tests of a process."""
    return write_demo(tmp_path_factory.mktemp("demo_shot"))


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Write the compiled programs; a run in which no test passed or failed has shown nothing: it ends as one without tests."""
    folder: Path | None = session.config.option.compiled_shaders
    if folder:
        COMPILED.write(folder / f"{os.getpid()}.json")
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None:  # a worker of pytest-xdist: the process that started it reports
        return
    ran = any(reporter.stats.get(outcome) for outcome in ("passed", "failed", "error", "xfailed", "xpassed"))
    if not ran and session.exitstatus == pytest.ExitCode.OK and not session.config.option.collectonly:
        session.exitstatus = pytest.ExitCode.NO_TESTS_COLLECTED
