"""Uploads: writes the files of a shot into its folder and finds its root layer."""

from __future__ import annotations

import shutil
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import IO

from render.optics.lens_files import LENS_FILE_SUFFIXES
from service.http.archive import unpack
from service.http.errors import ServiceError
from service.http.settings import MEBIBYTE, Settings
from service.models.base import plain_file_name

STAGE_SUFFIXES = (".usda", ".usdc", ".usd", ".usdz")
SIGNATURES = {b"#usda": ".usda", b"PXR-USDC": ".usdc", b"PK\x03\x04": ".zip"}
"""First bytes of a file that is sent under a name without a suffix, as of one that a client reads from a pipe."""
MAX_CANDIDATES = 200
"""Root layers that a refusal lists for a choice; an archive may hold thousands of stages."""
SIGNATURE_BYTES = max(map(len, SIGNATURES))


def upload_name(sent: str | None, begin: bytes) -> str:
    """Return the name of an uploaded shot, made safe for a folder. A name without a suffix gets that of the content.

    Args:
        sent: the name as it was sent.
        begin: the first `SIGNATURE_BYTES` of the file.

    Raises:
        ServiceError: 415, its suffix is neither that of a stage nor that of a zip archive.
    """
    name = plain_file_name(sent or "")
    if not Path(name).suffix:
        found = [suffix for signature, suffix in SIGNATURES.items() if begin.startswith(signature)]
        name = f"{name or 'shot'}{found[0]}" if found else name
    suffix = Path(name).suffix.lower()
    if suffix != ".zip" and suffix not in STAGE_SUFFIXES:
        detail = f"{name or 'The file'} was sent; expected .usda, .usdc, .usd, .usdz, or a .zip that holds one of them."
        raise ServiceError(415, "unsupported_type", detail, path=name or None)
    return name


def lens_file_name(sent: str | None) -> str:
    """Return the name of an uploaded lens file, for messages.

    Raises:
        ServiceError: 415, its suffix is not that of a lens file.
    """
    name = plain_file_name(sent or "")
    if Path(name).suffix.lower() not in LENS_FILE_SUFFIXES:
        detail = f"{name or 'The file'} was sent; expected a lens file: {', '.join(LENS_FILE_SUFFIXES)}."
        raise ServiceError(415, "unsupported_type", detail, path=name or None)
    return name


def store_upload(file: IO[bytes], name: str, root: str | None, files: Path, settings: Settings) -> str:
    """Write an uploaded file, or the files of an uploaded archive, into a folder.

    Args:
        file: the uploaded file.
        name: its name, from `upload_name`.
        root: root layer within an archive; None lets `choose_root` find it.
        files: the empty folder.
        settings: limits of archives.

    Returns:
        The root layer, relative to the folder.

    Raises:
        ServiceError: 413 or 422, the upload is refused; the caller removes the folder.
    """
    if Path(name).suffix.lower() == ".zip":
        unpack(file, name, files, settings)
        paths = [path.relative_to(files).as_posix() for path in files.rglob("*") if path.is_file()]
        return choose_root(paths, root, name)
    if root not in (None, "", name):
        detail = f"{root!r} was named as root, but the one file that was sent is {name!r}."
        raise ServiceError(422, "bad_root", detail, path=root)
    with (files / name).open("xb") as out:
        shutil.copyfileobj(file, out, MEBIBYTE)
    return name


def choose_root(paths: Iterable[str], requested: str | None, archive: str) -> str:
    """Return the root layer of an archive: the requested one, or the only stage in the topmost folder that has any.

    Args:
        paths: of all files, relative, with ``/``.
        requested: root layer named by the client, if any.
        archive: the archive's name, for messages.

    Raises:
        ServiceError: 422, there is no such file, no stage at all, or more than one candidate: `errors` has their paths then.
    """
    known = set(paths)
    if requested:
        root = PurePosixPath(requested).as_posix()
        if root not in known or not root.lower().endswith(STAGE_SUFFIXES):
            raise ServiceError(422, "bad_root", f"{archive} holds no USD file {requested!r}.", path=requested)
        return root
    stages = sorted(path for path in known if path.lower().endswith(STAGE_SUFFIXES))
    if not stages:
        raise ServiceError(422, "no_stage", f"{archive} holds no .usda, .usdc, .usd or .usdz file.", path=archive)
    top = min(path.count("/") for path in stages)
    roots = [path for path in stages if path.count("/") == top]
    if len(roots) > 1:
        listed = ", ".join(roots[:8])
        detail = f"{archive} holds several stages that could be the root: {listed}; name one in the field 'root'."
        candidates = {path: f"{path} could be the root layer." for path in roots[:MAX_CANDIDATES]}
        raise ServiceError(422, "ambiguous_root", detail, path=archive, errors=candidates)
    return roots[0]
