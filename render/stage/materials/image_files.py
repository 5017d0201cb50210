"""Image files are opened by their content, as one of a few formats, and their headers are judged before a pixel is read."""

from __future__ import annotations

import contextlib
import functools
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

import OpenImageIO as oiio

MAX_SIDE = 65_536
MAX_PIXELS = 2**28  # 16384 x 16384
MAX_CHANNELS = 64  # in the file; four are read
MAX_BYTES = 2**30  # of the channels that are read
MAX_TILES = 2**20
# No format of these packs tighter: deflate 1032, LZW some 3000, a JPEG of one colour some 1000. Small images do no harm.
MAX_PACKING = 4_000
PACKING_FLOOR_BYTES = 64 * 2**20
_HEAD_BYTES = 18
_HEADS: tuple[tuple[bytes, str, tuple[str, ...]], ...] = (
    (b"\x89PNG\r\n\x1a\n", "png", (".png",)),
    (b"\xff\xd8\xff", "jpeg", (".jpg", ".jpeg", ".jpe")),
    (b"\x76\x2f\x31\x01", "openexr", (".exr", ".sxr", ".mxr")),
    (b"II*\0", "tiff", (".tif", ".tiff", ".tx", ".env", ".sm", ".vsm")),
    (b"MM\0*", "tiff", (".tif", ".tiff", ".tx", ".env", ".sm", ".vsm")),
    (b"II+\0", "tiff", (".tif", ".tiff", ".tx", ".env", ".sm", ".vsm")),
    (b"MM\0+", "tiff", (".tif", ".tiff", ".tx", ".env", ".sm", ".vsm")),
    (b"#?", "hdr", (".hdr", ".rgbe")),
    (b"RIFF", "webp", (".webp",)),
    (b"GIF8", "gif", (".gif",)),
    (b"BM", "bmp", (".bmp", ".dib")),
    (b"DDS ", "dds", (".dds",)),
    (b"8BPS", "psd", (".psd", ".pdd", ".psb")),
    (b"SDPX", "dpx", (".dpx",)),
    (b"XPDS", "dpx", (".dpx",)),
    (b"\x80\x2a\x5f\xd7", "cineon", (".cin",)),
    (b"\x01\xda", "sgi", (".sgi", ".rgb", ".rgba", ".bw", ".int", ".inta")),
    (b"\0\0\0\x0cjP  ", "jpeg2000", (".jp2", ".j2k", ".j2c")),
    (b"\xff\x4f\xff\x51", "jpeg2000", (".j2k", ".j2c", ".jp2")),
    (b"\xff\x0a", "jpegxl", (".jxl",)),
    (b"\0\0\0\x0cJXL ", "jpegxl", (".jxl",)),
    (b"FOR4", "iff", (".iff", ".z")),
    *(
        (b"P" + kind, "pnm", (".pnm", ".ppm", ".pgm", ".pbm", ".pfm"))
        for kind in (b"1", b"2", b"3", b"4", b"5", b"6", b"F", b"f")
    ),
)
_TARGA_SUFFIXES = (".tga", ".tpic")
_TARGA_KINDS = (1, 2, 3, 9, 10, 11)


class TextureError(ValueError):
    """Texture that cannot be read; the message gives the reason."""


