"""Audit log: one line of JSON for each request that changes something or is refused, and never a secret.

::

    DATA/audit.jsonl            what changed something
    DATA/audit-refused.jsonl    what was refused: strangers may fill it, and push no line out of the other

A full file becomes ``audit.jsonl.1``, and so on up to `KEPT_FILES`.
"""

from __future__ import annotations

import errno
import json
import logging
import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

log = logging.getLogger("pullfocus.service")

MAX_BYTES = 16 * 1024 * 1024
KEPT_FILES = 5


class AuditLog:
    """Appends lines to one file.

    Args:
        file: the file.
        max_bytes: size at which a file is full.
    """

    def __init__(self, file: Path, max_bytes: int = MAX_BYTES) -> None:
        self._file = file
        self._max_bytes = max_bytes

    def write(self, fields: Mapping[str, object]) -> None:
        """Append a line. A line that cannot be written is logged instead; the request is not refused for it."""
        line = json.dumps(fields, ensure_ascii=True) + "\n"
        try:
            self._rotate(len(line) + 1)
            descriptor = os.open(self._file, os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o600)
            try:
                size = os.fstat(descriptor).st_size
                is_cut = size > 0 and os.pread(descriptor, 1, size - 1) != b"\n"  # by a crash or a full disk
                content = ("\n" * is_cut + line).encode()
                if os.write(descriptor, content) < len(content):  # the disk has room for a part of it
                    os.ftruncate(descriptor, size)
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            finally:
                os.close(descriptor)
        except OSError as error:
            log.error("a line of the audit log cannot be written (%s): %s", error.strerror, line.rstrip())

    def _rotate(self, added: int) -> None:
        with suppress(FileNotFoundError):
            if self._file.stat().st_size + added <= self._max_bytes:
                return
            for number in range(KEPT_FILES - 1, 0, -1):
                with suppress(FileNotFoundError):
                    os.replace(self._numbered(number), self._numbered(number + 1))
            os.replace(self._file, self._numbered(1))

    def _numbered(self, number: int) -> Path:
        return self._file.with_name(f"{self._file.name}.{number}")
