"""MaterialX documents: .mtlx files with what they include, read with the standard library's parser of XML.

The MaterialX package reads files that a document names wherever they lie, and sources of shaders among them; so it never sees
a document as it is, but networks that are written for it anew (`render.stage.materials.mtlx.generation`).
"""

from __future__ import annotations

import contextlib
import functools
import os
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from pxr import Ar

from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import as_file, require_inside

MOST_BYTES = 16 * 2**20
MOST_INCLUDES = 100
MOST_NESTED = 100
_INSIDE = "\0"  # between a package and a folder in it
STUDIO_VARIABLE = "PXR_MTLX_PLUGIN_SEARCH_PATHS"
_INCLUDE = "{http://www.w3.org/2001/XInclude}include"
_XI = 'xmlns:xi="http://www.w3.org/2001/XInclude"'


class DocumentError(ValueError):
    """Document that cannot be read; the message gives the reason."""


@dataclass(frozen=True, eq=False)
class Document:
    """A MaterialX document.

    Attributes:
        root: its element.
        name: of the file.
        folder: that it lies in, or the package and the folder in it.
        included: documents that it includes, and those that they include.
    """

    root: ET.Element
    name: str
    folder: str
    included: tuple[Document, ...] = ()

    @property
    def version(self) -> str:
        """Version of MaterialX that it was written for."""
        return self.root.get("version") or "1.38"


def read_document(path: str, confined_to: Path | None) -> Document:
    """Read a document and what it includes.

    Args:
        path: file, which may lie in a package.
        confined_to: folder that it and what it includes must lie in, or None.

    Raises:
        DocumentError: a file is missing, too large, no XML, or lies outside; or there are too many.
    """
    return _read(path, confined_to, [])


@functools.cache
def studio_documents() -> tuple[Document, ...]:
    """Documents that define nodes for all materials: those in the folders of PXR_MTLX_PLUGIN_SEARCH_PATHS, as in OpenUSD.

    Those that cannot be read are left out.
    """
    found = []
    for folder in os.environ.get(STUDIO_VARIABLE, "").split(os.pathsep):
        for file in sorted(Path(folder).glob("**/*.mtlx"))[:MOST_INCLUDES] if folder else []:
            with contextlib.suppress(DocumentError):
                found.append(read_document(str(file), None))
    return tuple(found)


def _read(path: str, confined_to: Path | None, seen: list[str]) -> Document:
    if path in seen:
        raise DocumentError("it includes itself")
    seen.append(path)
    if len(seen) > MOST_INCLUDES:
        raise DocumentError(f"it includes more than {MOST_INCLUDES} files")
    root = _parse(path, confined_to)
    folder = folder_of(path)
    included = []
    for element in root.iter(_INCLUDE):
        href = element.get("href") or ""
        try:
            included.append(_read(file_in(folder, href), confined_to, seen))
        except DocumentError as problem:
            raise DocumentError(f"it includes {href}: {problem}") from problem
    return Document(root, Path(path.rstrip("]")).name, folder, tuple(included))


def _parse(path: str, confined_to: Path | None) -> ET.Element:
    try:
        require_inside(path, confined_to)
        with as_file(path) as file:
            if os.stat(file).st_size > MOST_BYTES:
                raise DocumentError(f"it is larger than {MOST_BYTES >> 20} MiB")
            text = Path(file).read_bytes()
        if b"<xi:include" in text and b"XInclude" not in text:
            text = text.replace(b"<materialx", b"<materialx " + _XI.encode(), 1)
        root = ET.fromstring(text)
        if _nesting(root) > MOST_NESTED:
            raise DocumentError(f"its elements are nested more than {MOST_NESTED} deep")
        return root
    except TextureError as problem:
        raise DocumentError(f"it {problem}") from problem
    except (OSError, ET.ParseError, ValueError, LookupError) as problem:  # of XML and of its encodings
        raise DocumentError("it is missing" if isinstance(problem, OSError) else str(problem)) from problem


def _nesting(root: ET.Element) -> int:
    depth, level = 0, [root]
    while level and depth <= MOST_NESTED:
        depth, level = depth + 1, [child for element in level for child in element]
    return depth


def folder_of(path: str) -> str:
    """Folder of a file, in its package where it lies in one."""
    if Ar.IsPackageRelativePath(path):
        package, inner = Ar.SplitPackageRelativePathInner(path)
        return f"{package}{_INSIDE}{os.path.dirname(inner)}"
    return os.path.dirname(path)


def file_in(folder: str, name: str) -> str:
    """Path of a file by its name relative to a folder of `folder_of`."""
    if _INSIDE in folder:
        package, _, inner = folder.partition(_INSIDE)
        return f"{package}[{os.path.normpath(os.path.join(inner, name))}]"
    return os.path.normpath(os.path.join(folder, name)) if name else ""
