"""Files that are either there and whole, or not there."""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import stat
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path

from render.errors import OutputError

_NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
_NOT_ALLOWED = frozenset({errno.EACCES, errno.EPERM, errno.EROFS})


def write_atomic(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file under a temporary name, then rename it: no reader sees a partial file.

    Args:
        path: the file. Its folder must exist; an existing file is replaced.
        content: all of its bytes.

    Raises:
        OutputError: the file cannot be written; an existing file is unchanged.
    """
    target = Path(path)
    with replace_whole(target) as beside, explain_write_errors(target):
        _write_through(beside, content)


@contextlib.contextmanager
def replace_whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary name beside a file: what is written there takes the file's place at the end, or is removed after an error.

    Args:
        path: the file. Its folder must exist; an existing file is replaced.

    Yields:
        The temporary name, under which the caller writes a file.

    Raises:
        OutputError: the file cannot be replaced; an existing file is unchanged.
    """
    target = Path(path)
    check_replaceable(target)
    beside = target.with_name(f".{target.name[:100]}.{uuid.uuid4().hex}.part")
    try:
        yield beside
        with explain_write_errors(target):
            os.replace(beside, target)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
        raise


@contextlib.contextmanager
def explain_write_errors(path: str | os.PathLike[str]) -> Iterator[None]:
    """Raise the operating system's errors of writing a file as `OutputError`.

    Args:
        path: the file that is written.

    Raises:
        OutputError: it cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise _explained(error, Path(path)) from error


def sync_file(path: str | os.PathLike[str]) -> None:
    """Wait until the disk has a file's content.

    Args:
        path: the file.

    Raises:
        OSError: the disk fails, or is full.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_folder(folder: str | os.PathLike[str]) -> None:
    """Wait until the disk has the names in a folder: a file that was renamed into it is there after a loss of power too.

    Args:
        folder: the folder.

    Raises:
        OutputError: the disk fails.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
    except OSError as error:
        raise OutputError(f"the disk fails at the folder {folder}: {error.strerror}", path=str(folder)) from error


def sync_file_system(folder: str | os.PathLike[str]) -> None:
    """Wait until the disk has all that was written to it: many files that were written one after the other, in one call.

    Args:
        folder: a folder on the disk.

    Raises:
        OutputError: the disk fails, or is full.
    """
    try:
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            if ctypes.CDLL(None, use_errno=True).syncfs(descriptor):
                raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
        finally:
            os.close(descriptor)
    except OSError as error:
        raise _explained(error, Path(folder)) from error


def read_regular_file(path: str | os.PathLike[str], most_bytes: int) -> bytes | None:
    """Content of a plain file; None for what is missing, larger, a link, a folder, a device or a pipe, which are not waited for.

    Args:
        path: the file.
        most_bytes: size that it may have.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):  # ValueError: a name with a null character
        return None
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode) or status.st_size > most_bytes:
        os.close(descriptor)
        return None
    with open(descriptor, "rb") as file:
        content = file.read(most_bytes + 1)
    return content if len(content) <= most_bytes else None


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise early the error that `write_atomic` would raise, as far as can be known: for results that take long to compute.

    Args:
        path: the file that is to be written.

    Raises:
        OutputError: it cannot be written.
    """
    target = Path(path)
    check_replaceable(target)
    if not os.path.isdir(target.parent):
        raise _explained(OSError(errno.ENOENT, os.strerror(errno.ENOENT)), target)
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise _explained(OSError(errno.EACCES, os.strerror(errno.EACCES)), target)
    try:  # what permissions do not tell: folders of the kernel's take no files from anybody
        with tempfile.TemporaryFile(dir=target.parent):
            pass
    except OSError as error:
        raise _explained(error, target) from error


def check_replaceable(target: Path) -> None:
    """See that no folder, device or pipe is in a file's place: it is not to be renamed over.

    Raises:
        OutputError: there is one.
    """
    if os.path.exists(target) and not os.path.isfile(target):  # unlike Path, these raise nothing
        what = "a folder" if os.path.isdir(target) else "a device or a pipe"
        raise OutputError(f"cannot write {target}: it is {what}, expected a file", path=str(target))


def _write_through(path: Path, content: bytes) -> None:
    """Write a new file and wait for the disk: a full network disk may report it only then."""
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def _explained(error: OSError, target: Path) -> OutputError:
    if error.errno in _NO_ROOM:
        code, reason = "disk_full", f"the disk is full ({error.strerror})"
    elif error.errno in _NOT_ALLOWED:
        code, reason = "not_allowed", f"writing in the folder {target.parent} is not allowed ({error.strerror})"
    elif error.errno in (errno.ENOENT, errno.ENOTDIR) and os.path.isdir(target.parent):
        code, reason = "output", f"no file can be made in the folder {target.parent} ({error.strerror})"
    elif error.errno in (errno.ENOENT, errno.ENOTDIR):
        code, reason = "missing_folder", f"the folder {target.parent} does not exist"
    else:
        code, reason = "output", error.strerror or str(error)
    return OutputError(f"cannot write {target}: {reason}", code=code, path=str(target))