@functools.cache
def _set_limits() -> None:
    """Set the limits of OpenImageIO's own, once: some readers decode a whole image to tell its size."""
    oiio.attribute("limits:imagesize_MB", 2 * MAX_BYTES // 2**20)
    oiio.attribute("limits:resolution", MAX_SIDE)


@contextlib.contextmanager
def open_image(file: str, request: oiio.ImageSpec) -> Iterator[oiio.ImageInput]:
    """Open an image file, whose header has been judged.

    Args:
        file: path of a plain file.
        request: configuration of the reader.

    Raises:
        TextureError: it is no plain file, is of no known format or is damaged, or declares more than may be read.
    """
    _set_limits()
    size, kind, suffixes = _identify(file)
    with _file_with_suffix(file, suffixes) as named:
        handle = oiio.ImageInput.open(named, request)
        if handle is None:
            raise TextureError(f"cannot be read: {_without_name(oiio.geterror(), named) or 'unknown format'}")
        try:
            if handle.format_name() != kind:
                raise TextureError(f"cannot be read: it begins as {kind}, and is none")
            _check_header(handle.spec(), size)
            yield handle
        finally:
            handle.close()


def read_error(handle: oiio.ImageInput) -> TextureError:
    """Error of a reader whose pixels cannot be read."""
    return TextureError(f"cannot be read: {_without_name(handle.geterror(), '')}")


def _identify(file: str) -> tuple[int, str, tuple[str, ...]]:
    """Size of a file in bytes, its format by its content, and the suffixes of that format."""
    try:
        descriptor = os.open(file, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError) as error:
        raise TextureError("is missing") from error
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise TextureError("is no file")
        head = os.read(descriptor, _HEAD_BYTES)
    finally:
        os.close(descriptor)
    for start, kind, suffixes in _HEADS:
        if head.startswith(start):
            return status.st_size, kind, suffixes
    if (
        Path(file).suffix.lower() in _TARGA_SUFFIXES
        and len(head) == _HEAD_BYTES
        and head[1] < 2
        and head[2] in _TARGA_KINDS
    ):
        return status.st_size, "targa", _TARGA_SUFFIXES
    raise TextureError("cannot be read: unknown format")


@contextlib.contextmanager
def _file_with_suffix(file: str, suffixes: tuple[str, ...]) -> Iterator[str]:
    """A name by which OpenImageIO takes the right reader: it goes by the suffix, and takes what follows a ``?`` for options.

    The sandbox of a worker of the service allows no links: there, the file is copied.
    """
    if Path(file).suffix.lower() in suffixes and "?" not in file:
        yield file
        return
    with contextlib.ExitStack() as kept:
        try:
            folder = kept.enter_context(tempfile.TemporaryDirectory(prefix="pullfocus-"))
            named = Path(folder) / f"image{suffixes[0]}"
            try:
                named.symlink_to(file)
            except PermissionError:
                shutil.copyfile(file, named)
        except OSError as error:
            reason = error.strerror or "it cannot be copied"
            raise TextureError(f"cannot be read under a name with another suffix: {reason}") from error
        yield str(named)


def _check_header(spec: oiio.ImageSpec, file_bytes: int) -> None:
    """Raise `TextureError` for an image that is no picture, or larger than it can be or may be."""
    width, height, channels = spec.width, spec.height, spec.nchannels
    if spec.deep:
        raise TextureError("holds deep pixels, expected flat ones")
    if width < 1 or height < 1 or channels < 1:
        raise TextureError(f"is {width} x {height} pixels of {channels} channels, expected at least one")
    if width * height > MAX_PIXELS or spec.depth > 1 or max(width, height) > MAX_SIDE:
        raise TextureError(f"is {width} x {height} x {spec.depth} pixels, more than 16384 x 16384")
    if channels > MAX_CHANNELS:
        raise TextureError(f"has {channels} channels, more than {MAX_CHANNELS}")
    count = width * height * spec.format.size()
    if count * min(channels, 4) > MAX_BYTES:
        size_mib = count * min(channels, 4) // 2**20
        raise TextureError(f"is {width} x {height} pixels of {size_mib:,} MiB, more than {MAX_BYTES // 2**20:,} MiB")
    if count * channels > max(PACKING_FLOOR_BYTES, MAX_PACKING * file_bytes):
        raise TextureError(f"is damaged: {file_bytes:,} bytes cannot hold its {width} x {height} pixels")
    if spec.tile_width:
        tiles = -(-width // spec.tile_width) * -(-height // max(1, spec.tile_height))
        tile_bytes = spec.tile_width * spec.tile_height * max(1, spec.tile_depth) * channels * spec.format.size()
        if tiles > MAX_TILES or tile_bytes > MAX_BYTES:
            raise TextureError(
                f"has tiles of {spec.tile_width} x {spec.tile_height} pixels, of which there are {tiles:,}"
            )


def _without_name(message: str, file: str) -> str:
    """First line of a reader's message without the file's path, which may be a copy's."""
    lines = message.replace(f'"{file}"', "the file").replace(file or "\0", "the file").strip().splitlines()
    return lines[0] if lines else ""
