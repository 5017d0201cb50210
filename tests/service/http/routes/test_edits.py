"""The edit language over HTTP: a list of changes is one edit, all of it or nothing, and its answer says what there is then."""

from __future__ import annotations

import base64
from typing import Any, get_args

import pytest

from service.models.changes import Change
from service.models.edits import EditRequest, EditResult
from service.stage.changes import apply_change
from tests.service.conftest import send
from tests.service.kits.edits import NEAR, TWO_POINTS, edit, edited, layer

CHANGES = get_args(get_args(Change)[0])
RACK = {"type": "rack", "rack": {"from": "near", "to": "far", "start": 5, "end": 17}}


@pytest.fixture
def shot(room) -> str:
    return f"/v1/shots/{room}"


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change.__name__)
def test_every_change_has_an_example_and_an_apply_function(change):
    example = change.model_config["json_schema_extra"]["example"]
    (parsed,) = EditRequest.model_validate({"changes": [example]}).changes
    assert type(parsed) is change
    assert apply_change.dispatch(change) is not apply_change.dispatch(object)


def test_the_example_of_an_answer_is_one():
    EditResult.model_validate(EditResult.model_config["json_schema_extra"]["example"])


def test_a_list_of_changes_is_one_edit_of_the_history(client, shot):
    empty = layer(client, shot)
    answer = edited(client, shot, *TWO_POINTS, {"type": "setCamera", "values": {"fStop": 4}}, label="Two points")
    history = answer["history"]
    assert (history["undo"], history["redo"], history["after"]) == ("Two points", None, None)
    assert history["revision"] == client.get(shot).json()["revision"]
    assert answer["added"] == ["near", "far"]
    undone = client.post(f"{shot}/edits/undo").json()
    assert undone["revision"] == history["before"]
    assert undone["redo"] == "Two points"
    assert layer(client, shot) == empty


def test_without_a_label_an_edit_goes_by_its_changes(client, shot):
    answer = edited(client, shot, {"type": "setCamera", "values": {"fStop": 4}}, *TWO_POINTS)
    assert answer["history"]["undo"] == "set f-number of cam, add focus point near, add focus point far"
    mounted = edited(client, shot, {"type": "setCamera", "values": {"lens": "planar_50"}})
    assert mounted["history"]["undo"] == "mount a lens on cam"


def test_edits_of_one_gesture_are_one_entry(client, shot):
    for f_stop in (2, 4, 8):
        change = {"type": "setCamera", "values": {"fStop": f_stop}}
        edited(client, shot, change, label="f-number", gesture="drag-1")
    assert client.get(f"{shot}/edits/history").json()["now"] == 1


def test_a_point_is_renamed_with_its_keys_and_undone(client, shot):
    key = {"type": "keyPoint", "name": "near", "attribute": "weight", "key": {"time": 3, "value": 0.5}}
    edited(client, shot, *TWO_POINTS, key)
    points = {
        point["name"]: point for point in client.get(f"{shot}/focus-points", params={"time": 3}).json()["focusPoints"]
    }
    after = edited(client, shot, {"type": "renamePoint", "name": "near", "newName": "robot"})
    renamed = {
        point["name"]: point for point in client.get(f"{shot}/focus-points", params={"time": 3}).json()["focusPoints"]
    }
    assert renamed.keys() == {"far", "robot"}
    skipped = {"name": "", "etag": ""}
    assert renamed["robot"] | skipped == points["near"] | skipped
    changed = {one["resource"]: one["etag"] for one in after["changed"]}
    assert changed["focus-points/near"] is None
    assert changed["focus-points/robot"] == renamed["robot"]["etag"]
    match = {"If-Match": renamed["robot"]["etag"]}
    again = [
        {"type": "renamePoint", "name": "robot", "newName": "pip"},
        {"type": "alterPoint", "name": "pip", "values": {"weight": 0.5}, "time": 3},
    ]
    assert edit(client, shot, *again, headers=match).status_code == 200
    assert edit(client, shot, {"type": "renamePoint", "name": "far", "newName": "x"}, headers=match).status_code == 412
    client.post(f"{shot}/edits/undo")
    client.post(f"{shot}/edits/undo")
    undone = client.get(f"{shot}/focus-points", params={"time": 3}).json()["focusPoints"]
    assert {point["name"] for point in undone} == {"near", "far"}


