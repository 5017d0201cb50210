"""OpenColorIO configurations from outside: all that they read is handed to OpenColorIO, which opens no file itself.


OpenColorIO asks for each file by a name below a root that exists nowhere (``/shot-…``). A name that leaves that root leads to
nothing, whether there is such a file or not: absolute ones, ``..``, links, ``<Reference path>`` in a .ctf or .clf, variables.
The process's environment is not seen: variables have the defaults that the configuration itself declares.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import lzma
import os
import posixpath
import re
import struct
import zipfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path, PurePosixPath
from xml.parsers import expat

import PyOpenColorIO as ocio

from render.files import read_regular_file

MAX_CONFIG_BYTES = 8 * 2**20
MAX_LUT_BYTES = 96 * 2**20  # a cube of 129, the largest that OpenColorIO takes, as text
MAX_READ_BYTES = 256 * 2**20  # of all files of a configuration; and of an archive, packed
MAX_ARCHIVE_ENTRIES = 4096
MAX_REFERENCES = 16  # of all .ctf files of a configuration: two in each of some twenty files are a million transforms
MAX_ALIASES = 16  # of YAML, for the same reason
_ANCHOR = re.compile(r"(?:^|[\s\[{,:-])&[\w.-]")
_ALIAS = re.compile(r"(?:^|[\s\[{,:-])\*[\w.-]")
_ARCHIVED_CONFIG = "config.ocio"
ReadFile = Callable[[str], "bytes | None"]
"""Reads a file by its path from the root; None where there is none that may be read."""


class ConfinedConfigError(ValueError):
    """Configuration that is refused; the message gives the reason."""


@dataclass(frozen=True)
class ConfinedConfig:
    """Configuration file, or archive (.ocioz), that may read nothing outside of a folder.

    Attributes:
        path: the file, absolute.
        folder: what it may read.
    """

    path: str
    folder: Path

    def __str__(self) -> str:
        """Path from the folder."""
        return os.path.relpath(os.path.realpath(self.path), os.path.realpath(self.folder))

    @property
    def root(self) -> str:
        """The root that OpenColorIO is shown; no other file has it, since OpenColorIO caches files by name."""
        stamp = os.stat(self.path)
        key = f"{self.folder}\0{self.path}\0{stamp.st_mtime_ns}\0{stamp.st_size}"
        return f"/shot-{hashlib.sha256(key.encode('utf-8', 'surrogateescape')).hexdigest()[:16]}"

    def as_sent(self, text: str) -> str:
        """A message of OpenColorIO with the files named from the folder."""
        return re.sub(r"/shot-[0-9a-f]{16}/?", "", text)


@lru_cache(maxsize=8)
def read_confined_config(source: ConfinedConfig, stamp: tuple[int, int]) -> tuple[ocio.Config, object]:
    """Read a configuration.

    Args:
        source: the file.
        stamp: changes when the file is rewritten.

    Returns:
        The configuration, and what must live as long as it does.

    Raises:
        ConfinedConfigError: it is too large, damaged as an archive, no text, or grows without end when it is read.
        PyOpenColorIO.Exception: it is no configuration.
    """
    del stamp
    archived = source.path.lower().endswith(".ocioz")
    read, name = _read_in_archive(source) if archived else _read_in_folder(source)
    content = read(name)
    if content is None:
        raise ConfinedConfigError("it is missing, no plain file, or too large")
    files = _Files(source.root, read, _checked_text(content))
    config = ocio.Config.CreateFromConfigIOProxy(files)
    _forget_environment(config)
    config.setWorkingDir(posixpath.join(source.root, posixpath.dirname(name)))
    return config, files


def leaves_root(config: ocio.Config, source: ConfinedConfig, name: str) -> bool:
    """Whether a file that a transform names would lie outside of the folder, wherever the configuration looks for it."""
    context = config.getCurrentContext()
    found = str(context.resolveStringVar(name))
    base = str(config.getWorkingDir())
    searched = [context.resolveStringVar(path) for path in config.getSearchPaths()] or [""]
    return not all(_below(source.root, posixpath.join(base, path, found)) for path in searched)


# OpenColorIO looks on the disk for what it is told does not exist. So what is refused exists, and is no file of any format.
_REFUSED = "refused"


class _Files(ocio.PyConfigIOProxy):  # type: ignore[misc]
    """Files that OpenColorIO is handed. Its methods must not raise: OpenColorIO does not expect it."""

    def __init__(self, root: str, read: ReadFile, config: str) -> None:
        ocio.PyConfigIOProxy.__init__(self)
        self._root, self._read_file, self._config = root, read, config
        self._hashes: dict[str, str] = {}
        self._last: tuple[str, bytes] = ("", b"")
        self._references = 0
        self._left_bytes = MAX_READ_BYTES

    def getConfigData(self) -> str:  # noqa: N802 (OpenColorIO's name)
        """Text of the configuration."""
        return self._config

    def getLutData(self, path: str) -> ocio.vector_of_uint8_t:  # noqa: N802
        """Content of a file."""
        return ocio.vector_of_uint8_t(self._content(path) if self.getFastLutFileHash(path) != _REFUSED else b"\0")

    def getFastLutFileHash(self, path: str) -> str:  # noqa: N802
        """Hash of a file; empty where there is none."""
        if path not in self._hashes:
            self._hashes[path] = self._hash(path)
        return self._hashes[path]

    def _hash(self, path: str) -> str:
        if not _below(self._root, path):
            return _REFUSED
        content = self._content(path)
        if content and not self._is_allowed(content):
            return _REFUSED
        return hashlib.sha256(content).hexdigest() if content else ""

    def _content(self, path: str) -> bytes:
        """Content of a file, empty where there is none; OpenColorIO asks for the same one for each format that it tries."""
        if self._last[0] != path:
            self._last = path, self._read_file(_below(self._root, path)) or b""
        return self._last[1]

    def _is_allowed(self, content: bytes) -> bool:
        """Whether a file, with those before it, is small enough and refers to few enough others. It must declare no entities."""
        count = count_references(content)
        self._references += count or 0
        self._left_bytes -= len(content)
        return count is not None and self._references <= MAX_REFERENCES and self._left_bytes >= 0


def count_references(content: bytes) -> int | None:
    """Number of ``<Reference>`` elements of a .ctf or .clf, 0 for other files; None where it has a document type declaration.

    It is parsed as OpenColorIO does, by expat, whatever its encoding; the rest of a file that is no XML does not count.
    """
    if b"<" not in content:
        return 0
    count, declares = 0, False

    def start(name: str, _: object) -> None:
        nonlocal count
        count += name == "Reference"

    def declare(*_: object) -> None:
        nonlocal declares
        declares = True

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.StartDoctypeDeclHandler = start, declare
    with contextlib.suppress(expat.ExpatError, ValueError, LookupError):  # of the encoding that it says
        parser.Parse(content, True)
    return None if declares else count


def _below(root: str, path: str) -> str:
    """Path from the root; empty where a path does not lie below it."""
    whole = posixpath.normpath(path)
    return whole[len(root) + 1 :] if whole.startswith(root + "/") else ""


def _forget_environment(config: ocio.Config) -> None:
    """Leave the context the defaults of the variables that the configuration declares."""
    declared = {name: config.getEnvironmentVarDefault(name) for name in config.getEnvironmentVarNames()}
    config.setEnvironmentMode(ocio.ENV_ENVIRONMENT_LOAD_PREDEFINED)
    config.clearEnvironmentVars()
    for name, default in declared.items():
        config.addEnvironmentVar(name, default)


def _checked_text(content: bytes) -> str:
    if len(content) > MAX_CONFIG_BYTES:
        raise ConfinedConfigError(f"it is larger than {MAX_CONFIG_BYTES // 2**20} MiB")
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        raise ConfinedConfigError("it is no text") from error
    if _ANCHOR.search(text) and len(_ALIAS.findall(text)) > MAX_ALIASES:
        raise ConfinedConfigError(f"it has more than {MAX_ALIASES} YAML aliases (*name): write out what they stand for")
    return text


def _read_in_folder(source: ConfinedConfig) -> tuple[ReadFile, str]:
    folder = Path(os.path.realpath(source.folder))

    def read(name: str) -> bytes | None:
        try:
            file = os.path.realpath(folder / name)
        except (OSError, ValueError):  # a name with a null character
            return None
        return read_regular_file(file, MAX_LUT_BYTES) if Path(file).is_relative_to(folder) else None

    return read, PurePosixPath(os.path.relpath(os.path.realpath(source.path), folder)).as_posix()


def _read_in_archive(source: ConfinedConfig) -> tuple[ReadFile, str]:
    packed = read_regular_file(os.path.realpath(source.path), MAX_READ_BYTES)
    if packed is None:
        raise ConfinedConfigError("it is missing, no plain file, or too large")
    if packed.count(b"PK\x01\x02") > MAX_ARCHIVE_ENTRIES:
        raise ConfinedConfigError(f"it holds more than {MAX_ARCHIVE_ENTRIES} files")
    try:
        archive = zipfile.ZipFile(io.BytesIO(packed))
    except (zipfile.BadZipFile, ValueError, OverflowError, struct.error) as error:
        raise ConfinedConfigError("it is no archive that can be read") from error
    entries = {posixpath.normpath(entry.filename): entry for entry in archive.infolist()}

    def read(name: str) -> bytes | None:
        entry = entries.get(name)
        if entry is None or entry.file_size > MAX_LUT_BYTES:
            return None
        try:
            with archive.open(entry) as file:
                content = file.read(MAX_LUT_BYTES + 1)
        except (
            zipfile.BadZipFile,
            zlib.error,
            lzma.LZMAError,
            struct.error,
            EOFError,
            OSError,
            RuntimeError,
            ValueError,
        ):
            return None
        return content if len(content) <= MAX_LUT_BYTES else None

    return read, _ARCHIVED_CONFIG
