"""Exposure readouts and the light meter over HTTP."""

from __future__ import annotations

import math

import pytest

from service.models.metering import METER_EXAMPLE, READOUT_EXAMPLE, ExposureReadout, MeterReading


@pytest.fixture
def shot(client, room) -> str:
    return f"/v1/shots/{room}"


def expose(client, shot, **change):
    answer = client.patch(f"{shot}/camera/exposure", json=change)
    assert answer.status_code == 200, answer.text


def readout(client, shot):
    answer = client.get(f"{shot}/readout/exposure", params={"time": 1})
    assert answer.status_code == 200, answer.text
    return answer.json()


def meter(client, shot, **parameters):
    answer = client.get(f"{shot}/meter", params={"time": 1} | parameters)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_examples_are_true_to_their_models():
    for model, example in ((ExposureReadout, READOUT_EXAMPLE), (MeterReading, METER_EXAMPLE)):
        assert model.model_validate(example).model_dump(by_alias=True, mode="json") == example


def test_an_exposure_is_read_off_in_ev_stops_and_equivalents(client, shot):
    expose(client, shot, exposureTimeS=1 / 50, iso=400, exposureFStop=4, neutralDensity=0.6, transmittance=0.81)
    reading = readout(client, shot)
    assert reading["ev100"] == pytest.approx(math.log2(100 * 16 * 50 / 400), abs=1e-5)
    assert reading["tStop"] == pytest.approx(4 / 0.9, rel=1e-6)
    assert reading["ndStops"] == pytest.approx(0.6 * math.log2(10))
    worth = {same["exposureTimeS"] / same["fStop"] ** 2 for same in reading["equivalents"]}
    assert max(worth) == pytest.approx(min(worth))
    assert [same["fStop"] for same in reading["equivalents"]] == sorted(
        same["fStop"] for same in reading["equivalents"]
    )


def test_the_iris_exposes_when_set_to(client, shot):
    expose(client, shot, exposureStop="iris")
    client.patch(f"{shot}/camera", json={"fStop": 2})
    wide = readout(client, shot)
    client.patch(f"{shot}/camera", json={"fStop": 4})
    reading = readout(client, shot)
    assert (reading["stop"], reading["fStop"]) == ("iris", 4)
    assert wide["exposureScale"] / reading["exposureScale"] == pytest.approx(4)


def test_a_meter_says_how_far_off_the_exposure_is(client, shot):
    before = meter(client, shot, mode="average")
    expose(client, shot, compensationStops=2)
    after = meter(client, shot, mode="average")
    assert after["luminanceNits"] == pytest.approx(before["luminanceNits"])
    assert after["stops"] - before["stops"] == pytest.approx(2)
    assert not after["decides"]
    expose(client, shot, compensationStops=after["compensationStops"])
    assert meter(client, shot, mode="average")["stops"] == pytest.approx(0, abs=1e-6)


def test_a_spot_is_on_a_place_or_a_focus_point(client, shot):
    card, dark = meter(client, shot, x=0.25, y=0.5), meter(client, shot, x=0.99, y=0.01)
    assert card["place"] == pytest.approx([0.25, 0.5])
    assert card["luminanceNits"] > 0
    assert (dark["luminanceNits"], dark["stops"], dark["ev100"], dark["compensationStops"]) == (0, None, None, None)
    point = {"target": ["/World/near"], "face": 0, "barycentric": [0.5, 0, 0.5], "name": "near"}
    client.post(f"{shot}/focus-points", params={"time": 1}, json=point)
    reading = meter(client, shot, point="near")
    assert (reading["mode"], reading["luminanceNits"]) == ("spot", pytest.approx(card["luminanceNits"], rel=0.02))


def test_a_deciding_meter_is_reported(client, shot):
    expose(client, shot, meteringMode="average", meteringCompensationStops=1)
    reading = meter(client, shot)
    assert (reading["decides"], reading["mode"]) == (True, "average")
    assert reading["compensationStops"] == pytest.approx(1 - reading["stops"], abs=1e-3)


@pytest.mark.parametrize("mode", ["manual", "average"])
def test_a_lens_that_lets_no_light_through_meters_black(client, shot, mode):
    lit = meter(client, shot, mode="average")
    expose(client, shot, transmittance=0, meteringMode=mode)
    reading = meter(client, shot, mode="average")
    assert (reading["stops"], reading["compensationStops"], reading["filmLux"]) == (None, None, 0)
    assert (reading["luminanceNits"], reading["ev100"]) == (lit["luminanceNits"], lit["ev100"])


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"mode": "matrix"}, "mode"),
        ({"x": 0.5}, "x and y"),
        ({"x": 0.5, "y": 0.5, "point": "near"}, "x and y"),
        ({"mode": "average", "point": "near"}, "average"),
        ({"point": "nobody"}, "nobody"),
    ],
    ids=str,
)
def test_impossible_metering_is_reported(client, shot, parameters, words):
    answer = client.get(f"{shot}/meter", params={"time": 1} | parameters)
    assert answer.status_code == 422, answer.text
    assert words in answer.json()["detail"] + str(answer.json()["path"])
