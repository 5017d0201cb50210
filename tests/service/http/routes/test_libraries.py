"""The libraries of films and bodies, and the sheets of films and lenses, over HTTP."""

from __future__ import annotations

from io import BytesIO

import pytest
from PIL import Image

from service.models.libraries import BODY_EXAMPLE, FILM_EXAMPLE, BodySummary, FilmSummary
from usd_schemas import body_names, film_names


def test_examples_are_true_to_their_models():
    for model, example in ((FilmSummary, FILM_EXAMPLE), (BodySummary, BODY_EXAMPLE)):
        assert model.model_validate(example).model_dump(by_alias=True, mode="json") == example


def test_the_film_library_lists_what_a_chooser_shows(client):
    films = client.get("/v1/films").json()["films"]
    assert [film["name"] for film in films] == film_names()
    by_name = {film["name"]: film for film in films}
    night = by_name["vision3_500t_5219"]
    assert (night["process"], night["kind"], night["speed"], night["balanceK"]) == ("negative", "camera", 500, 3200)
    assert (by_name["vision_2383"]["kind"], by_name["vision_2383"]["speed"]) == ("print", None)
    assert by_name["velvia_50"]["process"] == "reversal"


def test_a_stock_is_described_down_to_its_curves(client):
    film = client.get("/v1/films/5219").json()
    assert (film["name"], film["printStock"]) == ("vision3_500t_5219", "vision_2383")
    for channel in ("red", "green", "blue"):
        exposures, densities = zip(*film["curves"][channel], strict=True)
        assert list(exposures) == sorted(exposures)
        assert densities[-1] > densities[0] + 1.5, "it is a negative"
    assert set(film["granularity"]) == {"red", "green", "blue"}
    print_stock = client.get("/v1/films/vision_2383").json()
    assert print_stock["middleGray"] is None
    assert print_stock["curves"]["green"][-1][1] > 3


def test_the_bodies_are_listed_with_the_shapes_of_pictures(client):
    answer = client.get("/v1/bodies").json()
    assert [body["name"] for body in answer["bodies"]] == body_names()
    assert {shape["name"]: shape["aspect"] for shape in answer["shapes"]}["2.39:1"] == 2.39
    assert all(body["resolution"] is None for body in answer["bodies"] if body["kind"] == "film")


def test_a_body_says_what_it_shows(client):
    body = client.get("/v1/bodies/full_frame", params={"focalLengthMm": [18, 50]}).json()
    [wide, normal] = body["fieldsOfView"]
    assert wide["horizontalDeg"] == pytest.approx(90, abs=0.05)
    assert normal["fullFrameMm"] == pytest.approx(50, abs=0.1)
    scope = next(guide for guide in body["framingGuides"] if guide["name"] == "2.39:1")
    assert scope["gateMm"][0] / scope["gateMm"][1] == pytest.approx(2.39)


@pytest.mark.parametrize(
    ("address", "code", "words"),
    [
        ("films/vision3_500t_5291", "unknown_stock", "vision3_500t_5219"),
        ("films/vision3_500t_5291/sheet.png", "unknown_stock", "vision3_500t_5219"),
        ("bodies/full_fram", "no_such_body", "full_frame"),
        ("lenses/planr_50/sheet.png", "no_such_lens", "planar_50"),
    ],
)
def test_unknown_library_names_are_reported_with_neighbours(client, address, code, words):
    answer = client.get(f"/v1/{address}")
    assert (answer.status_code, answer.json()["code"]) == (404, code)
    assert words in answer.json()["detail"]


def test_a_lens_without_a_length_has_no_field_of_view(client):
    assert client.get("/v1/bodies/full_frame", params={"focalLengthMm": 0}).status_code == 422


@pytest.mark.parametrize("address", ["films/tri_x_400", "lenses/planar_50"])
def test_a_sheet_is_a_picture(client, address):
    answer = client.get(f"/v1/{address}/sheet.png")
    assert answer.status_code == 200, answer.text
    assert "max-age" in answer.headers["cache-control"]
    with Image.open(BytesIO(answer.content)) as picture:
        assert min(picture.size) > 800
