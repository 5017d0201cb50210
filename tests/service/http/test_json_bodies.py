"""Bodies are JSON as RFC 8259 has it, and its types are taken for what they are."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from fastapi.routing import iter_route_contexts

from service.http.app import create_app
from service.http.bodies import BodyRoute
from service.http.json_bodies import MAX_KEYS, read_json
from service.http.settings import Settings
from service.models.curve import MAX_CURVE_FRAMES

CAMERA = "/v1/shots/{}/camera"


def sent(client, room: str, body: str | bytes, kind: str = "application/json"):
    return client.patch(CAMERA.format(room), content=body, headers={"content-type": kind})


@pytest.mark.parametrize("body", ['{"fStop": 4}', '{"fStop": 4.0}', '{"fStop": 40e-1}'])
def test_every_spelling_of_a_number_is_that_number(client, room, body):
    assert sent(client, room, body).json()["fStop"] == 4


@pytest.mark.parametrize("value", ["true", '"4"', "NaN", "Infinity", "1e400", "1" * 400, "1" * 5000, "[4]"])
def test_nothing_else_is_a_number(client, room, value):
    answer = sent(client, room, f'{{"fStop": {value}}}')
    assert answer.status_code == 422, answer.text
    assert answer.json()["code"] == "invalid_request"
    assert len(answer.content) < 1000


@pytest.mark.parametrize("value", ["0", "1", '"true"', '"yes"'])
def test_only_true_and_false_are_truth_values(client, room, value):
    body = f'{{"changes": [{{"type": "setCamera", "values": {{}}}}], "answer": {{"time": 1, "curve": {value}}}}}'
    answer = client.post(f"/v1/shots/{room}/edits", content=body, headers={"content-type": "application/json"})
    assert answer.status_code == 422, answer.text


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('{"fStop": 4, "fStop": 5}', "the key 'fStop' stands there twice"),
        ('{"fStop": NaN}', "NaN is no number of JSON"),
        ("[" * 100_000, "nested too deeply"),
        ('{"fStop": 4', "no JSON"),
        ('{"fStop": ' + "1" * 5000 + "}", "digits"),
        (b'{"fStop": 4, "lens": "\xff"}', "no text in UTF-8"),
        ('{"fStop": 4}'.encode("utf-16"), "no text in UTF-8"),
    ],
)
def test_what_is_no_json_is_refused_with_the_reason(client, room, body, reason):
    answer = sent(client, room, body)
    assert answer.status_code == 422
    assert reason in answer.json()["detail"]


def test_a_lone_surrogate_is_refused(client, room):
    for body in ('{"\\ud800": 1}', '{"lens": "\\ud800"}'):
        assert sent(client, room, body).status_code == 422


@pytest.mark.parametrize("kind", ["text/plain", "application/xml", "multipart/form-data"])
def test_a_body_of_another_type_is_refused(client, room, kind):
    assert sent(client, room, '{"fStop": 4}', kind).status_code in (415, 422)


def test_a_query_is_text_and_takes_numbers_as_text(client, room):
    assert client.get(f"/v1/shots/{room}/camera?time=1").status_code == 200
    assert client.get(f"/v1/shots/{room}/frame?time=1&width=16&height=9&rays=1&adaptive=false").status_code == 200
    assert client.get(f"/v1/shots/{room}/frame?time=abc").status_code == 422


def test_a_path_that_is_no_utf8_is_not_found(client):
    assert client.get("/v1/shots/%ff%fe").status_code == 404


def test_a_key_that_ends_a_long_object_is_found_twice():
    names = ",".join(f'"{number}": 0' for number in range(MAX_KEYS - 1))
    with pytest.raises(json.JSONDecodeError, match="'98' stands there twice"):
        read_json(f'{{{names}, "98": 1}}'.encode())


def test_very_many_keys_are_refused_at_once():
    """A model would make an error of each; and a search of all keys for each takes a quarter of an hour."""
    names = ",".join(f'"{number}": 0' for number in range(200_000))
    with pytest.raises(json.JSONDecodeError, match="more than 20,000 keys"):
        read_json(f"{{{names}}}".encode())


@pytest.mark.parametrize("value", ["0", "[]", "{}", '""'])
def test_very_many_values_are_refused_before_they_are_read(value):
    with pytest.raises(json.JSONDecodeError, match="more than 200,000 values"):
        read_json(f"[{','.join([value] * 200_001)}]".encode())


def test_as_many_readings_as_a_curve_may_have_are_read():
    readings = [{"time": time, "compensationStops": -1.0} for time in range(MAX_CURVE_FRAMES)]
    assert read_json(json.dumps({"changes": [{"type": "keyExposure", "readings": readings}]}).encode())


def test_every_route_with_a_body_is_a_body_route():
    app = create_app(Settings(data=Path("unused")))
    with_body = {
        operation["operationId"]
        for methods in app.openapi()["paths"].values()
        for operation in methods.values()
        if "requestBody" in operation
    }
    routes = (context.original_route for context in iter_route_contexts(app.routes))
    made = {route.operation_id for route in routes if isinstance(route, BodyRoute)}
    assert len(with_body) > 12
    assert with_body <= made