def near_point(client, shot: str) -> dict[str, Any]:
    return client.get(f"{shot}/focus-points/near", params={"time": 3}).json()


def test_a_point_follows_a_part_from_where_it_is_and_is_undone(client, shot):
    edited(client, shot, *TWO_POINTS)
    before = near_point(client, shot)
    assert (before["part"], before["boundsPoint"]) == ("", [0.5, 0.5, 0.5])
    follow = {"type": "followPart", "name": "near", "part": "/World", "time": 3}
    changed = {one["resource"]: one["etag"] for one in edited(client, shot, follow)["changed"]}
    subject = near_point(client, shot)
    assert subject["part"] == "/World"
    assert subject["boundsPoint"] == pytest.approx([0.7 / 4, 1.38 / 3, 1], abs=1e-6)
    for name in ("positionM", "screen"):
        assert subject[name] == pytest.approx(before[name], abs=1e-6)
    assert (subject["target"], subject["face"], subject["barycentric"]) == (NEAR["target"], 0, NEAR["barycentric"])
    assert changed == {"focus-points": changed["focus-points"], "focus-points/near": subject["etag"]}
    seen = {"If-Match": before["etag"]}
    assert edit(client, shot, follow | {"part": None}, headers=seen).status_code == 412
    edited(client, shot, follow | {"part": None})
    back = near_point(client, shot)
    kept = {"etag": "", "boundsPoint": [], "share": 0}
    assert back | kept == before | kept
    client.post(f"{shot}/edits/undo")
    assert near_point(client, shot)["part"] == "/World"
    client.post(f"{shot}/edits/undo")
    assert near_point(client, shot) == before


def test_a_point_is_added_with_a_part_and_reads_as_plain_usd(client, shot):
    subject = {"part": "/World/far", "boundsPoint": [0.5, 1.0, 0.5]}
    edited(client, shot, {"type": "addPoint", "point": NEAR | subject | {"name": "near"}})
    point = near_point(client, shot)
    assert point["positionM"] == pytest.approx([1.5, 1.5, -8])
    text = layer(client, shot)
    assert "rel focusPoint:near:part = </World/far>" in text
    assert "double3 focusPoint:near:boundsPoint = (0.5, 1, 0.5)" in text
    gone = {"type": "alterPoint", "name": "near", "values": {"part": "/World/gone"}, "time": 3}
    edited(client, shot, gone)
    point = near_point(client, shot)
    assert point["positionM"] is None
    assert point["problem"] == "focus point near follows the bounds of /World/gone, which is not there"
    edited(client, shot, gone | {"values": {"part": ""}})
    assert near_point(client, shot)["positionM"][2] == pytest.approx(-3)


def test_a_point_has_a_colour_and_a_group_that_change_no_picture(client, shot):
    edited(client, shot, *TWO_POINTS)
    states = client.get(f"{shot}/picture-states", params={"camera": "/World/cam"}).json()["states"]
    labels = {"color": "teal", "group": "cast, main"}
    edited(client, shot, {"type": "alterPoint", "name": "near", "values": labels, "time": 3})
    assert near_point(client, shot).items() >= labels.items()
    text = layer(client, shot)
    assert 'uniform token focusPoint:near:color = "teal"' in text
    assert 'uniform string focusPoint:near:group = "cast, main"' in text
    assert client.get(f"{shot}/picture-states", params={"camera": "/World/cam"}).json()["states"] == states
    client.post(f"{shot}/edits/undo")
    assert near_point(client, shot).items() >= {"color": "none", "group": ""}.items()


