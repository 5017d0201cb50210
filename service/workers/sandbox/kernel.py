"""System calls that Python's library has no functions for, by ctypes."""

from __future__ import annotations

import ctypes
import os
import platform
import sys
from functools import cache

_SET_NO_NEW_PRIVILEGES = 38
"""Operation of prctl."""
_CAPABILITIES_VERSION = 0x20080522
_KEPT_CAPABILITIES = 1 << 1
"""CAP_DAC_OVERRIDE: a service that runs as root may have files of other users in its data folder, and Landlock decides which."""


class _CapabilityHeader(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint32), ("pid", ctypes.c_int))


class _CapabilitySet(ctypes.Structure):
    _fields_ = (("effective", ctypes.c_uint32), ("permitted", ctypes.c_uint32), ("inheritable", ctypes.c_uint32))


@cache
def _library() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def machine() -> str:
    """Return the architecture as Linux names it, such as ``x86_64``; empty on other systems and in 32-bit programs."""
    return platform.machine() if sys.platform == "linux" and sys.maxsize > 2**32 else ""


def system_call(number: int, *arguments: int | ctypes.c_void_p | None) -> int:
    """Make a system call.

    Args:
        number: its number on this architecture.
        arguments: integers of up to 64 bits, and pointers from `address_of`.

    Returns:
        The result, 0 or more.

    Raises:
        OSError: the kernel refuses; ENOSYS where it has no such call.
    """
    words = [ctypes.c_uint64(argument) if isinstance(argument, int) else argument for argument in arguments]
    result: int = _function("syscall", ctypes.c_long)(ctypes.c_long(number), *words)
    return _checked(result)


def address_of(value: ctypes.Structure | ctypes.c_uint32) -> ctypes.c_void_p:
    """Return a pointer for `system_call`. The caller keeps the value."""
    return ctypes.cast(ctypes.pointer(value), ctypes.c_void_p)


def forbid_new_privileges() -> None:
    """Set ``no_new_privs`` for this thread: the kernel demands it of a process that restricts itself without being root.

    Raises:
        OSError: the kernel refuses.
    """
    one, zero = ctypes.c_ulong(1), ctypes.c_ulong(0)
    _checked(_function("prctl", ctypes.c_int)(_SET_NO_NEW_PRIVILEGES, one, zero, zero, zero))


def drop_capabilities() -> None:
    """Give up what root may do beyond other users, but for the permissions of files.

    Raises:
        OSError: the kernel refuses.
    """
    header = _CapabilityHeader(_CAPABILITIES_VERSION, 0)
    held = (_CapabilitySet * 2)()
    _checked(_function("capget", ctypes.c_int)(ctypes.byref(header), held))
    kept = held[0].permitted & _KEPT_CAPABILITIES
    sets = (_CapabilitySet * 2)(_CapabilitySet(kept, kept, 0), _CapabilitySet(0, 0, 0))
    _checked(_function("capset", ctypes.c_int)(ctypes.byref(header), sets))


@cache
def _function(name: str, result: type[ctypes.c_long | ctypes.c_int]) -> ctypes._NamedFuncPointer:
    function: ctypes._NamedFuncPointer = getattr(_library(), name)
    function.restype = result
    return function


def _checked(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result
