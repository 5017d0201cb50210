"""Filter of system calls (seccomp): what a worker never needs answers EPERM, in all of its threads, for good."""

from __future__ import annotations

import ctypes
import errno
import os
import struct

from service.workers.sandbox.call_filter import ERROR, make_filter
from service.workers.sandbox.kernel import address_of, machine, system_call

_SECCOMP = {"x86_64": 317, "aarch64": 277}
_SET_MODE_FILTER, _GET_ACTION_AVAIL = 1, 2
_ALL_THREADS = 1


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p))


def is_offered() -> bool:
    """Whether the kernel takes filters from us, on an architecture that we have one for."""
    if machine() not in _SECCOMP:
        return False
    try:
        system_call(_SECCOMP[machine()], _GET_ACTION_AVAIL, 0, address_of(ctypes.c_uint32(ERROR)))
    except OSError:
        return False
    return True


def forbid_calls() -> None:
    """Forbid the calls in all threads of this process, and in what they start. ``no_new_privs`` must be set.

    Raises:
        OSError: the kernel refuses.
    """
    code = b"".join(struct.pack("=HBBI", *instruction) for instruction in make_filter(machine(), os.getpid()))
    program = _Program(len(code) // 8, code)
    thread = system_call(_SECCOMP[machine()], _SET_MODE_FILTER, _ALL_THREADS, address_of(program))
    if thread:
        raise OSError(errno.EBUSY, f"thread {thread} has another filter of system calls")
