"""Texture files to images in the working space, through OpenImageIO and Ar (so also from inside a .usdz)."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray
from pxr import Ar

from render import colour
from render.model.arrays import FloatArray, HalfArray
from render.model.scene import Image, Wrap
from render.stage.color_spaces import SpaceName, from_chromaticities, linearise
from render.stage.confinement import is_inside
from render.stage.findings import FindingLog
from render.stage.materials.image_files import TextureError, open_image, read_error

Purpose = str  # "color": converted to the working space; "data": only its transfer function is undone
_MAX_FLOAT16 = 65504.0
_BAND_ROWS = 256
_WRAPS: dict[str, Wrap] = {name: name for name in get_args(Wrap)} | {"periodic": "repeat"}
_ASSUMED_SPACE = "srgb_rec709_scene"
MAX_SET_PIXELS = 2**27
"""Pixels that the tiles of one set have together: 32 of 2048 x 2048."""


class TextureCache:
    """Texture cache: each texture is read once for each use.

    Args:
        max_size: width and height that no image exceeds; larger ones are averaged down by a whole factor.
        confined_to: the folder that every file must lie in, or None.
        log: receives what is averaged down; None for nobody.
        most: number of images that are kept, the newest; None for all.
    """

    def __init__(
        self,
        max_size: int,
        confined_to: Path | None = None,
        log: FindingLog | None = None,
        *,
        most: int | None = None,
    ) -> None:
        self._max_size, self._confined_to, self._log, self._most = max_size, confined_to, log, most
        self._images: dict[tuple[object, ...], Image] = {}
        self._sets: dict[tuple[object, ...], tuple[Image, dict[int, str]]] = {}
        self._wraps: dict[str, tuple[Wrap, Wrap]] = {}

    @property
    def confined_to(self) -> Path | None:
        """The folder that every file must lie in, or None."""
        return self._confined_to

    def image(
        self,
        resolved_path: str,
        source: SpaceName,
        purpose: Purpose = "color",
        scale: tuple[float, ...] = (1, 1, 1, 1),
        bias: tuple[float, ...] = (0, 0, 0, 0),
        power: tuple[float, ...] = (1, 1, 1, 1),
    ) -> Image:
        """Read the image of a resolved asset path.

        Args:
            resolved_path: as Ar resolves it; may be inside a package.
            source: its colour space: a token of :func:`render.colour.to_working`, one by its numbers, or ``auto``.
            purpose: ``color`` or ``data``.
            scale: applied to linear values, before the change of primaries.
            bias: addend after the scale.
            power: exponent after the bias; where it is not 1, less than 0 counts as 0.

        Raises:
            TextureError: the file is missing, damaged, too large or in an unknown colour space.
        """
        key = (resolved_path, source, purpose, scale, bias, power)
        if key not in self._images:
            require_inside(resolved_path, self._confined_to)
            grade = _Grade.of(scale, bias, power)
            with as_file(resolved_path) as file:
                pixels, channels = self._read(file, resolved_path, source, purpose, grade)
            self._images[key] = Image(pixels, resolved_path, channels)
            if self._most is not None and len(self._images) > self._most:
                self._images.pop(next(iter(self._images)))
        return self._images[key]

    def header(self, resolved_path: str, names: Sequence[str]) -> object:
        """Value of the first of some attributes that an image file's header has, or None.

        Args:
            resolved_path: as Ar resolves it; may be inside a package.
            names: names of the attributes.

        Raises:
            TextureError: the file is missing or damaged.
        """
        require_inside(resolved_path, self._confined_to)
        with as_file(resolved_path) as file, open_image(file, oiio.ImageSpec()) as handle:
            values = (handle.spec().getattribute(name) for name in names)
            return next((value for value in values if value is not None), None)

    def wraps(self, resolved_path: str) -> tuple[Wrap, Wrap]:
        """Wrapping that a file asks for, across and up; black where it says nothing.

        Raises:
            TextureError: it cannot be read.
        """
        if resolved_path not in self._wraps:
            require_inside(resolved_path, self._confined_to)
            with as_file(resolved_path) as file:
                self._wraps[resolved_path] = read_wraps(file)
        return self._wraps[resolved_path]

    def tiled(
        self,
        name: str,
        files: Mapping[int, str],
        source: SpaceName,
        purpose: Purpose = "color",
        scale: tuple[float, ...] = (1, 1, 1, 1),
        bias: tuple[float, ...] = (0, 0, 0, 0),
    ) -> tuple[Image, dict[int, str]]:
        """Read a set of UDIM tiles, all enlarged to the width and the height of the largest.

        Args:
            name: of the set, for messages.
            files: resolved path of each tile by its number.
            source: as for `image`, and so are the others.
            purpose: what it is for.
            scale: applied to linear values.
            bias: addend after the scale.

        Returns:
            The set, and for each tile that cannot be read the reason, by its number.

        Raises:
            TextureError: no tile can be read.
        """
        key = (tuple(sorted(files.items())), source, purpose, scale, bias)
        if key not in self._sets:
            self._sets[key] = self._read_tiles(name, files, source, purpose, _Grade.of(scale, bias, (1, 1, 1, 1)))
        return self._sets[key]

    def _read_tiles(
        self, name: str, files: Mapping[int, str], source: SpaceName, purpose: Purpose, grade: _Grade
    ) -> tuple[Image, dict[int, str]]:
        sizes: dict[int, tuple[int, int]] = {}
        problems: dict[int, str] = {}
        for number, path in sorted(files.items()):
            try:
                require_inside(path, self._confined_to)
                with as_file(path) as file:
                    sizes[number] = read_size(file)
            except TextureError as problem:
                problems[number] = str(problem)
        if not sizes:
            raise TextureError(f"has no tile that can be read: its tile {min(problems)} {problems[min(problems)]}")
        size = _tile_size(list(sizes.values()), self._max_size)
        tiles, pixels, channels = [], [], 1
        for number, own in sizes.items():
            factor = max(-(-side // most) for side, most in zip(own, size, strict=True))
            try:
                with as_file(files[number]) as file:
                    read, count = self._read(file, files[number], source, purpose, grade, factor)
            except TextureError as problem:
                problems[number] = str(problem)
                continue
            tiles.append(number)
            pixels.append(_enlarge(read, size))
            channels = max(channels, count)
        if not tiles:
            raise TextureError(f"has no tile that can be read: its tile {min(problems)} {problems[min(problems)]}")
        return Image(np.stack(pixels), name, channels, tuple(tiles)), problems

    def _read(
        self, file: str, name: str, source: SpaceName, purpose: Purpose, grade: _Grade, factor: int = 0
    ) -> tuple[HalfArray, int]:
        """Pixels, averaged down by a factor or, for 0, by what the largest size asks for; and the file's channels."""
        raw, source = read_pixels(file, source, keeps_primaries=purpose != "color")
        height, width = raw.shape[:2]
        factor = factor or -(-max(height, width) // self._max_size)
        out = np.empty((-(-height // factor), -(-width // factor), 4), np.float16)
        self._note_size(name, (height, width), out.shape[:2])
        linear = _Linear(raw.dtype, raw.shape[2], source, grade)
        if purpose != "color" and factor == 1 and linear.is_table:
            linear.fill(out, raw)
            return out, raw.shape[2]
        rows = _BAND_ROWS * factor
        for first in range(0, height, rows):
            band = downsample(linear(raw[first : first + rows]), factor)
            if purpose == "color":
                band = colour.to_working(band)
            top = first // factor
            out[top : top + len(band)] = band
        return out, raw.shape[2]

    def _note_size(self, name: str, size: tuple[int, ...], drawn: tuple[int, ...]) -> None:
        """Note that an image is averaged down."""
        if self._log is None or size == drawn:
            return
        if Ar.IsPackageRelativePath(name):
            name = Ar.SplitPackageRelativePathInner(name)[1]
        elif self._confined_to is not None:
            name = os.path.relpath(os.path.realpath(name), os.path.realpath(self._confined_to))
        message = (
            f"texture {Path(name).name} is {size[1]:,} x {size[0]:,} pixels and is drawn at {drawn[1]:,} x {drawn[0]:,}"
        )
        self._log.add("texture_scaled", name, message)


def require_inside(resolved_path: str, confined_to: Path | None) -> None:
    """Raise `TextureError` for an image that lies outside the folder that it is confined to, if any."""
    if confined_to is not None and not is_inside(resolved_path, confined_to):
        raise TextureError("lies outside what was given")


@dataclass(frozen=True, eq=False)
class _Grade:
    """Change of linear values: ``(value * scale + bias) ** power``, each ``(4,)`` float32."""

    scale: FloatArray
    bias: FloatArray
    power: FloatArray

    @classmethod
    def of(cls, scale: Sequence[float], bias: Sequence[float], power: Sequence[float]) -> _Grade:
        """Make one of numbers for each channel."""
        return cls(*(np.array(values, np.float32) for values in (scale, bias, power)))

    def apply(self, linear: FloatArray) -> FloatArray:
        """Grade values of any shape with four channels; what is too large for float32 is infinite, or not a number."""
        with np.errstate(over="ignore", invalid="ignore"):
            graded: FloatArray = linear * self.scale + self.bias
            bent = self.power != 1
            if bent.any():
                graded[..., bent] = np.maximum(graded[..., bent], 0) ** self.power[bent]
        return graded


class _Linear:
    """Converter of a file's rows to linear ``(h, w, 4)`` float32, graded; 8-bit files use a table."""

    def __init__(self, dtype: np.dtype[np.generic], channels: int, source: SpaceName, grade: _Grade) -> None:
        self._source, self._grade = source, grade
        self._table: FloatArray | None = None
        if dtype == np.uint8:
            ramp = np.repeat(np.arange(256, dtype=np.uint8)[:, None, None], channels, axis=2)
            self._table = self._convert(ramp)[:, 0]

    @property
    def is_table(self) -> bool:
        """Whether pixels are converted by a table."""
        return self._table is not None

    def __call__(self, rows: NDArray[np.generic]) -> FloatArray:
        if self._table is None:
            return self._convert(rows)
        out = np.empty((*rows.shape[:2], 4), np.float32)
        self.fill(out, rows)
        return out

    def fill(self, out: FloatArray | HalfArray, rows: NDArray[np.generic]) -> None:
        """Write rows of an 8-bit file to ``out``, through the table."""
        assert self._table is not None
        table = self._table.astype(out.dtype)
        channels = rows.shape[2]
        colors = rows[..., :3] if channels >= 3 else rows[..., :1]
        if (table[:, :3] == table[:, :1]).all():
            out[..., :3] = table[:, 0][colors]
        else:
            for channel in range(3):
                out[..., channel] = table[:, channel][colors[..., min(channel, colors.shape[2] - 1)]]
        out[..., 3] = table[:, 3][rows[..., -1]] if channels in (2, 4) else table[0, 3]

    def _convert(self, rows: NDArray[np.generic]) -> FloatArray:
        linear = self._grade.apply(linearise(_rgba(rows), self._source))
        finite: FloatArray = np.clip(np.nan_to_num(linear), -_MAX_FLOAT16, _MAX_FLOAT16).astype(np.float32)
        return finite


def read_size(file: str) -> tuple[int, int]:
    """Height and width of an image file, by its header."""
    with open_image(file, oiio.ImageSpec()) as handle:
        spec = handle.spec()
        return int(spec.height), int(spec.width)


def read_wraps(file: str) -> tuple[Wrap, Wrap]:
    """Wrapping of an image file, across and up, by its header: its ``wrapS`` and ``wrapT``, or OpenImageIO's ``wrapmodes``."""
    with open_image(file, oiio.ImageSpec()) as handle:
        spec = handle.spec()
        both = str(spec.get_string_attribute("wrapmodes")).split(",")
        named = [
            str(spec.get_string_attribute(name)) or both[i % len(both)] for i, name in enumerate(("wrapS", "wrapT"))
        ]
    across, up = (_WRAPS.get(name.strip(), "black") for name in named)
    return across, up


def _tile_size(sizes: Sequence[tuple[int, int]], max_size: int) -> tuple[int, int]:
    """Height and width of all tiles of a set: those of the highest and the widest over a whole factor that holds the limits."""
    height, width = (max(sides) for sides in zip(*sizes, strict=True))
    factor = -(-max(height, width) // max_size)
    while len(sizes) * -(-height // factor) * -(-width // factor) > MAX_SET_PIXELS:
        factor += 1
    return -(-height // factor), -(-width // factor)


def _enlarge(pixels: HalfArray, size: tuple[int, int]) -> HalfArray:
    """Pixels at a height and a width, bilinear between the middles of those that are there, and flat beyond the outer ones."""
    for axis, (own, new) in enumerate(zip(pixels.shape, size, strict=False)):
        if own != new:
            place = np.clip((np.arange(new) + 0.5) * own / new - 0.5, 0, own - 1)
            low = np.floor(place).astype(np.int64)
            share = (place - low).astype(np.float32).reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
            first, second = (
                pixels.take(index, axis).astype(np.float32) for index in (low, np.minimum(low + 1, own - 1))
            )
            pixels = (first + share * (second - first)).astype(np.float16)
    return pixels


def read_pixels(
    file: str, source: SpaceName, *, keeps_primaries: bool = False
) -> tuple[NDArray[np.generic], SpaceName]:
    """Read pixels ``(height, width, channels)`` in the file's own type, and the colour space that ``auto`` stands for.

    Args:
        file: path of a plain file.
        source: colour space, or ``auto``.
        keeps_primaries: whether ``auto`` leaves out what the file says of its primaries, as for data.
    """
    request = oiio.ImageSpec()
    request.attribute("oiio:UnassociatedAlpha", 1)
    with open_image(file, request) as handle:
        pixels = handle.read_image(0, 0, 0, min(handle.spec().nchannels, 4), oiio.UNKNOWN)
        if pixels is None:
            raise read_error(handle)
        own = "" if source != "auto" or keeps_primaries else _own_space(handle.spec())
    if source == "auto":
        # UsdPreviewSurface specification: 8-bit images of three or four channels are sRGB, the others linear.
        source = own or ("sRGB" if pixels.dtype == np.uint8 and pixels.shape[2] >= 3 else "raw")
    return pixels, source


def _own_space(spec: oiio.ImageSpec) -> SpaceName:
    """Colour space that a file of colours names; empty where it names none, or the one that OpenImageIO assumes of its kind."""
    if spec.nchannels < 3:
        return ""
    primaries = spec.getattribute("chromaticities")
    if isinstance(primaries, tuple) and len(primaries) == 8:
        return from_chromaticities("chromaticities", primaries) or ""
    named = str(spec.get_string_attribute("colorInteropID") or spec.get_string_attribute("oiio:ColorSpace"))
    is_assumed = named == _ASSUMED_SPACE and not spec.get_string_attribute("colorInteropID")
    return "" if is_assumed or not colour.is_known(named) else named


def _rgba(pixels: NDArray[np.generic]) -> FloatArray:
    """Convert pixels to ``(h, w, 4)`` float32: integers become 0 to 1, grey is copied to the colours, missing alpha is 1."""
    values = pixels.astype(np.float32)
    if pixels.dtype.kind == "u":
        values /= np.float32(2 ** (8 * pixels.dtype.itemsize) - 1)
    channels = values.shape[2]
    out = np.ones((*values.shape[:2], 4), np.float32)
    out[..., :3] = values[..., :3] if channels >= 3 else values[..., :1]
    if channels in (2, 4):
        out[..., 3] = values[..., -1]
    return out


def downsample(pixels: FloatArray, factor: int) -> FloatArray:
    """Means of ``factor`` by ``factor`` blocks; the last row and column are repeated to fill whole blocks."""
    if factor == 1:
        return pixels
    height, width = pixels.shape[:2]
    padded = np.pad(pixels, ((0, -height % factor), (0, -width % factor), (0, 0)), mode="edge")
    blocks = padded.reshape(padded.shape[0] // factor, factor, padded.shape[1] // factor, factor, 4)
    mean: FloatArray = blocks.mean(axis=(1, 3), dtype=np.float32)
    return mean


@contextlib.contextmanager
def as_file(resolved_path: str) -> Iterator[str]:
    """Plain file with the asset's bytes: itself, or a temporary copy of a file inside a package."""
    if not Ar.IsPackageRelativePath(resolved_path):
        if not (os.path.isabs(resolved_path) and os.path.isfile(resolved_path)):
            raise TextureError("is missing")
        yield resolved_path
        return
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(resolved_path))
    if not asset:
        raise TextureError("is missing from its package")
    inner = Ar.SplitPackageRelativePathInner(resolved_path)[1]
    with asset, tempfile.TemporaryDirectory(prefix="pullfocus-") as folder:
        copy = Path(folder) / f"texture{Path(inner).suffix}"
        copy.write_bytes(asset.GetBuffer())
        yield str(copy)
