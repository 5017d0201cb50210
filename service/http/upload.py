"""An upload: from the bytes that were sent to files in a shot's folder, and which of them is the root layer."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import IO

from render.optics.lens_files import LENS_FILE_SUFFIXES
from service.http.archive import unpack
from service.http.errors import ServiceError
from service.http.settings import MEBIBYTE, Settings

STAGE_SUFFIXES = (".usda", ".usdc", ".usd", ".usdz")


def file_name(sent: str | None) -> str:
    """The name of an uploaded file, reduced to one that is safe in a folder.

    Raises:
        ServiceError: 415, it is neither a stage nor a zip archive by its ending.
    """
    name = _safe_name(sent)
    suffix = Path(name).suffix.lower()
    if suffix != ".zip" and suffix not in STAGE_SUFFIXES:
        detail = f"{name or 'The file'} was sent; expected .usda, .usdc, .usd, .usdz, or a .zip that holds one of them."
        raise ServiceError(415, "unsupported_type", detail, path=name or None)
    return name


def lens_file_name(sent: str | None) -> str:
    """The name of an uploaded lens file, for messages.

    Raises:
        ServiceError: 415, it is no lens file by its ending.
    """
    name = _safe_name(sent)
    if Path(name).suffix.lower() not in LENS_FILE_SUFFIXES:
        detail = f"{name or 'The file'} was sent; expected a lens file: {', '.join(LENS_FILE_SUFFIXES)}."
        raise ServiceError(415, "unsupported_type", detail, path=name or None)
    return name


def _safe_name(sent: str | None) -> str:
    last = re.split(r"[/\\]", sent or "")[-1]
    return re.sub(r"[^\w.\- ]", "_", last).lstrip(".")[-120:]


def place(file: IO[bytes], name: str, wanted_root: str | None, files: Path, settings: Settings) -> str:
    """Put an uploaded file, or what an uploaded archive holds, into a folder.

    Args:
        file: what was sent.
        name: its name, from `file_name`.
        wanted_root: which file of an archive is the root layer; None lets `choose_root` find it.
        files: the empty folder.
        settings: for their limits.

    Returns:
        The root layer, relative to the folder.

    Raises:
        ServiceError: 413 or 422, the upload is refused; the caller removes the folder.
    """
    if Path(name).suffix.lower() == ".zip":
        unpack(file, name, files, settings)
        paths = [path.relative_to(files).as_posix() for path in files.rglob("*") if path.is_file()]
        return choose_root(paths, wanted_root, name)
    if wanted_root not in (None, "", name):
        detail = f"{wanted_root!r} was named as root, but the one file that was sent is {name!r}."
        raise ServiceError(422, "bad_root", detail, path=wanted_root)
    with (files / name).open("xb") as out:
        shutil.copyfileobj(file, out, MEBIBYTE)
    return name


def choose_root(paths: Iterable[str], wanted: str | None, archive: str) -> str:
    """The root layer of an archive: the one that was asked for, else the only stage in the topmost folder with any.

    Args:
        paths: of all files, relative, with ``/``.
        wanted: the one asked for.
        archive: the archive's name, for messages.

    Raises:
        ServiceError: 422, there is no such file, no stage at all, or more than one that it could be.
    """
    known = set(paths)
    if wanted:
        root = PurePosixPath(wanted).as_posix()
        if root not in known or not root.lower().endswith(STAGE_SUFFIXES):
            raise ServiceError(422, "bad_root", f"{archive} holds no USD file {wanted!r}.", path=wanted)
        return root
    stages = sorted(path for path in known if path.lower().endswith(STAGE_SUFFIXES))
    if not stages:
        raise ServiceError(422, "no_stage", f"{archive} holds no .usda, .usdc, .usd or .usdz file.", path=archive)
    top = min(path.count("/") for path in stages)
    roots = [path for path in stages if path.count("/") == top]
    if len(roots) > 1:
        listed = ", ".join(roots[:8])
        detail = f"{archive} holds several stages that could be the root: {listed}; name one in the field 'root'."
        raise ServiceError(422, "ambiguous_root", detail, path=archive)
    return roots[0]
