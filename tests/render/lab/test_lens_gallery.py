"""The lens gallery: that its page shows what was asked for. Whether the pictures are right has to be looked at."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import OpenImageIO
import pytest

from tests.bench.lens_gallery.__main__ import chosen_sections, main
from usd_schemas import lens_names

FEW = ("stock-tri_x_400", "long-no-filter", "shot-planar_50", "model-pinhole", "coma-strong", "iris-mask")


def test_every_lens_of_the_library_has_its_pictures() -> None:
    slugs = [entry.slug for section in chosen_sections(None) for entry in section.entries]
    assert [name for name, count in Counter(slugs).items() if count > 1] == []
    for lens in lens_names():
        assert f"shot-{lens}" in slugs
        assert f"lights-{lens}" in slugs


@pytest.mark.gl
def test_the_page_shows_the_pictures_and_they_are_there(tmp_path: Path) -> None:
    main([str(tmp_path / "new" / "gallery"), "--size", "64x36", "--rays", "4", "--only", ",".join(FEW)])
    folder = tmp_path / "new" / "gallery"
    page = (folder / "index.html").read_text()
    shown = set(re.findall(r'<img[^>]* src="([^"]*)"', page))
    assert shown == {f"{slug}{part}.png" for slug in FEW for part in ("", "-detail")}
    assert {path.name for path in folder.iterdir()} == shown | {"index.html"}
    assert "http" not in page  # it needs nothing from elsewhere
    for name in shown:
        picture = OpenImageIO.ImageBuf(str(folder / name))
        assert (picture.spec().width, picture.spec().height) == ((32, 18) if "detail" in name else (64, 36))
        lightest = max(OpenImageIO.ImageBufAlgo.computePixelStats(picture).max)
        assert lightest > 0.2, f"{name} is black"
    for words in ("Kodak Tri-X 400", "0.083 s, ND 0.0 stops", "EV 0.0"):
        assert words in page
    grey, bright, plain = (
        OpenImageIO.ImageBuf(str(folder / f"{slug}.png")).get_pixels(OpenImageIO.FLOAT) for slug in FEW[:3]
    )
    assert (grey.max(axis=-1) - grey.min(axis=-1)).max() < 0.02 < (plain.max(axis=-1) - plain.min(axis=-1)).max()
    assert bright.mean() > 1.3 * plain.mean()


def test_the_camera_section_shows_stocks_stops_lenses_and_motion() -> None:
    sections = chosen_sections(None, camera_alone=True)
    assert [section.title for section in sections] == [
        "Three stocks",
        "Three stops",
        "Three lenses",
        "Motion",
        "Long exposures",
    ]
    assert all(len(section.entries) >= 3 for section in sections)


def test_a_read_only_folder_is_refused_before_drawing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(SystemExit, match=r"^scripts/gallery: cannot write the gallery to .*file/sub: "):
        main([str(tmp_path / "file" / "sub")])


def test_an_entry_that_is_not_there_is_named() -> None:
    with pytest.raises(SystemExit, match=r"^scripts/gallery: the gallery has no coma-huge; it has .*coma-strong"):
        main(["unused", "--only", "iris-mask,coma-huge"])
