"""Keys of a data folder: ``pf_ID_SECRET``, of which only a hash is kept.

The secret is 256 random bits, so its hash is one round of SHA-256: a slow hash protects passwords, which can be guessed one after
the other; nobody tries 2^256 secrets, and a slow hash would let strangers keep the service busy.

::

    DATA/keys.json    labels, hashes, scopes, projects and dates; mode 0600, replaced as a whole
    DATA/keys.lock    locked while it is changed
"""

from __future__ import annotations

import fcntl
import hashlib
import hmac
import json
import logging
import os
import re
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from render.errors import NotFoundError, OutputError, SettingsError
from render.files import sync_folder
from service.identity.principal import ALL_PROJECTS, PROJECT_PATTERN, SCOPES, Principal
from service.json_text import parse_json

log = logging.getLogger("pullfocus.service")

KEY_PREFIX = "pf_"
_KEY = re.compile(rf"{KEY_PREFIX}([0-9a-f]{{12}})_([\w-]{{43}})", re.ASCII)
_SECRET_BYTES = 32
_UNKNOWN = hashlib.sha256(secrets.token_bytes(_SECRET_BYTES)).hexdigest()
"""Hash that no secret has: what is sent for an unknown id is compared as well, so that both take the same time."""
MAX_LABEL = 100


@dataclass(frozen=True)
class Key:
    """A key as it is kept.

    Attributes:
        id: its public part.
        label: name for people.
        hash: SHA-256 of its secret, in hexadecimal digits.
        scopes: what it may do, sorted.
        project: whose shots it sees; ``*`` for every project.
        created_at: ISO 8601.
        expires_at: ISO 8601; None for never.
    """

    id: str
    label: str
    hash: str
    scopes: tuple[str, ...]
    project: str
    created_at: str
    expires_at: str | None

    def principal(self) -> Principal:
        """Return the sender that the key stands for."""
        ends_at = datetime.fromisoformat(self.expires_at) if self.expires_at else None
        return Principal(f"key:{self.id}", self.label, frozenset(self.scopes), self.project, ends_at)

    def is_expired(self, now: datetime) -> bool:
        """Return whether the key has expired."""
        return self.expires_at is not None and datetime.fromisoformat(self.expires_at) <= now


class Keys:
    """The keys of one data folder. They are read again when another process has changed them.

    Args:
        data: the data folder.
        now: the time.
    """

    def __init__(self, data: Path, now: Callable[[], datetime] = lambda: datetime.now(UTC)) -> None:
        self._file = data / "keys.json"
        self._lock = data / "keys.lock"
        self._now = now
        self._read_state: tuple[int, int, int] | None = None
        self._keys: dict[str, Key] = {}

    def list(self) -> list[Key]:
        """Return all keys, oldest first. Raises `OutputError`: the file cannot be read."""
        return sorted(self._load().values(), key=lambda key: (key.created_at, key.id))

    def verify(self, sent: str) -> Key | None:
        """Return the key that was sent; None where there is none such, or it has expired, or the keys cannot be read."""
        match = _KEY.fullmatch(sent)
        if match is None:
            return None
        key = self.find(match[1])
        is_right = hmac.compare_digest(_hash(match[2]), key.hash if key else _UNKNOWN)
        return key if is_right else None

    def find(self, key_id: str) -> Key | None:
        """Return a valid key by its id. Without a readable file no key is valid."""
        try:
            key = self._load().get(key_id)
        except OutputError as error:
            log.error("%s; no key is valid until then", error.detail)
            return None
        return None if key is None or key.is_expired(self._now()) else key

    def create(
        self, label: str, scopes: frozenset[str], project: str, expires_at: datetime | None = None
    ) -> tuple[Key, str]:
        """Add a key.

        Args:
            label: name for people.
            scopes: what it may do.
            project: whose shots it sees; ``*`` for every project.
            expires_at: end of its life; None for never.

        Returns:
            The key as it is kept, and the text to be sent, which cannot be shown again.

        Raises:
            SettingsError: label, scopes or project are not usable.
            OutputError: the file cannot be written.
        """
        _check(label, scopes, project)
        key_id, secret = secrets.token_hex(6), secrets.token_urlsafe(_SECRET_BYTES)
        now = self._now().isoformat(timespec="seconds")
        expires = expires_at.isoformat(timespec="seconds") if expires_at else None
        key = Key(key_id, label, _hash(secret), tuple(sorted(scopes)), project, now, expires)
        with self._changing() as keys:
            keys[key_id] = key
        return key, f"{KEY_PREFIX}{key_id}_{secret}"

    def revoke(self, key_id: str) -> Key:
        """Remove a key, which is refused from then on.

        Raises:
            NotFoundError: there is no key of this id.
            OutputError: the file cannot be written.
        """
        with self._changing() as keys:
            if key_id not in keys:
                raise NotFoundError(f"There is no key {key_id[:80]!r}.", code="key_not_found", path=key_id[:80])
            return keys.pop(key_id)

    @contextmanager
    def _changing(self) -> Iterator[dict[str, Key]]:
        """Read the keys, and write what the caller makes of them; one process at a time."""
        try:
            self._lock.parent.mkdir(parents=True, exist_ok=True)
            with self._lock.open("w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                keys = dict(self._load())
                yield keys
                self._write(keys)
        except OSError as error:
            raise OutputError(
                f"the keys in {self._file} cannot be written: {error.strerror}", path="keys.json"
            ) from error

    def _load(self) -> dict[str, Key]:
        try:
            stat = self._file.stat()
            state = (stat.st_ino, stat.st_mtime_ns, stat.st_size)
            if state != self._read_state:
                fields = parse_json(self._file.read_text(encoding="utf-8"))["keys"]
                self._keys = {entry["id"]: Key(**entry | {"scopes": tuple(entry["scopes"])}) for entry in fields}
                self._read_state = state
        except FileNotFoundError:
            self._keys, self._read_state = {}, None
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._keys, self._read_state = {}, None
            raise OutputError(
                f"the keys in {self._file} cannot be read: repair or remove the file", path="keys.json"
            ) from error
        return self._keys

    def _write(self, keys: dict[str, Key]) -> None:
        part = self._file.with_suffix(".part")
        part.unlink(missing_ok=True)
        descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            with os.fdopen(descriptor, "w", encoding="utf-8") as file:
                json.dump({"keys": [asdict(key) for key in keys.values()]}, file, indent=2)
                file.flush()
                os.fsync(file.fileno())
            os.replace(part, self._file)
        finally:
            part.unlink(missing_ok=True)
        sync_folder(self._file.parent)


def _hash(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()


def _check(label: str, scopes: frozenset[str], project: str) -> None:
    if not label.isprintable() or not 0 < len(label.strip()) <= MAX_LABEL:
        raise SettingsError(f"a label has 1 to {MAX_LABEL} printable characters", code="bad_label", path="label")
    if not scopes or scopes - SCOPES:
        raise SettingsError(f"a key has scopes of {', '.join(sorted(SCOPES))}", code="bad_scope", path="scopes")
    if project != ALL_PROJECTS and not re.fullmatch(PROJECT_PATTERN, project):
        detail = f"a project is a name of a-z, 0-9, _ and -, or * for all; got {project[:80]!r}"
        raise SettingsError(detail, code="bad_project", path="project")
    if "admin" in scopes and project != ALL_PROJECTS:
        raise SettingsError("a key that administers is for all projects: *", code="bad_project", path="project")
