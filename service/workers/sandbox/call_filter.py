"""Program that judges each system call of a worker, for the kernel's classic BPF machine. It knows x86_64 and aarch64."""

from __future__ import annotations

import errno
from collections.abc import Iterable
from dataclasses import dataclass

from service.workers.sandbox.forbidden_calls import FORBIDDEN

ALLOW, KILL_PROCESS, ERROR = 0x7FFF0000, 0x80000000, 0x00050000
"""Answers: the call is made; the process ends; the call fails, with the error's number in the lower half."""

_LOAD, _JUMP_IF_EQUAL, _JUMP_IF_FROM, _JUMP_IF_ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _ARGUMENTS = (
    0,
    4,
    16,
)  # offsets in ``struct seccomp_data``; the lower half of an argument comes first
_FIRST_X32_NUMBER = 0x40000000
_THREAD, _NEW_NAMESPACES = 0x00010000, 0x7E020080  # flags of clone
_TERMINAL_INPUT, _TERMINAL_SELECTION = 0x5412, 0x541C  # ioctls that type into the terminal that the service runs in
_OWNER_BY_IOCTL = 0x8901, 0x8902  # FIOSETOWN, SIOCSPGRP: whom the kernel signals when a descriptor is ready
_OWNER_BY_FCNTL = 8, 10, 15  # F_SETOWN, F_SETSIG, F_SETOWN_EX; Landlock judges these signals from Linux 6.12 on
_CLONE3 = 435

Instruction = tuple[int, int, int, int]
"""Operation, instructions to skip where its condition holds and where not, and operand."""


@dataclass(frozen=True)
class _Architecture:
    """An architecture: its place in `FORBIDDEN`, its name for the kernel, and numbers of calls that are judged by arguments."""

    column: int
    audit: int
    clone: int
    ioctl: int
    fcntl: int
    prlimit64: int
    utimensat: int
    signals: tuple[int, ...]  # kill, tgkill, rt_sigqueueinfo, rt_tgsigqueueinfo


_ARCHITECTURES = {
    "x86_64": _Architecture(0, 0xC000003E, 56, 16, 72, 302, 280, (62, 234, 129, 297)),
    "aarch64": _Architecture(1, 0xC00000B7, 220, 29, 25, 261, 88, (129, 131, 138, 240)),
}


def make_filter(machine: str, pid: int) -> list[Instruction]:
    """Assemble the filter of a process.

    Args:
        machine: ``x86_64`` or ``aarch64``.
        pid: the process, which may signal and limit itself alone.
    """
    architecture = _ARCHITECTURES[machine]
    forbidden = sorted(number for call in FORBIDDEN.values() if (number := call[architecture.column]) is not None)
    return [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_JUMP_IF_EQUAL, 1, 0, architecture.audit),
        _answer(KILL_PROCESS),  # a 32-bit call, whose numbers mean something else
        (_LOAD, 0, 0, _NUMBER),
        (_JUMP_IF_FROM, 0, 1, _FIRST_X32_NUMBER),
        _answer(KILL_PROCESS),
        *_where({_CLONE3}, [_answer(ERROR | errno.ENOSYS)]),  # the C library then calls clone, whose flags can be read
        *_where({architecture.clone}, _new_thread()),
        *_where({architecture.ioctl}, _argument(1, refused=(_TERMINAL_INPUT, _TERMINAL_SELECTION, *_OWNER_BY_IOCTL))),
        *_where({architecture.fcntl}, _argument(1, refused=_OWNER_BY_FCNTL)),
        *_where({architecture.prlimit64}, _argument(0, allowed=(0, pid))),
        *_where({architecture.utimensat}, _times_of_a_descriptor()),
        *_where(architecture.signals, _argument(0, allowed=(pid,))),
        *_where(forbidden, [_refuse()]),
        _answer(ALLOW),
    ]


def _where(numbers: Iterable[int], then: list[Instruction]) -> list[Instruction]:
    """Run instructions, which end in an answer, for calls of these numbers. The number must be loaded."""
    return [instruction for number in numbers for instruction in ((_JUMP_IF_EQUAL, 0, len(then), number), *then)]


def _argument(index: int, *, allowed: tuple[int, ...] = (), refused: tuple[int, ...] = ()) -> list[Instruction]:
    """Answer by the lower half of an argument, which is all that the kernel reads: allow these values alone, or refuse them."""
    values = allowed or refused
    compared = [(_JUMP_IF_EQUAL, len(values) - position, 0, value) for position, value in enumerate(values)]
    answers = (_answer(ALLOW), _refuse()) if refused else (_refuse(), _answer(ALLOW))
    return [_load_argument(index), *compared, *answers]


def _new_thread() -> list[Instruction]:
    """Allow a new thread of this process; refuse a new process."""
    return [
        _load_argument(0),
        (_JUMP_IF_ANY_BIT, 2, 0, _NEW_NAMESPACES),
        (_JUMP_IF_ANY_BIT, 0, 1, _THREAD),
        _answer(ALLOW),
        _refuse(),
    ]


def _times_of_a_descriptor() -> list[Instruction]:
    """Allow new times of an open file; refuse a path, which Landlock would not judge."""
    return [
        _load_argument(1),
        (_JUMP_IF_EQUAL, 0, 3, 0),
        (_LOAD, 0, 0, _ARGUMENTS + 8 + 4),
        (_JUMP_IF_EQUAL, 0, 1, 0),
        _answer(ALLOW),
        _refuse(),
    ]


def _load_argument(index: int) -> Instruction:
    return (_LOAD, 0, 0, _ARGUMENTS + 8 * index)


def _answer(answer: int) -> Instruction:
    return (_RETURN, 0, 0, answer)


def _refuse() -> Instruction:
    return _answer(ERROR | errno.EPERM)
