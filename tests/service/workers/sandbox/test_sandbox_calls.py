"""System calls that a worker may not make, where the kernel filters them."""

from __future__ import annotations

from pathlib import Path

import pytest

from service.workers.sandbox import Support
from tests.service.workers.sandbox.confined import OFFERED, Confined

pytestmark = pytest.mark.skipif(not OFFERED.seccomp, reason="this system filters no system calls")

FILTER_ALONE = Support(0, True)
"""So that no refusal is Landlock's."""


@pytest.mark.parametrize(
    "action",
    [
        "socket.create_connection(('127.0.0.1', 9))",
        "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
        "socket.socket(socket.AF_INET6, socket.SOCK_STREAM)",
        "socket.socket(socket.AF_UNIX)",
        "socket.socketpair()",
        "socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)",
    ],
)
def test_there_is_no_network(tmp_path: Path, action: str) -> None:
    errors = Confined(tmp_path, offered=FILTER_ALONE).output(f"print(error_of(lambda: {action}))", "import socket")

    assert errors == ["EPERM"]


@pytest.mark.parametrize(
    "action",
    [
        "os.fork()",
        "os.execv('/bin/true', ['true'])",
        "os.posix_spawn('/bin/true', ['true'], {})",
        "subprocess.run(['/bin/true'])",
        "os.kill(os.getppid(), 0)",
        "os.kill(-1, 0)",
        "os.kill(0, 0)",
        "os.pidfd_open(os.getppid())",
        "resource.prlimit(os.getppid(), resource.RLIMIT_CORE, (0, 0))",
        "fcntl.fcntl(0, fcntl.F_SETOWN, os.getppid())",
        "fcntl.ioctl(0, 0x8901, struct.pack('i', os.getppid()))",
    ],
)
def test_other_processes_are_out_of_reach(tmp_path: Path, action: str) -> None:
    before = "import fcntl, resource, struct, subprocess"

    assert Confined(tmp_path, offered=FILTER_ALONE).output(f"print(error_of(lambda: {action}))", before) == ["EPERM"]


def test_the_parent_cannot_be_traced(tmp_path: Path) -> None:
    errors = Confined(tmp_path, offered=FILTER_ALONE).output("""
        import ctypes
        library = ctypes.CDLL(None, use_errno=True)
        attach = 16
        print(library.ptrace(attach, os.getppid(), None, None), errno.errorcode[ctypes.get_errno()])
    """)

    assert errors == ["-1 EPERM"]


def test_a_worker_signals_itself_and_starts_threads(tmp_path: Path) -> None:
    lines = Confined(tmp_path).output("""
        import signal, threading
        signal.signal(signal.SIGUSR1, lambda *_: print("received"))
        os.kill(os.getpid(), signal.SIGUSR1)
        thread = threading.Thread(target=print, args=("thread",))
        thread.start()
        thread.join()
    """)

    assert lines == ["received", "thread"]


def test_the_filter_binds_threads_that_exist(tmp_path: Path) -> None:
    before = """
        import threading
        entered = threading.Event()
        thread = threading.Thread(target=lambda: (entered.wait(), print(error_of(os.fork))))
        thread.start()
    """

    assert Confined(tmp_path, offered=FILTER_ALONE).output("entered.set(); thread.join()", before) == ["EPERM"]
