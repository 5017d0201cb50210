"""Functions for a worker process that needs neither USD nor GL."""

from __future__ import annotations

import errno
import mmap
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from render.errors import StageError
from service.workers.calls import register


@register
class Tally:
    """State of a worker: counts its calls."""

    def __init__(self) -> None:
        self.calls = 0
        self.held = b""
        self.shared: mmap.mmap | None = None


@register
def echo(state: Tally, word: str = "", pause_s: float = 0.0) -> tuple[str, int]:
    """Return the word, and the number of calls of this worker so far."""
    time.sleep(pause_s)
    state.calls += 1
    return word, state.calls


@register
def spin(state: Tally, seconds: float) -> None:
    """Use the processor for a time of its own, s, however many others use it."""
    until_s = time.thread_time() + seconds
    while time.thread_time() < until_s:
        pass


@register
def burn_idle(state: Tally) -> None:
    """Keep the processor busy after this call, too."""
    threading.Thread(target=spin, args=(state, 600.0), daemon=True).start()


@register
def start_threads(state: Tally, count: int, pause_s: float = 0.0) -> None:
    for _ in range(count):
        threading.Thread(target=time.sleep, args=(600.0,), daemon=True).start()
    time.sleep(pause_s)


@register
def map_shared(state: Tally, count: int, pause_s: float = 0.0) -> None:
    """Fill memory that is no data of this process."""
    shared = mmap.mmap(-1, count)
    for at in range(0, count, mmap.PAGESIZE):
        shared[at] = 1
    state.shared = shared
    time.sleep(pause_s)


@register
def refuse(state: Tally) -> None:
    raise StageError("set.usda is no USD stage", code="stage_unreadable", path="set.usda")


@register
def fail(state: Tally) -> None:
    raise ZeroDivisionError("a fault of the program")


@register
def complain(state: Tally, text: str, times: int = 1, ends: bool = False) -> int:
    """Write to standard error as a library of C does, and crash if wanted. Returns how many writes went through."""
    written = 0
    for _ in range(times):
        with suppress(OSError):
            written += os.write(2, text.encode()) > 0
    if ends:
        os._exit(139)
    return written


@register
def crash(state: Tally) -> None:
    """End the process as a segmentation fault would, without an exception."""
    os._exit(139)


@register
def unpicklable(state: Tally) -> object:
    return lambda: None


@register
def devour_memory(state: Tally) -> None:
    """End the process as C++ does when it gets no memory."""
    with suppress(MemoryError):
        while True:
            state.held += b"x" * (64 << 20)
    os.abort()


@register
def chosen_gpu(state: Tally) -> str:
    return os.environ.get("PULLFOCUS_GPU", "")


@register
def run_out_of_memory(state: Tally) -> None:
    """Ask for more memory than there is, as numpy does."""
    bytearray(1 << 40)


@register
def hold_memory(state: Tally, count: int) -> None:
    state.held = b"x" * count


class Evil:
    """Runs a command where it is unpickled without care."""

    def __reduce__(self) -> tuple[object, ...]:
        return os.system, ("touch /nonexistent/evil",)


@register
def lie(state: Tally) -> object:
    return Evil()


@register
def process_id(state: Tally) -> int:
    return os.getpid()


@register
def temporary_folder(state: Tally) -> str:
    return tempfile.gettempdir()


@register
def read(state: Tally, path: str) -> bytes | None:
    """Read a file; None where this process may not."""
    with suppress(PermissionError):
        return Path(path).read_bytes()
    return None


@register
def write(state: Tally, path: str, content: bytes = b"poison", pause_s: float = 0.0) -> bool:
    """Write a file. Returns whether this process may."""
    with suppress(PermissionError):
        Path(path).write_bytes(content)
        time.sleep(pause_s)
        return True
    return False


@register
def try_to_change(state: Tally, folder: str) -> list[str]:
    """Try to list, add to, rename, remove and link a folder and its file. Returns what went through."""
    file, own = Path(folder) / "kept", Path(tempfile.gettempdir())
    tries: dict[str, Callable[[], object]] = {
        "list": lambda: os.listdir(folder),
        "read": lambda: file.read_bytes(),
        "write": lambda: file.write_bytes(b"poison"),
        "truncate": lambda: os.truncate(file, 0),
        "add": lambda: (Path(folder) / "more").write_bytes(b"poison"),
        "make": lambda: (Path(folder) / "folder").mkdir(),
        "link": lambda: os.link(file, own / "linked"),
        "symlink": lambda: (own / "symlinked").symlink_to(file),
        "move out": lambda: file.rename(own / "moved"),
        "move in": lambda: (own / "mine").rename(file),
        "remove": lambda: file.unlink(),
        "mode": lambda: file.chmod(0o777),
    }
    (own / "mine").write_bytes(b"poison")
    done = []
    for name, attempt in tries.items():
        with suppress(PermissionError):
            try:
                attempt()
                done.append(name)
            except OSError as error:  # as which the kernel refuses a move from folder to folder
                if error.errno != errno.EXDEV:
                    raise
    return done


def unregistered(state: Tally) -> None:
    raise AssertionError("a function that is not registered was called")


@register
def refine(
    state: Tally,
    is_stale: Callable[[], bool],
    word: str = "",
    shows: int = 3,
    pieces: int = 1,
    piece_s: float = 0.005,
    ending: Callable[[Tally], object] | None = None,
) -> Iterator[tuple[str, int]]:
    """Yield the word with 0, 1, 2 and so on, each after some pieces of work, and then call ``ending``."""
    for number in range(shows):
        for _ in range(pieces):
            if is_stale():
                return
            time.sleep(piece_s)
        yield word, number
    if ending is not None:
        ending(state)
