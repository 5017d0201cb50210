"""Lenses over HTTP: the library, mounting on a shot's camera, lens files, and taking it all back."""

from __future__ import annotations

from xml.etree import ElementTree

import httpx
import pytest
from pxr import Sdf

PLANAR = "Planar 50 mm f/1.4"
ACHROMAT = """RDM;LEN
TITLE 'An achromat'
EPD 25.0
DIM M
SO 0.0 0.1e14
S 61.47 6.0 NBK7_SCHOTT
  STO
  CIR 12.5
S -44.64 2.5 NSF5_SCHOTT
S -129.94 95.952
SI 0.0 0.0
GO
"""


@pytest.fixture
def shot(room: str) -> str:
    return f"/v1/shots/{room}"


def mount(client: httpx.Client, shot: str, **edit: object) -> dict:
    answer = client.patch(f"{shot}/camera", json=edit)
    assert answer.status_code == 200, answer.text
    return answer.json()


def send_lens(client: httpx.Client, shot: str, name: str, content: str) -> httpx.Response:
    return client.put(f"{shot}/camera/lens", files={"file": (name, content.encode())})


def test_the_library_lists_what_a_chooser_shows(client):
    lenses = client.get("/v1/lenses").json()["lenses"]
    by_name = {lens["name"]: lens for lens in lenses}
    assert (by_name["planar_50"]["title"], by_name["planar_50"]["model"]) == (PLANAR, "prescription")
    assert (by_name["planar_50"]["focalLengthMm"], by_name["planar_50"]["fStop"]) == (50, 1.4)
    assert len({lens["title"] for lens in lenses}) == len(lenses)  # a camera's lensName tells which one it is
    assert all(lens["description"] for lens in lenses)


def test_the_library_is_searched(client):
    asked = {"focalLengthMax": 60, "fasterThan": 1.4, "family": "double gauss", "yearMin": 1970, "yearMax": 1979}
    [planar] = client.get("/v1/lenses", params=asked | {"search": "3,874,771 Zeiss"}).json()["lenses"]
    assert (planar["name"], planar["year"], planar["families"][-1]) == ("planar_50", 1975, "double gauss")
    assert client.get("/v1/lenses/planar_50").json()["stated"] == {"focalLengthMm": 50, "fStop": 1.4, "fieldDeg": None}
    assert client.get("/v1/lenses", params={"search": "no such words"}).json()["lenses"] == []
    assert client.get("/v1/lenses", params={"yearMin": 1980, "yearMax": 1970}).json()["lenses"] == []
    for wrong in ({"family": "petzvall"}, {"fasterThan": "inf"}):
        assert client.get("/v1/lenses", params=wrong).status_code == 422


def test_a_lens_is_described_down_to_its_surfaces(client):
    lens = client.get("/v1/lenses/distagon_35").json()
    assert len(lens["surfaces"]) == 18
    assert [surface["isStop"] for surface in lens["surfaces"]].index(True) == 10
    asphere = lens["surfaces"][11]
    assert (asphere["conic"], asphere["aspheric"]) == (-1, [-1.8505e-5])
    assert asphere["glass"]["abbe"] == 45.8
    assert lens["surfaces"][-1]["glass"] is None
    soft = client.get("/v1/lenses/soft_focus_85").json()
    assert (soft["surfaces"], soft["errors"]["w040"], soft["iris"]["blades"]) == ([], 28, 9)


@pytest.mark.parametrize("name", ["planar_50", "singlet_50", "soft_focus_85", "pinhole_35"])
def test_a_lens_has_a_picture_of_its_section(client, name):
    answer = client.get(f"/v1/lenses/{name}/section.svg")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "image/svg+xml"
    assert "max-age" in answer.headers["cache-control"]
    assert ElementTree.fromstring(answer.content).tag.endswith("svg")


def test_an_unknown_lens_has_neighbours(client):
    assert client.get("/v1/lenses/planr_50/section.svg").json()["code"] == "no_such_lens"
    answer = client.get("/v1/lenses/planr_50")
    assert answer.status_code == 404
    assert (answer.json()["code"], answer.json()["path"]) == ("no_such_lens", "planr_50")
    assert "did you mean planar_50" in answer.json()["detail"]


def test_a_mounted_lens_brings_its_numbers_and_is_reported(client, shot):
    camera = mount(client, shot, lens="telephoto_250")
    assert (camera["lensName"], camera["lensModel"]) == ("Telephoto 250 mm f/5.6", "prescription")
    assert (camera["focalLengthMm"], camera["fStop"]) == pytest.approx((249.57, 5.6))
    readout = client.get(f"{shot}/readout", params={"time": 1}).json()
    assert (readout["lensName"], readout["lensModel"]) == (camera["lensName"], camera["lensModel"])
    [listed] = client.get(f"{shot}/cameras", params={"time": 1}).json()["cameras"]
    assert listed["lensName"] == camera["lensName"]
    layer = Sdf.Layer.CreateAnonymous()
    layer.ImportFromString(client.get(f"{shot}/edits").text)
    assert layer.GetAttributeAtPath("/World/cam.lens:model").default == "prescription"


def test_numbers_beside_a_lens_are_set_on_it(client, shot):
    camera = mount(client, shot, lens="planar_50", fStop=4, focalLengthMm=75)
    assert (camera["lensName"], camera["fStop"], camera["focalLengthMm"]) == (PLANAR, 4, 75)


def test_null_is_the_thin_lens_and_an_edit_without_a_lens_leaves_it(client, shot):
    mount(client, shot, lens="planar_50")
    assert mount(client, shot, fStop=2.8)["lensName"] == PLANAR
    camera = mount(client, shot, lens=None)
    assert (camera["lensName"], camera["lensModel"]) == ("", "thin")
    assert (camera["focalLengthMm"], camera["fStop"]) == pytest.approx((50, 2.8))


