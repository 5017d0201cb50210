"""Renders that are tried: frames, settings, cost, and what stands against them; and renders through another lens."""

from __future__ import annotations

import pytest

from service.http.errors import ServiceError
from tests.service.conftest import send
from tests.service.kits.renders import SMALL, ended, render_of

LENS = "swirly_58"


@pytest.fixture
def plan_of(client, room):
    def plan(**request) -> dict:
        before = client.get("/v1/renders").json()
        answer = client.post("/v1/render-plans", json=SMALL | {"shot": room} | request)
        assert answer.status_code == 200, answer.text
        assert client.get("/v1/renders").json() == before
        return answer.json()

    return plan


def found(plan, severity) -> list[tuple[str, str]]:
    """Code and path of the findings of a severity."""
    return [(one["code"], one["path"]) for one in plan["findings"] if one["severity"] == severity]


def test_the_whole_shot_is_the_default(plan_of):
    plan = plan_of()
    assert (plan["frames"], plan["count"]) == ("1-24", 24)
    assert plan["secondsOfProcessor"] > 0
    assert found(plan, "error") == []


def test_settings_are_those_of_the_first_picture(client, room, plan_of):
    client.patch(f"/v1/shots/{room}/camera", json={"fStop": 4, "focalLengthMm": 35})
    shot = client.get(f"/v1/shots/{room}").json()
    settings = plan_of(frames="3-5", width=64, formats=["png", "exr"], aovs=["depth"], film="velvia_50")["settings"]
    gate = client.get(f"/v1/shots/{room}/cameras", params={"time": 3}).json()["cameras"][0]
    assert (settings["camera"], settings["revision"]) == ("/World/cam", shot["revision"])
    assert (settings["fStop"], settings["film"]) == (4, "velvia_50")
    assert settings["focalLengthMm"] == pytest.approx(35, rel=1e-6)
    assert (settings["formats"], settings["aovs"], settings["rays"]) == (["png", "exr"], ["depth"], 4)
    shape = gate["horizontalApertureMm"] / gate["verticalApertureMm"]
    assert settings["width"] / settings["height"] == pytest.approx(shape, rel=1 / settings["height"])
    frame = ended(client, render_of(client, room, frames="3", width=64, formats=["png"]))
    assert frame["state"] == "done"


@pytest.mark.parametrize(
    ("request_", "code", "path"),
    [
        ({"frames": "1-"}, "bad_setting", "frames"),
        ({"frames": "1-99999"}, "bad_setting", "frames"),
        ({"camera": "/World/nobody"}, "no_such_camera", "/World/nobody"),
        ({"film": "no_such_film"}, "unknown_stock", ""),
        ({"lens": "no_such_lens"}, "no_such_lens", "lens"),
        ({"after": ["r-000000000000"]}, "render_not_found", "after"),
        ({"width": 8192, "height": 8192, "rays": 100_000, "engine": "lens"}, "too_many_pixels", ""),
    ],
)
def test_what_would_be_refused_is_an_error(plan_of, request_, code, path):
    plan = plan_of(**request_)
    assert found(plan, "error") == [(code, path)]
    assert plan["settings"] is None or "after" in request_


def test_frames_outside_the_shot_are_a_warning(plan_of):
    plan = plan_of(frames="20-30:5,99")
    assert found(plan, "warning") == [("frames_outside_shot", "frames")]
    assert "Frames 25,30,99 are outside the shot, which is 1 to 24" in plan["findings"][0]["message"]
    assert "Frame 99 is outside" in plan_of(frames="1,99")["findings"][0]["message"]


def test_what_of_the_shot_is_not_honoured_is_a_warning(client, plan_of):
    torn = b"""#usda 1.0
(defaultPrim = "World")
def Xform "World" (references = @./gone.usda@)
{
    def Cube "box" {}
}
"""
    plan = plan_of(shot=send(client, "torn.usda", torn).json()["id"], frames="1")
    (message,) = [one["message"] for one in plan["findings"] if "gone.usda" in one["message"]]
    assert "/shots/" not in message
    assert plan["settings"]["camera"] is None


def test_a_quota_that_is_used_up_is_told(service, plan_of, monkeypatch):
    def refuse(*_):
        raise ServiceError(403, "quota_stored", "It is used up.")

    monkeypatch.setattr(service.internal.quotas, "check_room", refuse)
    assert found(plan_of(), "error") == [("quota_stored", "")]


def test_a_body_that_is_no_request_is_refused_as_when_it_is_sent(client, room):
    for wrong in ({"width": 0}, {"formats": []}, {"shot": 7}, {"nonsense": 1}):
        for path in ("/v1/render-plans", "/v1/renders"):
            assert client.post(path, json={"shot": room} | wrong).status_code == 422
    for path in ("/v1/render-plans", "/v1/renders"):
        assert client.post(path, json={"shot": "none"}).status_code == 404


def test_a_render_through_another_lens_leaves_the_shot_alone(client, room, plan_of):
    before = client.get(f"/v1/shots/{room}").json()["revision"]
    assert plan_of(lens=LENS)["settings"]["lensName"] == "Swirly 58 mm f/2"
    render = ended(client, render_of(client, room, frames="3", lens=LENS, engine="lens", formats=["png"]))
    assert (render["state"], render["lens"]) == ("done", LENS)
    own = ended(client, render_of(client, room, frames="3", engine="lens", formats=["png"]))
    assert own["lens"] is None
    assert client.get(f"/v1/shots/{room}").json()["revision"] == before == own["revision"] != render["revision"]
    pictures = [client.get(f"/v1/renders/{one['id']}/frames/3").content for one in (render, own)]
    client.patch(f"/v1/shots/{room}/camera", json={"lens": LENS})
    mounted = ended(client, render_of(client, room, frames="3", engine="lens", formats=["png"]))
    assert mounted["revision"] == render["revision"]
    assert client.get(f"/v1/renders/{mounted['id']}/frames/3").content == pictures[0] != pictures[1]


def test_a_lens_that_there_is_not_is_refused(client, room):
    answer = client.post("/v1/renders", json=SMALL | {"shot": room, "lens": "swirly_85"})
    assert answer.status_code in (404, 422)
    assert LENS in answer.json()["detail"]
