"""Bucket of S3-compatible storage, which services of several machines share."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime, timedelta
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from render.errors import OutputError, SettingsError
from render.files import explain_write_errors, replace_whole, sync_file
from service.storage.errors import UnavailableError

Reply = TypeVar("Reply")

_FORM = "s3://BUCKET or s3://BUCKET/PREFIX"
_SETTING = re.compile(r"s3://([a-z0-9][a-z0-9.-]{1,61}[a-z0-9])(?:/([A-Za-z0-9._/-]{1,200}))?")
_ENDPOINT = re.compile(r"https?://[^\s/@?#]+/?")
_CONNECT_S, _ANSWER_S, _RETRY_S = 5, 60, 20
"""Times for a connection, for an answer, and in which a request is sent again, s."""
_RETRIES = 2
PART_BYTES = 8 << 20
"""Bytes that are read at a time."""


class Bucket:
    """A bucket, or the part of it below a prefix. Any thread may use it.

    Who may use it is said as for other programs: by ``AWS_ACCESS_KEY_ID`` and ``AWS_SECRET_ACCESS_KEY``, or by the machine.

    Args:
        setting: ``s3://BUCKET`` or ``s3://BUCKET/PREFIX``.
        endpoint: address of a server other than Amazon's; empty for that of ``AWS_ENDPOINT_URL``, or Amazon's.

    Raises:
        SettingsError: the setting is no bucket, or the library is not installed.
    """

    def __init__(self, setting: str, endpoint: str = "") -> None:
        found = _SETTING.fullmatch(setting)
        if not found or ".." in setting:
            raise SettingsError(f"the setting bucket is {_FORM}, got {setting[:80]!r}", code="bad_bucket")
        if endpoint and not _ENDPOINT.fullmatch(endpoint):
            raise SettingsError("the setting bucket_endpoint is http(s)://HOST:PORT", code="bad_bucket")
        try:
            self._obstore: Any = import_module("obstore")
            stores: Any = import_module("obstore.store")
        except ImportError as error:
            detail = "a bucket needs another package: pip install 'pullfocus[s3]'"
            raise SettingsError(detail, code="bad_bucket") from error
        self.name = setting
        self._errors = (self._obstore.exceptions.BaseError, OSError, ValueError)
        self._store = stores.S3Store(
            found[1],
            prefix=found[2],
            client_options={
                "allow_http": True,
                "connect_timeout": timedelta(seconds=_CONNECT_S),
                "timeout": timedelta(seconds=_ANSWER_S),
            },
            retry_config={"max_retries": _RETRIES, "retry_timeout": timedelta(seconds=_RETRY_S)},
            **({"endpoint": endpoint.rstrip("/"), "virtual_hosted_style_request": False} if endpoint else {}),
        )

    def check(self) -> None:
        """Look at whether it can be used. Raises `UnavailableError`."""
        self._ask(lambda: self._obstore.list_with_delimiter(self._store, prefix="check"))

    def put(self, name: str, content: bytes | Path) -> None:
        """Store an object; it is there as a whole or not at all.

        Args:
            name: of the object, with slashes.
            content: its bytes, or a file of them.

        Raises:
            UnavailableError: it cannot be stored.
        """
        self._ask(lambda: self._obstore.put(self._store, name, content))

    def put_new(self, name: str, content: bytes) -> bool:
        """Store an object where there is none. Returns whether it was so. Raises `UnavailableError`."""
        if self.age_s(name) is not None:
            return False
        self.put(name, content)  # not all servers can do both at once
        return self.read(name) == content

    def read(self, name: str) -> bytes | None:
        """Return a small object; None where there is none. Raises `UnavailableError`."""
        found = self._find(lambda: self._obstore.get(self._store, name).bytes())
        return None if found is None else bytes(found)

    def parts(self, name: str) -> Iterator[bytes]:
        """Yield an object in parts. Raises `UnavailableError`: there is none, or it cannot be read."""
        stream = self._ask(lambda: self._obstore.get(self._store, name).stream(min_chunk_size=PART_BYTES))
        while (part := self._ask(lambda: next(stream, None))) is not None:
            yield bytes(part)

    def fetch(self, name: str, sha256: str, path: Path) -> bool:
        """Copy an object to a file, which is there as a whole or not at all.

        Args:
            name: of the object.
            sha256: expected hash of its content, in hexadecimal digits.
            path: of the file, whose folder is there.

        Returns:
            Whether there is such an object.

        Raises:
            UnavailableError: it cannot be read.
            OutputError: the file cannot be written.
        """
        if self.age_s(name) is None:
            return False
        digest = hashlib.sha256()
        parts = self.parts(name)
        try:
            with replace_whole(path) as beside:
                with explain_write_errors(path), beside.open("wb") as file:
                    for part in parts:
                        digest.update(part)
                        file.write(part)
                sync_file(beside)
                if digest.hexdigest() != sha256:
                    raise _DamagedError("", code="damaged")
        except _DamagedError:
            return False
        return True

    def sizes(self, folder: str) -> dict[str, int]:
        """Return the sizes of all objects in a folder, bytes, by their names within it. Raises `UnavailableError`."""
        listed = self._ask(lambda: [one for some in self._obstore.list(self._store, prefix=folder) for one in some])
        return {one["path"].removeprefix(f"{folder}/"): one["size"] for one in listed}

    def folders(self, folder: str) -> list[str]:
        """Return the names of the folders in a folder. Raises `UnavailableError`."""
        listed = self._ask(lambda: self._obstore.list_with_delimiter(self._store, prefix=folder))
        return [path.rstrip("/").rpartition("/")[2] for path in listed["common_prefixes"]]

    def age_s(self, name: str) -> float | None:
        """Return the time since an object was stored, s; None where there is none. Raises `UnavailableError`."""
        found = self._find(lambda: self._obstore.head(self._store, name))
        return None if found is None else (datetime.now(UTC) - found["last_modified"]).total_seconds()

    def delete(self, names: Iterable[str]) -> None:
        """Delete objects; it is no error if they are not there. Raises `UnavailableError`."""
        listed = list(names)
        if listed:
            self._find(lambda: self._obstore.delete(self._store, listed))

    def _find(self, ask: Callable[[], Reply]) -> Reply | None:
        """Ask about an object that may not be there. Raises `UnavailableError`."""
        try:
            return ask()
        except FileNotFoundError:
            return None
        except self._errors as error:
            raise _unavailable(error) from error

    def _ask(self, ask: Callable[[], Reply]) -> Reply:
        try:
            return ask()
        except self._errors as error:
            raise _unavailable(error) from error


class _DamagedError(OutputError):
    """An object has another hash than was expected."""


def _unavailable(error: Exception) -> UnavailableError:
    """Return the error of a bucket, for clients: they are not told where it is."""
    kind = type(error).__name__.removesuffix("Error")
    reason = {
        "PermissionDenied": "it does not let the service in",
        "Unauthenticated": "it does not know the service",
        "FileNotFound": "something is missing there",
    }.get(kind, "it cannot be reached, or refuses what is asked of it")
    return UnavailableError(f"the bucket of renders cannot be used now: {reason}", code="bucket_unusable")
