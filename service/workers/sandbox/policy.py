"""The sandbox of a worker process, and entering it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from service.workers.sandbox import landlock, seccomp
from service.workers.sandbox.kernel import drop_capabilities, forbid_new_privileges, machine
from service.workers.sandbox.limits import Limits, limit_processes, set_limits
from service.workers.sandbox.program import graphics_devices, graphics_paths, program_paths


@dataclass(frozen=True)
class Support:
    """Features of the kernel that a sandbox uses. Resource limits are not among them: every kernel has those.

    Attributes:
        landlock_abi: version of Landlock; 0 for none.
        seccomp: whether a filter of system calls can be set.
    """

    landlock_abi: int
    seccomp: bool

    def describe(self) -> str:
        """Return one sentence for people: what holds, and what does not with its remedy."""
        holds = [
            *([f"Landlock (ABI {self.landlock_abi})"] if self.landlock_abi else []),
            *(["a filter of system calls (seccomp)"] if self.seccomp else []),
            "resource limits",
        ]
        sentence = f"Workers are confined by {_enumerate(holds)}."
        if not self.landlock_abi:
            sentence += (
                " This kernel offers no Landlock (Linux 5.13 or later, not switched off at boot or by the container's runtime):"
                " a fault in a parser could read files of other shots."
            )
        if not self.seccomp:
            sentence += " This system has no filter of system calls: a fault in a parser could use the network."
        return sentence


@dataclass(frozen=True)
class Sandbox:
    """A worker's whole view of the machine.

    Attributes:
        read: files and folders that it may read, besides what the program itself needs (`program_paths`).
        write: folders in which it may also create, change and remove files and folders.
        limits: on what it uses.
        graphics: whether it may use the devices that draw.
    """

    read: tuple[Path, ...]
    write: tuple[Path, ...]
    limits: Limits
    graphics: bool = False


class SandboxError(Exception):
    """A process cannot be confined as far as the kernel offers; the message is one sentence."""


def support() -> Support:
    """Return what this kernel offers."""
    return Support(landlock.abi(), seccomp.is_offered())


def enter(sandbox: Sandbox, offered: Support | None = None) -> Support:
    """Enter a sandbox, for good. What the kernel does not offer is left out.

    Call it in the main thread before other threads start: up to ABI 7 Landlock binds the calling thread and those that it starts
    later, and USD reads layers in threads. Files that are open stay open. A library that asks programs where libraries are
    (``ctypes.util.find_library``) finds none from here on: import it before.

    Args:
        sandbox: the sandbox.
        offered: features of the kernel to use; None for all that it has.

    Returns:
        What holds now.

    Raises:
        SandboxError: Landlock would not bind a thread that exists already.
        OSError: the kernel refuses what it offers. After either error the process must end.
    """
    used = offered or support()
    threads = _other_threads()
    if threads and 0 < used.landlock_abi < landlock.ALL_THREADS_ABI:
        raise SandboxError(
            f"{threads} threads exist already, which Landlock does not confine: start them in the sandbox."
        )
    set_limits(sandbox.limits)
    if not used.seccomp:
        limit_processes(sandbox.limits.processes)
    if machine():
        drop_capabilities()
        forbid_new_privileges()
    if used.landlock_abi:
        landlock.restrict_files(used.landlock_abi, _rules(sandbox))
    if used.seccomp:
        seccomp.forbid_calls()
    return used


def _rules(sandbox: Sandbox) -> Iterator[tuple[Path, int]]:
    yield Path("/dev/null"), landlock.DEVICE
    for path in (*program_paths(), *(graphics_paths() if sandbox.graphics else ()), *sandbox.read):
        yield path, landlock.READ
    for path in sandbox.write:
        yield path, landlock.WRITE
    for path in graphics_devices() if sandbox.graphics else ():
        yield path, landlock.DEVICE


def _other_threads() -> int:
    try:
        return len(os.listdir("/proc/self/task")) - 1
    except OSError:  # not Linux
        return 0


def _enumerate(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
