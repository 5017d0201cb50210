"""Filter of system calls (seccomp): what a worker never needs answers EPERM, in all of its threads, for good.

The filter is a program for the kernel's classic BPF machine. It knows x86_64 and aarch64; elsewhere there is no filter.
"""

from __future__ import annotations

import ctypes
import errno
import os
import struct
from collections.abc import Iterable
from dataclasses import dataclass

from service.workers.sandbox.forbidden_calls import FORBIDDEN
from service.workers.sandbox.kernel import machine, system_call

_SET_MODE_FILTER, _GET_ACTION_AVAIL = 1, 2
_ALL_THREADS = 1
_ALLOW, _KILL_PROCESS, _ERROR = 0x7FFF0000, 0x80000000, 0x00050000
_LOAD, _JUMP_IF_EQUAL, _JUMP_IF_FROM, _JUMP_IF_ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _ARGUMENTS = (
    0,
    4,
    16,
)  # offsets in ``struct seccomp_data``; the lower half of an argument comes first
_FIRST_X32_NUMBER = 0x40000000
_THREAD, _NEW_NAMESPACES = 0x00010000, 0x7E020080  # flags of clone
_TERMINAL_INPUT, _TERMINAL_SELECTION = (
    0x5412,
    0x541C,
)  # ioctls that type into the terminal that the service was started in

_Instruction = tuple[int, int, int, int]
"""Operation, instructions to skip where its condition holds and where not, and operand."""


@dataclass(frozen=True)
class _Architecture:
    """An architecture: its place in `FORBIDDEN`, its name for the kernel, and numbers of calls that are judged by arguments."""

    column: int
    audit: int
    seccomp: int
    clone: int
    ioctl: int
    prlimit64: int
    signals: tuple[int, ...]  # kill, tgkill, rt_sigqueueinfo, rt_tgsigqueueinfo


_ARCHITECTURES = {
    "x86_64": _Architecture(0, 0xC000003E, 317, 56, 16, 302, (62, 234, 129, 297)),
    "aarch64": _Architecture(1, 0xC00000B7, 277, 220, 29, 261, (129, 131, 138, 240)),
}
_CLONE3 = 435


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def is_offered() -> bool:
    """Whether the kernel takes filters from us, and this module knows the architecture."""
    architecture = _ARCHITECTURES.get(machine())
    if architecture is None:
        return False
    action = ctypes.c_uint32(_ERROR)
    try:
        system_call(architecture.seccomp, _GET_ACTION_AVAIL, 0, ctypes.cast(ctypes.pointer(action), ctypes.c_void_p))
    except OSError:
        return False
    return True


def forbid_calls() -> None:
    """Forbid the calls in all threads of this process, and in what they start. ``no_new_privs`` must be set.

    Raises:
        OSError: the kernel refuses.
    """
    architecture = _ARCHITECTURES[machine()]
    code = b"".join(struct.pack("=HBBI", *instruction) for instruction in _filter(architecture, os.getpid()))
    program = _Program(len(code) // 8, code)
    address = ctypes.cast(ctypes.pointer(program), ctypes.c_void_p)
    thread = system_call(architecture.seccomp, _SET_MODE_FILTER, _ALL_THREADS, address)
    if thread:
        raise OSError(errno.EBUSY, f"thread {thread} has another filter of system calls")


def _filter(architecture: _Architecture, pid: int) -> list[_Instruction]:
    """Assemble the filter of a process, which may signal and limit itself alone."""
    forbidden = sorted(number for call in FORBIDDEN.values() if (number := call[architecture.column]) is not None)
    return [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_JUMP_IF_EQUAL, 1, 0, architecture.audit),
        (_RETURN, 0, 0, _KILL_PROCESS),  # a 32-bit call, whose numbers mean something else
        (_LOAD, 0, 0, _NUMBER),
        (_JUMP_IF_FROM, 0, 1, _FIRST_X32_NUMBER),
        (_RETURN, 0, 0, _KILL_PROCESS),
        *_where(
            {_CLONE3}, [(_RETURN, 0, 0, _ERROR | errno.ENOSYS)]
        ),  # the C library then uses clone, whose flags can be read
        *_where({architecture.clone}, _flags_of_a_thread()),
        *_where({architecture.ioctl}, _argument(1, refused=(_TERMINAL_INPUT, _TERMINAL_SELECTION))),
        *_where({architecture.prlimit64}, _argument(0, allowed=(0, pid))),
        *_where(architecture.signals, _argument(0, allowed=(pid,))),
        *(instruction for number in forbidden for instruction in _where({number}, [_refuse()])),
        (_RETURN, 0, 0, _ALLOW),
    ]


def _where(numbers: Iterable[int], then: list[_Instruction]) -> list[_Instruction]:
    """Run instructions, which end in an answer, for calls of these numbers. The number must be loaded."""
    return [instruction for number in numbers for instruction in ((_JUMP_IF_EQUAL, 0, len(then), number), *then)]


def _argument(index: int, *, allowed: tuple[int, ...] = (), refused: tuple[int, ...] = ()) -> list[_Instruction]:
    """Answer by the lower 32 bits of an argument: allow these values alone, or refuse these alone."""
    values = allowed or refused
    by_value: list[_Instruction] = []
    for position, value in enumerate(values):
        by_value.append((_JUMP_IF_EQUAL, len(values) - position, 0, value))
    answers = (_allow(), _refuse()) if refused else (_refuse(), _allow())
    return [(_LOAD, 0, 0, _ARGUMENTS + 8 * index), *by_value, *answers]


def _flags_of_a_thread() -> list[_Instruction]:
    """Allow a new thread of this process; refuse a new process."""
    return [
        (_LOAD, 0, 0, _ARGUMENTS),
        (_JUMP_IF_ANY_BIT, 2, 0, _NEW_NAMESPACES),
        (_JUMP_IF_ANY_BIT, 0, 1, _THREAD),
        _allow(),
        _refuse(),
    ]


def _allow() -> _Instruction:
    return (_RETURN, 0, 0, _ALLOW)


def _refuse() -> _Instruction:
    return (_RETURN, 0, 0, _ERROR | errno.EPERM)