@pytest.mark.parametrize(
    ("change", "status", "code"),
    [
        ({"type": "removePoint", "name": "nobody"}, 404, "not_found"),
        ({"type": "alterPoint", "name": "near", "values": {"color": "mauve"}, "time": 3}, 422, "invalid_request"),
        ({"type": "alterPoint", "name": "near", "values": {"group": "g" * 101}, "time": 3}, 422, "invalid_request"),
        ({"type": "followPart", "name": "nobody", "part": "/World", "time": 3}, 404, "not_found"),
        ({"type": "followPart", "name": "near", "part": "/World/gone", "time": 3}, 404, "anchor_not_found"),
        ({"type": "followPart", "name": "near", "part": "/World/cam", "time": 3}, 404, "anchor_not_found"),
        ({"type": "followPart", "name": "near", "part": "/World/far", "time": 3}, 422, "bad_part"),
        ({"type": "followPart", "name": "near", "part": "/World/near.points", "time": 3}, 422, "bad_part"),
        ({"type": "followPart", "name": "near", "part": "near", "time": 3}, 422, "invalid_request"),
        ({"type": "alterPoint", "name": "near", "values": {"part": "near"}, "time": 3}, 422, None),
        ({"type": "alterPoint", "name": "near", "values": {"boundsPoint": [0, 0, 2000]}, "time": 3}, 422, None),
        ({"type": "renamePoint", "name": "nobody", "newName": "somebody"}, 404, "not_found"),
        ({"type": "renamePoint", "name": "near", "newName": "far"}, 422, "name_taken"),
        ({"type": "renamePoint", "name": "near", "newName": "a b"}, 422, "invalid_request"),
        ({"type": "addPoint", "point": NEAR | {"name": "near"}}, 422, "name_taken"),
        ({"type": "setCamera", "values": {"lens": "no_such_lens"}}, 422, "no_such_lens"),
        ({"type": "unkeySetting", "setting": "push", "time": 3}, 404, "not_found"),
        ({"type": "setSettingTangents", "setting": "push", "time": 3, "tangents": {}}, 404, "not_found"),
        ({"type": "movePoint", "name": "near", "place": [0.9, 0.02], "time": 1}, 422, "nothing_there"),
        ({"type": "setFilm", "values": {"display": "no such display"}}, 422, None),
        ({"type": "importCurve", "content": "bm8gY3VydmU="}, 422, "bad_curve"),
        ({"type": "importCurve", "content": "not base64!"}, 422, "invalid_request"),
        ({"type": "paintItRed"}, 422, "invalid_request"),
    ],
)
def test_a_change_that_is_refused_takes_the_whole_edit_with_it(client, shot, change, status, code):
    before, history = layer(client, shot), client.get(f"{shot}/edits/history").json()
    answer = edit(client, shot, *TWO_POINTS, change)
    assert (answer.status_code, answer.json()["code"]) == (status, code or answer.json()["code"]), answer.text
    assert set(answer.json()) == {"code", "detail", "path", "errors"}
    assert layer(client, shot) == before
    assert client.get(f"{shot}/edits/history").json() == history


@pytest.mark.parametrize("changes", [[], [{"type": "removePoint", "name": "a"}] * 1025])
def test_an_edit_has_changes_and_not_without_end(client, shot, changes):
    assert edit(client, shot, *changes).status_code == 422


def test_the_answer_is_what_the_resources_say(client, shot):
    edited(client, shot, *TWO_POINTS)
    answer = edited(client, shot, RACK, answer={"time": 11, "curve": True})
    state, ask = answer["state"], {"time": 11}
    for part, address in {
        "focusPoints": "focus-points",
        "readout": "readout",
        "focus": "camera/focus",
        "exposure": "camera/exposure",
        "exposureReadout": "readout/exposure",
        "film": "camera/film",
    }.items():
        assert state[part] == client.get(f"{shot}/{address}", params=ask).json(), part
    assert state["curve"] == client.get(f"{shot}/focus-curve").json()
    assert (answer["racks"][0]["from"], answer["racks"][0]["end"]) == ("near", 17)


