"""Contact sheets hold the very pictures that `record` would make, with what each was taken with; no light is rendered twice."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from render.drawing.contact_sheet import _data, _layout, _shorten_title, draw_contact_sheet
from render.frame import FrameRenderer, FrameSettings
from render.pictures import contact_sheet
from render.pictures.contact_axes import parse_axes
from render.shot import Shot
from tests.render.kits.cli_shots import CAMERA, SQUARE, Command, small, write_shot

WIDTH, HEIGHT = 48, 32
SETTINGS = FrameSettings(WIDTH, HEIGHT, rays=4, supersample=1)


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    """The command."""
    return Command(capsys)


@pytest.fixture
def shot(tmp_path: Path) -> Path:
    """A red square before the camera, out of focus at its sides."""
    return write_shot(tmp_path / "shot.usda", SQUARE.replace("(1, 1, 0)", "(1, 1, -3)"), CAMERA)


def pixels(path: Path) -> np.ndarray:
    return np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8))[..., :3]


def test_a_sheet_holds_the_pictures_that_record_makes(pullfocus: Command, shot: Path, renderer: FrameRenderer) -> None:
    out = shot.parent / "sheet.png"
    compared = ("--contact-sheet", "stock=velvia_50,5219", "--contact-sheet", "exposure=0,1")
    ended = pullfocus("record", shot, out, *compared, "--json", *small())
    assert ended.status == 0
    (frame,) = json.loads(ended.out)["frames"]
    assert frame["contactSheet"] == {
        "stock": ["Fuji Velvia 50", "Kodak Vision3 500T 5219"],
        "exposure": ["as it is exposed", "1 stop over"],
    }
    axes = parse_axes(["stock=velvia_50,5219", "exposure=0,1"])
    sheet = contact_sheet.make_contact_sheet(renderer, Shot.open(shot), None, 1.0, SETTINGS, axes)
    table, layout = pixels(out), _layout(sheet)
    for index, name in enumerate(("velvia_50", "5219")):
        one = shot.parent / f"{name}.png"
        assert pullfocus("record", shot, one, "--film", name, *small()).status == 0
        x, y = layout.corner(index)
        np.testing.assert_array_equal(table[y : y + HEIGHT, x : x + WIDTH], pixels(one))
    brighter = np.array([picture.graded.mean() for picture in sheet.pictures])
    assert (brighter[2:] > brighter[:2]).all()
    for index in range(4):  # letters below each
        x, y = layout.corner(index)
        assert table[y + HEIGHT + 2 : y + HEIGHT + layout.label, x : x + WIDTH].max() > table[0, 0].max() + 60


def test_stops_blur_as_they_say_and_lenses_bring_their_own(shot: Path, renderer: FrameRenderer) -> None:
    opened = Shot.open(shot)
    before = opened.edits.export()
    axes = parse_axes(["stop=1.4,8", "lens=thin_50,double_gauss_50"])
    sheet = contact_sheet.make_contact_sheet(renderer, opened, None, 1.0, SETTINGS, axes)
    assert opened.edits.export() == before
    assert [picture.readout.f_stop for picture in sheet.pictures] == pytest.approx([1.4, 8, 2, 8], abs=0.01)
    depths = [picture.readout.far_m - picture.readout.near_m for picture in sheet.pictures]
    assert depths[1] > depths[0]
    assert _data(sheet.pictures[2])[0] == "50.4 mm   f/2   EV 0.0"
    opened.exposure.set(None, transmittance=0.5, neutral_density=0.6)
    darker = contact_sheet.make_contact_sheet(renderer, opened, None, 1.0, SETTINGS, parse_axes(["stop=2,4"]))
    assert _data(darker.pictures[0])[0] == "50 mm   f/2   T2.83   EV 0.0   ND 2.0 stops"
    assert draw_contact_sheet(sheet, "svg").lstrip().startswith(b"<?xml")


def test_light_is_rendered_once_for_all_that_is_done_to_it(
    shot: Path, renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    rendered: list[float] = []
    real = contact_sheet.expose_frame

    def counted(*arguments: object) -> object:
        rendered.append(1)
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(contact_sheet, "expose_frame", counted)
    axes = parse_axes(["stock=velvia_50,5219,tri_x", "stop=2,4"])
    progress: list[tuple[str, float]] = []
    contact_sheet.make_contact_sheet(
        renderer, Shot.open(shot), None, 1.0, SETTINGS, axes, on_picture=lambda *step: progress.append(step)
    )
    assert len(rendered) == 2
    assert progress[0][0] == "Fuji Velvia 50, f/2"
    shares = [share for _, share in progress]
    assert shares == sorted(shares)
    assert 3 / 6 < shares[-1] <= 4 / 6  # the first of the second row is the last that is rendered


def test_a_push_shows(shot: Path, renderer: FrameRenderer) -> None:
    axes = parse_axes(["push=-1,0,2"])
    sheet = contact_sheet.make_contact_sheet(renderer, Shot.open(shot), None, 1.0, SETTINGS, axes, stock="velvia_50")
    means = [picture.graded.mean() for picture in sheet.pictures]
    assert means == sorted(means)
    assert means[2] > 1.2 * means[1]


@pytest.mark.parametrize("metering", ["manual", "average"])
def test_a_stop_over_is_twice_the_light_in_every_exposure_mode(
    shot: Path, renderer: FrameRenderer, metering: str
) -> None:
    opened = Shot.open(shot)
    opened.exposure.set(None, metering_mode=metering)
    sheet = contact_sheet.make_contact_sheet(renderer, opened, None, 1.0, SETTINGS, parse_axes(["exposure=-1,0,2"]))
    scales = [picture.metadata.camera.exposure_scale for picture in sheet.pictures]
    assert scales[0] == pytest.approx(scales[1] / 2)
    assert scales[2] == pytest.approx(scales[1] * 4)


def test_guides_are_drawn_over_every_picture(pullfocus: Command, shot: Path) -> None:
    plain, guided, long = (shot.parent / f"{name}.png" for name in ("plain", "guided", "long"))
    compared = ("--contact-sheet", "stop=2,4", "--imageWidth", 160, "--rays", 4, "--supersample", 1)
    assert pullfocus("record", shot, plain, *compared).status == 0
    assert pullfocus("record", shot, guided, *compared, "--guides", "2.39:1").status == 0
    differs = (pixels(plain) != pixels(guided)).any(axis=(0, 2)).nonzero()[0]
    assert (differs < 180).any()
    assert (differs > 196).any()
    exposed = ("--long-exposure", "1:2", "--imageWidth", 160, "--rays", 4, "--supersample", 1)
    assert pullfocus("record", shot, plain, *exposed).status == 0
    assert pullfocus("record", shot, long, *exposed, "--guides", "2.39:1").status == 0
    assert (pixels(plain) != pixels(long)).any()


def test_frames_are_compared_too(shot: Path, renderer: FrameRenderer) -> None:
    axes = parse_axes(["frame=1,4,7,9,12"])
    layout = _layout(contact_sheet.make_contact_sheet(renderer, Shot.open(shot), None, 1.0, SETTINGS, axes))
    assert (layout.columns, layout.rows) == (3, 2)


def test_small_pictures_have_room_for_all_their_words(shot: Path, renderer: FrameRenderer) -> None:
    axes = parse_axes(["stop=2,4", "stock=velvia_50,5219"])
    sheet = contact_sheet.make_contact_sheet(renderer, Shot.open(shot), None, 1.0, SETTINGS, axes)
    drawn = draw_contact_sheet(sheet, "svg").decode()
    assert "Kodak Vision3 500T 5219" in drawn
    assert "…" not in drawn.split("frame 1")[-1]
    assert _shorten_title(["a" * 80, "pushed 2 stops"], 300, 11).endswith("pushed 2 stops")


def test_a_metered_picture_says_what_the_meter_made_of_it(shot: Path, renderer: FrameRenderer) -> None:
    opened = Shot.open(shot)
    opened.exposure.set(None, metering_mode="average")
    sheet = contact_sheet.make_contact_sheet(renderer, opened, None, 1.0, SETTINGS, parse_axes(["exposure=0,2"]))
    (plain, over) = sheet.pictures
    assert plain.metered_ev100 is not None
    assert over.metered_ev100 is not None
    assert plain.metadata.camera.exposure_scale == pytest.approx(
        2.0**-plain.metered_ev100 * plain.exposure.exposure_scale
    )
    assert over.metered_ev100 == pytest.approx(plain.metered_ev100 - 2)
    assert f"EV {plain.metered_ev100:.1f} metered".replace("-", "−") in _data(plain)[0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("stock=velvia_5O",), "did you mean"),
        (("stock=vision_2383",), "is a print stock, expected one for the camera"),
        (("lens=planar",), "planar"),
        (("lens=nothing_like_it",), "no lens"),
        (("stop=2,wide",), "a contact sheet's stop is a number from 0.1 to 1000, got 'wide'"),
        (("push=9",), "push is a number from -5 to 5"),
        (("push=1",), "only film can be pushed"),
        (("iso=100",), "takes stock, stop, lens, push, exposure, frame"),
        (("stop",), "such as stop=2,4,8; got 'stop'"),
        (("stop=",), "needs what to compare, such as stop=1.4,2.8,5.6"),
        (("stop=2,2",), "shows each stop once"),
        (("stop=2,2.0",), "shows each stop once"),
        (("stock=5219,vision3_500t_5219",), "shows each stock once"),
        (("stop=2", "stop=4"), "with another thing than itself"),
        (("stop=2", "push=1", "frame=3"), "compares one or two things, got 3"),
        ((f"frame={','.join(str(i) for i in range(65))}",), "64 pictures at most, 65 are asked for"),
    ],
)
def test_senseless_arguments_are_reported_in_one_line(
    pullfocus: Command, shot: Path, arguments: tuple[str, ...], message: str
) -> None:
    out = shot.parent / "sheet.png"
    typed = [word for argument in arguments for word in ("--contact-sheet", argument)]
    ended = pullfocus("record", shot, out, *typed, *small())
    assert ended.status == 2
    assert message in ended.err
    assert len([line for line in ended.err.strip().splitlines() if not line.startswith("camera:")]) == 1
    assert not out.exists()


@pytest.mark.parametrize(
    ("out", "arguments", "message"),
    [
        ("a.exr", ("stop=2,4",), "a contact sheet is a .png or .svg file"),
        ("a.png", ("frame=1,2", "--frames", "1"), "leave out --frames"),
        ("a.png", ("stock=velvia_50", "--film", "5219"), "leave out --film"),
        ("a.png", ("stop=2,4", "--long-exposure", "1:3"), "leave out --long-exposure"),
        ("a.png", ("stop=2,4", "--stop", "8"), "leave out --stop"),
        ("a.png", ("stop=2,4", "--aov", "color,depth"), "leave out --aov"),
        ("a.png", ("stop=2,4", "--frames", "1:3"), "a contact sheet is of one frame, got --frames 1:3"),
    ],
)
def test_conflicting_options_are_reported(
    pullfocus: Command, shot: Path, out: str, arguments: tuple[str, ...], message: str
) -> None:
    ended = pullfocus("record", shot, shot.parent / out, "--contact-sheet", *arguments, *small())
    assert (ended.status, message in ended.err) == (2, True)
