"""Landlock: a process gives up the files outside a list of paths, for good, with all that it starts later (Linux 5.13 on).

Each version of the interface (its *ABI*) restricts more than the one before; rights that the kernel does not know are left out:

==== ====== ===========================================================
ABI  Linux  restricts too
==== ====== ===========================================================
1    5.13   opening, listing, creating and removing files
2    5.19   renames from one folder to another, refused altogether before
3    6.2    truncating a file by its path
4    6.7    TCP: connecting and binding
5    6.10   ioctl on devices
6    6.12   abstract Unix sockets and signals to processes outside
8    7.0    threads that exist already
==== ====== ===========================================================

Landlock judges the file that a path leads to: symbolic links, ``..`` and ``/proc/self/root`` lead nowhere else. It does not
restrict ``stat``, so whether a path exists, its size and its times stay visible, nor files that are open already.
"""

from __future__ import annotations

import ctypes
import os
import stat
from collections.abc import Iterable
from pathlib import Path

from service.workers.sandbox.kernel import address_of, machine, system_call

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446  # on all architectures
_VERSION_FLAG = 1
_PATH_BENEATH = 1
_ALL_THREADS = 1 << 3

_WRITE_FILE, _READ_FILE, _READ_DIR = 1 << 1, 1 << 2, 1 << 3
_REMOVE_DIR, _REMOVE_FILE = 1 << 4, 1 << 5
_MAKE_DIR, _MAKE_FILE = 1 << 7, 1 << 8
_REFER, _TRUNCATE, _DEVICE_IOCTL = 1 << 13, 1 << 14, 1 << 15
_FILE_RIGHTS = ((1, (1 << 13) - 1), (2, _REFER), (3, _TRUNCATE), (5, _DEVICE_IOCTL))
"""Rights on files by the ABI that knows them first."""
_OF_FILES = 1 | _WRITE_FILE | _READ_FILE | _TRUNCATE | _DEVICE_IOCTL
"""Rights that a rule about anything but a folder may name."""

ALL_THREADS_ABI = 8
"""ABI from which on the threads that exist already are bound too."""
READ = _READ_FILE | _READ_DIR
WRITE = READ | _WRITE_FILE | _REMOVE_DIR | _REMOVE_FILE | _MAKE_DIR | _MAKE_FILE | _REFER | _TRUNCATE
"""No links, pipes, sockets or devices are created."""
DEVICE = READ | _WRITE_FILE | _DEVICE_IOCTL

_TCP, _TCP_ABI = 0b11, 4
_SCOPES, _SCOPES_ABI = 0b11, 6


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scopes", ctypes.c_uint64))


class _PathRule(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("allowed", ctypes.c_uint64), ("descriptor", ctypes.c_int32))


def abi() -> int:
    """Return the ABI that the kernel offers; 0 where it has no Landlock or does not let us use it."""
    if not machine():
        return 0
    try:
        return system_call(_CREATE_RULESET, None, 0, _VERSION_FLAG)
    except OSError:
        return 0


def restrict_files(version: int, rules: Iterable[tuple[Path, int]]) -> None:
    """Give up all files but those of a list, all TCP, and signals and abstract sockets to processes outside.

    It binds this thread and what it starts later; threads that exist already only from ABI 8 on. ``no_new_privs`` must be set.

    Args:
        version: the ABI to use, from `abi`.
        rules: paths with their rights, `READ`, `WRITE` or `DEVICE`; those of a folder hold for all that is in it. A path that
            cannot be reached is left out.

    Raises:
        OSError: the kernel refuses.
    """
    known = sum(rights for since, rights in _FILE_RIGHTS if since <= version)
    ruleset = _Ruleset(known, _TCP if version >= _TCP_ABI else 0, _SCOPES if version >= _SCOPES_ABI else 0)
    size = 8 if version < _TCP_ABI else 16 if version < _SCOPES_ABI else 24
    descriptor = system_call(_CREATE_RULESET, address_of(ruleset), size, 0)
    try:
        for path, rights in rules:
            _allow(descriptor, path, rights & known)
        system_call(_RESTRICT_SELF, descriptor, _ALL_THREADS if version >= ALL_THREADS_ABI else 0)
    finally:
        os.close(descriptor)


def _allow(ruleset: int, path: Path, rights: int) -> None:
    try:
        descriptor = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:  # there is none, or not for us
        return
    try:
        is_folder = stat.S_ISDIR(os.fstat(descriptor).st_mode)
        rule = _PathRule(rights if is_folder else rights & _OF_FILES, descriptor)
        system_call(_ADD_RULE, ruleset, _PATH_BENEATH, address_of(rule), 0)
    finally:
        os.close(descriptor)