def test_what_changed_is_named_with_its_new_tag(client, shot):
    first = edited(client, shot, *TWO_POINTS)
    # The camera too: its focus is by points from now on.
    assert {one["resource"] for one in first["changed"]} == {
        "camera",
        "focus-points",
        "focus-points/near",
        "focus-points/far",
    }
    tags = {one["resource"]: one["etag"] for one in first["changed"]}
    assert tags["camera"] == client.get(f"{shot}/camera", params={"time": 1}).headers["etag"]
    assert tags["focus-points"] == client.get(f"{shot}/focus-points", params={"time": 1}).headers["etag"]
    far = client.get(f"{shot}/focus-points/far", params={"time": 1})
    assert tags["focus-points/far"] == far.headers["etag"]
    second = edited(client, shot, {"type": "removePoint", "name": "near"})
    assert {one["resource"]: one["etag"] is None for one in second["changed"]} == {
        "focus-points": False,
        "focus-points/near": True,
    }
    again = edited(client, shot, {"type": "setCamera", "values": {"focusMode": "points"}})
    assert again["changed"] == []


def test_an_edit_is_made_upon_what_was_seen(client, shot):
    tags = {one["resource"]: one["etag"] for one in edited(client, shot, *TWO_POINTS)["changed"]}
    alter = {"type": "alterPoint", "name": "near", "values": {"weight": 0.5}, "time": 1}
    stop = {"type": "setCamera", "values": {"fStop": 4}}
    seen = f"{tags['focus-points/near']}, {tags['camera']}"
    edited(client, shot, {"type": "alterPoint", "name": "far", "values": {"weight": 2}, "time": 1})
    assert edit(client, shot, alter, stop, headers={"If-Match": seen}).status_code == 200  # another point: no matter
    for changes in ((alter,), (stop,), (alter, stop), (TWO_POINTS[0],)):
        refused = edit(client, shot, *changes, headers={"If-Match": seen})
        assert (refused.status_code, refused.json()["code"]) == (412, "changed_meanwhile")
    new = {"type": "addPoint", "point": NEAR | {"name": "third"}}
    key = {"type": "keyPoint", "name": "third", "attribute": "weight", "key": {"time": 1, "value": 1}}
    points = client.get(f"{shot}/focus-points", params={"time": 1}).headers["etag"]
    answer = edit(client, shot, new, key, headers={"If-Match": points})
    assert answer.status_code == 200, answer.text


def test_the_tag_of_all_edits_does_for_each_of_them(client, shot):
    stop = {"type": "setCamera", "values": {"fStop": 4}}
    first = edit(client, shot, *TWO_POINTS, stop)
    other = {"type": "setCamera", "values": {"fStop": 8}}
    second = edit(client, shot, other, headers={"If-Match": first.headers["etag"]})
    assert second.status_code == 200, second.text
    third = edit(client, shot, stop, headers={"If-Match": first.headers["etag"]})
    assert third.status_code == 412


def test_a_point_moves_to_what_is_seen_at_a_place(client, shot):
    edited(client, shot, *TWO_POINTS)
    move = {"type": "movePoint", "name": "near", "place": [0.9, 0.5], "time": 1}
    state = edited(client, shot, move, answer={"time": 1})["state"]
    near = next(point for point in state["focusPoints"]["focusPoints"] if point["name"] == "near")
    assert near["target"] == ["/World/far"]
    assert near["screen"] == pytest.approx([0.9, 0.5], abs=1e-3)