def test_what_cannot_be_mounted_is_refused_and_changes_nothing(client, shot):
    before = client.get(f"{shot}/edits").text
    answer = client.patch(f"{shot}/camera", json={"lens": "planr_50", "fStop": 8})
    assert (answer.status_code, answer.json()["path"]) == (422, "lens")
    assert "did you mean planar_50" in answer.json()["detail"]
    assert client.patch(f"{shot}/camera", json={"lens": "planar_50"}, params={"camera": "/no"}).status_code == 422
    assert client.get(f"{shot}/edits").text == before


def test_a_lens_by_data_sheet_is_described_and_mounted(client, shot):
    planar = client.get("/v1/lenses/zeiss_planar_50").json()
    assert (planar["model"], planar["surfaces"], planar["errors"]) == ("dataSheet", [], None)
    assert planar["tables"]["fStop"] == 1.4
    assert len(planar["tables"]["tangentialBlur"]) == len(planar["tables"]["height"])
    assert client.get("/v1/lenses/planar_50").json()["tables"] is None
    sheet = "name = Some 40\nfocal length = 40\nf-stops = 2 16\n\nheight_mm light_%\n0 100\n20 50\n"
    answer = send_lens(client, shot, "some.lens", sheet)
    assert answer.status_code == 200
    camera = answer.json()
    assert (camera["lensName"], camera["lensModel"], camera["focalLengthMm"]) == (
        "Some 40",
        "dataSheet",
        pytest.approx(40),
    )
    assert camera["fStop"] >= 2
    refused = send_lens(client, shot, "some.lens", sheet.replace("20 50", "20 dim"))
    assert (refused.status_code, refused.json()["code"]) == (422, "bad_lens_file")


def test_a_lens_file_is_mounted(client, shot):
    answer = send_lens(client, shot, "achromat.seq", ACHROMAT)
    assert answer.status_code == 200, answer.text
    camera = answer.json()
    assert (camera["lensName"], camera["lensModel"]) == ("An achromat", "prescription")
    assert (camera["focalLengthMm"], camera["fStop"]) == pytest.approx((100.03, 4.0), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "content", "status", "code", "words"),
    [
        ("lens.pdf", ACHROMAT, 415, "unsupported_type", "lens.pdf was sent; expected a lens file"),
        ("../../etc/lens.seq", ACHROMAT[:-15], 422, "bad_lens_file", "lens.seq: it ends before the image surface"),
        ("lens.seq", ACHROMAT.replace("NBK7", "XYZ"), 422, "unknown_glass", "lens.seq, line 6, surface 1: glass XYZ"),
        ("lens.zmx", "\0\1\2", 422, "bad_lens_file", "lens.zmx is no lens file: expected text"),
        ("lens.dat", "50 5 1.5 20\n-50 0 1 20\n" * 2000, 422, "bad_lens_file", "at most 200 surfaces"),
        ("lens.dat", "-50 5 1.5 20\n50 0 1 20\n", 422, "bad_lens", "surface 1 of lens: its power of -10 dioptres"),
        ("lens.dat", "#" * 2_000_000, 413, "too_large", "larger than"),
    ],
)
def test_a_bad_lens_file_is_refused(client, shot, name, content, status, code, words):
    answer = send_lens(client, shot, name, content)
    assert (answer.status_code, answer.json()["code"]) == (status, code)
    assert words in answer.json()["detail"]
    assert client.get(f"{shot}/readout", params={"time": 1}).json()["lensName"] == ""


def test_edits_go_back_to_a_revision_with_all_that_a_lens_changed(client, shot):
    for time, f_stop in ((1, 1.4), (24, 2.8)):  # keys, which mounting raises
        mount(client, shot, fStop=f_stop, time=time)
    before, revision = client.get(f"{shot}/edits").text, client.get(shot).json()["revision"]
    mount(client, shot, lens="mirror_500")
    assert client.get(f"{shot}/edits").text != before
    restored = client.put(f"{shot}/edits", json={"revision": revision})
    assert restored.status_code == 200, restored.text
    assert (restored.json()["revision"], client.get(f"{shot}/edits").text) == (revision, before)
    readout = client.get(f"{shot}/readout", params={"time": 1}).json()
    assert (readout["lensName"], readout["focalLengthMm"], readout["fStop"]) == pytest.approx(("", 50, 1.4))


def test_edits_go_back_to_none(client, shot):
    revision = client.get(shot).json()["revision"]
    mount(client, shot, lens="planar_50")
    assert client.put(f"{shot}/edits", json={"revision": revision}).status_code == 200
    assert client.get(f"{shot}/readout", params={"time": 1}).json()["lensModel"] == "thin"


def test_a_revision_that_is_not_kept_is_reported(client, shot):
    mount(client, shot, lens="planar_50")
    answer = client.put(f"{shot}/edits", json={"revision": "0123456789abcdef"})
    assert (answer.status_code, answer.json()["code"]) == (404, "revision_not_found")
    assert client.get(f"{shot}/readout", params={"time": 1}).json()["lensName"] == PLANAR


def test_a_lens_goes_on_the_camera_that_was_seen(client, shot):
    seen = client.get(f"{shot}/camera", params={"time": 1})
    mount(client, shot, fStop=4)
    file = {"file": ("lens.seq", ACHROMAT.encode())}
    refused = client.put(f"{shot}/camera/lens", files=file, headers={"If-Match": seen.headers["etag"]})
    assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")
    assert client.get(f"{shot}/camera", params={"time": 1}).json()["lensName"] == seen.json()["lensName"]
