"""Limits on what a process uses, which every kernel enforces."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from tests.service.workers.sandbox.confined import NOTHING, Confined


def test_memory_beyond_the_limit_is_an_error(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path, {"memory_bytes": 256 << 20}, offered=NOTHING)

    lines = sandbox.output("""
        small = bytearray(64 << 20)
        try:
            bytearray(512 << 20)
        except MemoryError:
            print("no memory")
    """)

    assert lines == ["no memory"]


def test_memory_of_numpy_is_limited_too(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path, {"memory_bytes": 512 << 20}, offered=NOTHING)

    lines = sandbox.output(
        """
        try:
            np.ones(1 << 28)
        except MemoryError:
            print("no memory")
        """,
        "import numpy as np",
    )

    assert lines == ["no memory"]


def test_processor_time_ends_the_process(tmp_path: Path) -> None:
    done = Confined(tmp_path, {"cpu_s": 1}, offered=NOTHING).run("while True: pass")

    assert done.returncode == -signal.SIGXCPU


def test_the_processor_time_of_a_call_counts_from_now(tmp_path: Path) -> None:
    done = Confined(tmp_path, offered=NOTHING).run("""
        import time
        def use(seconds):
            until = time.process_time() + seconds
            while time.process_time() < until: pass
        allow_cpu(2)
        use(1.5)
        allow_cpu(2)
        use(1.5)
        print("two calls", flush=True)
        allow_cpu(0.5)
        use(10)
    """)

    assert done.stdout == "two calls\n"
    assert done.returncode == -signal.SIGXCPU


def test_a_file_beyond_the_limit_is_an_error(tmp_path: Path) -> None:
    sandbox = Confined(tmp_path, {"file_bytes": 1 << 16}, offered=NOTHING)

    lines = sandbox.output(
        f"print(error_of(lambda: Path({str(sandbox.edits / 'large')!r}).write_bytes(bytes(1 << 17))))"
    )

    assert lines == ["EFBIG"]


def test_descriptors_are_limited(tmp_path: Path) -> None:
    lines = Confined(tmp_path, {"descriptors": 32}, offered=NOTHING).output("""
        def open_many():
            kept = [open("/dev/null") for _ in range(64)]
        print(error_of(open_many))
    """)

    assert lines == ["EMFILE"]


@pytest.mark.parametrize("name", ["RLIMIT_DATA", "RLIMIT_FSIZE", "RLIMIT_NOFILE", "RLIMIT_NPROC", "RLIMIT_CORE"])
def test_limits_are_not_raised_again(tmp_path: Path, name: str) -> None:
    lines = Confined(tmp_path, offered=NOTHING).output(f"""
        import resource
        soft, hard = resource.getrlimit(resource.{name})
        assert soft == hard != resource.RLIM_INFINITY
        try:
            resource.setrlimit(resource.{name}, (hard + 1, hard + 1))
        except ValueError:
            print("refused")
    """)

    assert lines == ["refused"]