def test_tangents_bend_a_key_and_leave_its_value(client, shot):
    tangents = {"inSlope": 0.0, "inWidth": 2.0, "outSlope": 0.25, "outWidth": 3.0}
    keys = [
        {"type": "keySetting", "setting": "focusDistanceM", "key": {"time": time, "value": value}}
        for time, value in ((1, 3), (12, 8))
    ]
    bend = {"type": "setSettingTangents", "setting": "focusDistanceM", "time": 12, "tangents": tangents}
    state = edited(client, shot, *keys, bend, answer={"time": 12})["state"]
    key = state["focus"]["keys"]["focusDistanceM"][1]
    assert (key["value"], key["interpolation"], key["tangents"]) == (8, "bezier", tangents)

    key_point = {"type": "keyPoint", "name": "near", "attribute": "weight", "key": {"time": 5, "value": 0.5}}
    bend_point = {"type": "setPointTangents", "name": "near", "attribute": "weight", "time": 5, "tangents": tangents}
    state = edited(client, shot, TWO_POINTS[0], key_point, bend_point, answer={"time": 5})["state"]
    (key,) = state["focusPoints"]["focusPoints"][0]["keys"]["weight"]
    assert (key["value"], key["interpolation"], key["tangents"]) == (0.5, "bezier", tangents)


def test_an_imported_curve_is_simplified_within_a_tolerance(client, shot):
    rows = "".join(f"{n},{2 + 0.01 * n * n}\n" for n in range(1, 25))
    curve = base64.b64encode(f"frame,focus_distance_m\n{rows}".encode()).decode()
    simplify = {"type": "simplifySetting", "setting": "focusDistanceM", "tolerance": 0.01}
    answer = edited(
        client, shot, {"type": "importCurve", "content": curve, "baked": True}, simplify, answer={"time": 12}
    )
    [found] = answer["simplified"]
    keys = answer["state"]["focus"]["keys"]["focusDistanceM"]
    assert (found["setting"], found["before"], found["after"]) == ("focusDistanceM", 24, len(keys))
    assert len(keys) < 8
    assert found["off"] <= 0.01
    assert answer["state"]["readout"]["focusDistanceM"] == pytest.approx(2 + 1.44, rel=0.01)
    refused = edit(client, shot, simplify | {"setting": "fStop"})
    assert (refused.status_code, refused.json()["code"]) == (422, "no_curve")
    assert "once at most" in edit(client, shot, simplify, simplify).json()["detail"]


def test_a_metered_exposure_is_keyed_and_black_frames_bridged(client, shot):
    readings = [{"time": 1, "compensationStops": -1}, {"time": 12, "compensationStops": None}]
    readings.append({"time": 23, "compensationStops": 1})
    metered = {"type": "setExposure", "values": {"meteringMode": "average"}}
    state = edited(client, shot, metered, {"type": "keyExposure", "readings": readings}, answer={"time": 12})["state"]
    assert state["exposure"]["compensationStops"] == pytest.approx(0, abs=0.01)
    assert state["exposure"]["meteringMode"] == "manual"
    held = {"type": "keyExposure", "readings": readings[:1], "held": True}
    state = edited(client, shot, held, answer={"time": 12})["state"]
    assert (state["exposure"]["compensationStops"], state["exposure"]["keys"]) == (-1, {})


def test_files_ride_in_a_change(client, shot):
    lens = base64.b64encode(b"30 4 1.5168 20\n0 0 1 20\n").decode()
    mount = {"type": "mountLensFile", "fileName": "plano-convex.dat", "content": lens}
    assert edited(client, shot, mount, answer={"time": 1})["state"]["readout"]["lensName"] == "plano-convex"
    curve = base64.b64encode(b"frame,focus_distance_m\n1,2\n2,2.5\n4,3\n").decode()
    imported = edited(client, shot, {"type": "importCurve", "content": curve, "gaps": "interpolate"})["imported"]
    assert (imported["frames"], imported["findings"][0]["code"]) == (4, "gap")


def test_an_edit_may_bring_a_large_file_and_not_one_without_end(client, shot):
    rows = "".join(f"{n},2.{'0' * 60}\n" for n in range(1, 20_001))
    content = base64.b64encode(f"frame,focus_distance_m\n{rows}".encode()).decode()
    assert len(content) > 1 << 20
    assert edited(client, shot, {"type": "importCurve", "content": content})["imported"]["frames"] == 20_000
    assert edit(client, shot, {"type": "importCurve", "content": "x" * (33 << 20)}).status_code == 413


