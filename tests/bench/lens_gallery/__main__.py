"""Makes the gallery: a folder with a page and its pictures, which needs nothing else.

    scripts/gallery OUT_DIR                              the whole gallery
    scripts/gallery OUT_DIR --camera                     stocks, stops, lenses, motion and long exposures, small
    scripts/gallery OUT_DIR --camera --width 960         larger
    scripts/gallery OUT_DIR --size 320x180 --rays 36     quickly
    scripts/gallery OUT_DIR --only iris-5,coma-strong    some of it

Not collected by pytest: what it shows has to be looked at.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from render.demo.shot import write_demo
from render.errors import OutputError, PullfocusError, SettingsError
from render.files import write_atomic
from render.frame import FrameRenderer
from render.shot import Shot
from tests.bench.lens_gallery.aberrations import aberration_sections
from tests.bench.lens_gallery.camera import camera_sections
from tests.bench.lens_gallery.entries import Section
from tests.bench.lens_gallery.glass import glass_sections
from tests.bench.lens_gallery.library import library_sections
from tests.bench.lens_gallery.models import model_sections
from tests.bench.lens_gallery.page import page
from tests.bench.lens_gallery.photographs import Photograph, Photographer, Size
from tests.bench.lens_gallery.pupils import pupil_sections
from tests.bench.lens_gallery.settings import setting_sections

SMALL = Size(320, 180, 25)
"""Size of the camera section's pictures, small because a long exposure is many frames."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the gallery that the command line asks for; ``arguments`` are the process's own by default."""
    asked = _parser().parse_args(arguments)
    try:
        sections = chosen_sections(None if asked.only is None else asked.only.split(","), camera_alone=asked.camera)
        usual = SMALL if asked.camera else Size()
        width, height = asked.size or (usual.width, usual.height)
        make_gallery(asked.out, sections, Size(width, height, asked.rays or usual.rays))
    except (PullfocusError, OSError) as error:
        sys.exit(f"scripts/gallery: {error}")


def _parser() -> argparse.ArgumentParser:
    usual = Size()
    parser = argparse.ArgumentParser(
        prog="scripts/gallery", description="Make a page of every lens, aberration, stock and shutter on the demo shot."
    )
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="folder for the page and its pictures; is made")
    parser.add_argument(
        "--camera",
        action="store_true",
        help=f"stocks, stops, lenses, motion and long exposures alone, {SMALL.width}x{SMALL.height} and {SMALL.rays} rays "
        "unless other sizes are asked for",
    )
    size = parser.add_mutually_exclusive_group()
    size.add_argument(
        "--size",
        type=_size,
        metavar="WxH",
        help=f"of the pictures in pixels (default: {usual.width}x{usual.height})",
    )
    size.add_argument("--width", dest="size", type=_wide, metavar="PX", help="of the pictures, 16:9")
    parser.add_argument(
        "--rays",
        type=int,
        help=f"for each pixel (default: {usual.rays}); twice as many where small lights are much blurred, half for each "
        "interval of a long exposure",
    )
    parser.add_argument("--only", metavar="LIST", help="these entries alone, by their files' names, commas between")
    return parser


def _size(text: str) -> tuple[int, int]:
    """``640x360`` as numbers."""
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    if found is None or min(int(found[1]), int(found[2])) < 16:
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT of 16 pixels or more, such as 640x360, got {text!r}")
    return int(found[1]), int(found[2])


def _wide(text: str) -> tuple[int, int]:
    """A width, and the height of the demo shot's gate."""
    if not text.isdigit() or int(text) < 32:
        raise argparse.ArgumentTypeError(f"expected 32 pixels or more, got {text!r}")
    return int(text), round(int(text) * 9 / 16)


def chosen_sections(slugs: Sequence[str] | None, *, camera_alone: bool = False) -> list[Section]:
    """All sections, or what of them has these names.

    Args:
        slugs: of entries; None for all.
        camera_alone: whether the sections of lenses are left out.

    Raises:
        SettingsError: the gallery has no entry of such a name.
    """
    of_lenses = [
        *library_sections(),
        *model_sections(),
        *aberration_sections(),
        *glass_sections(),
        *pupil_sections(),
        *setting_sections(),
    ]
    sections = [*camera_sections(), *([] if camera_alone else of_lenses)]
    if slugs is None:
        return sections
    known = {entry.slug for section in sections for entry in section.entries}
    if unknown := [slug for slug in slugs if slug not in known]:
        raise SettingsError(f"the gallery has no {', '.join(unknown)}; it has {', '.join(sorted(known))}")
    picked = [replace(s, entries=tuple(entry for entry in s.entries if entry.slug in slugs)) for s in sections]
    return [section for section in picked if section.entries]


def make_gallery(folder: Path, sections: Sequence[Section], size: Size) -> None:
    """Take every picture, then write the page.

    Args:
        folder: is made where it is not.
        sections: of the page.
        size: of the pictures.

    Raises:
        OutputError: nothing can be written there.
    """
    _check_writable(folder)
    count = sum(len(section.entries) for section in sections)
    made: list[tuple[Section, list[Photograph]]] = []
    with tempfile.TemporaryDirectory() as demo, FrameRenderer() as renderer:
        photographer = Photographer(Shot.open(write_demo(Path(demo))), renderer, size, folder)
        for section in sections:
            made.append((section, []))
            for entry in section.entries:
                photograph = photographer.take(entry)
                made[-1][1].append(photograph)
                done = sum(len(photographs) for _, photographs in made)
                print(f"{done:3}/{count}  {photograph.seconds:6.1f} s  {entry.slug}", flush=True)
        device = renderer.graphics.renderer
    write_atomic(folder / "index.html", page(made, device).encode())
    print(f"{folder / 'index.html'}")


def _check_writable(folder: Path) -> None:
    """Make the folder, and find out now and not after the first picture that it takes no files."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise OutputError(f"cannot write the gallery to {folder}: {error.strerror}") from error


if __name__ == "__main__":
    main()