def test_an_unreadable_part_of_the_state_is_null_in_the_answer(client, room_file):
    # More frames than a focus curve may have at once.
    long = room_file.read_text().replace("endTimeCode = 24", "endTimeCode = 30000")
    shot = f"/v1/shots/{send(client, 'long.usda', long.encode()).json()['id']}"
    assert client.get(f"{shot}/focus-curve").status_code == 422
    stop = {"type": "setCamera", "values": {"fStop": 4}}
    answer = edited(client, shot, stop, answer={"time": 1, "curve": True})
    assert answer["state"]["curve"] is None
    assert answer["state"]["readout"]["fStop"] == 4
    client.delete(shot)


def test_a_refusal_names_the_change_among_several(client, shot):
    stop = {"type": "setCamera", "values": {"fStop": 4}}
    wrong = {"type": "removePoint", "name": "nobody"}
    before = layer(client, shot)
    refused = edit(client, shot, *TWO_POINTS, *[stop] * 17, wrong)
    assert refused.json()["detail"].startswith("change 20 of 20, removePoint: camera /World/cam has no focus point")
    assert edit(client, shot, wrong).json()["detail"].startswith("camera /World/cam has no")
    assert layer(client, shot) == before


@pytest.mark.parametrize("junk", [None, {"type": "no such"}, {"type": "removePoint", "x": 1}, [[]]])
def test_an_answer_to_junk_names_the_first_and_is_short(client, shot, junk):
    refused = edit(client, shot, *[junk] * 20_000)
    assert refused.status_code == 422
    assert refused.json()["path"].startswith("body.changes.0")
    assert len(refused.content) < 4000
    assert "at least 1 item" not in refused.text


def test_an_answer_to_many_unknown_fields_is_short(client, shot):
    fields = {f"field{number}": 1 for number in range(9_999)}
    refused = edit(client, shot, {"type": "removePoint", "name": "a"} | fields | {"f" * 100_000: 1})
    assert (refused.status_code, len(refused.json()["errors"])) == (422, 20)
    assert "; and 9,98" in refused.json()["detail"]
    assert len(refused.content) < 10_000


@pytest.mark.parametrize("setting", ["focalLengthMm", "focusDistanceM", "fStop"])
def test_a_lens_setting_too_small_for_usd_is_refused(client, shot, setting):
    refused = edit(client, shot, {"type": "setCamera", "values": {setting: 1e-300}})
    assert (refused.status_code, refused.json()["code"]) == (422, "bad_lens_setting"), refused.text
    assert client.get(f"{shot}/frame", params={"time": 1, "width": 8}).status_code == 200


@pytest.mark.parametrize(
    ("kind", "setting", "value"),
    [("setFocus", "nearPriority", 17), ("setFocus", "riseMm", -1001), ("setExposure", "compensationStops", 101)],
)
def test_a_key_has_the_limits_of_its_setting(client, shot, kind, setting, value):
    assert edit(client, shot, {"type": kind, "values": {setting: value}}).status_code == 422
    refused = edit(client, shot, {"type": "keySetting", "setting": setting, "key": {"time": 1, "value": value}})
    assert (refused.status_code, refused.json()["code"]) == (422, "bad_key"), refused.text
    assert setting in refused.json()["detail"]


def test_the_label_of_many_changes_is_short(client, shot):
    points = [{"type": "addPoint", "point": NEAR | {"name": f"point{number}"}} for number in range(9)]
    undo = edited(client, shot, *points)["history"]["undo"]
    assert undo.startswith("add focus point point0, add focus point point1, ")
    assert undo.endswith(" and 5 more")


@pytest.mark.parametrize("name", ["/", "...", "a/"])
def test_a_lens_file_has_a_name(client, shot, name):
    change = {"type": "mountLensFile", "fileName": name, "content": base64.b64encode(b"30 4 1.5 20").decode()}
    refused = edit(client, shot, change)
    assert (refused.status_code, refused.json()["code"]) == (422, "invalid_request")
    assert refused.json()["path"].endswith("fileName")
