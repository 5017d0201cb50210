"""A shot whose film, grade or shutter makes no sense is answered with one clear sentence, and the next picture comes."""

import pytest

from tests.service.conftest import ROOM, send

SMALL = {"time": 1, "width": 48, "rays": 2, "supersample": 1, "motion": 2}
BACKWARDS = "double2[] film:curve:green = [(-1, 0.1), (0, 1), (1, 0.5)]"


@pytest.mark.parametrize(
    ("says", "code", "words"),
    [
        (
            f'token film:process = "monochrome"\ntoken film:curve:source = "knots"\n{BACKWARDS}',
            "bad_curve",
            ("the green curve of film:curve runs backwards", "got 1 at 0 and 0.5 at 1"),
        ),
        (
            'token film:process = "negative"\nstring film:stock = "5218"',
            "unknown_stock",
            ("no film stock named '5218'", "5219"),
        ),
        (
            'token film:process = "negative"\nstring film:stock = "5219"\ndouble film:grain:amount = 1e30',
            "bad_film",
            ("film:grain:amount must be from 0 to 100", "got 1e+30"),
        ),
        ('token film:shutter:type = "sideways"', "unknown_token", ("film:shutter:type", "'sideways'")),
        ("int film:process = 3", "wrong_type", ("film:process", "type token, got int")),
        ('string film:ocio:view = "Rwa"', "unknown_view", ("unknown view 'Rwa'", "'Raw'")),
        (
            "double shutter:open = 0.5\ndouble shutter:close = 0.25",
            "bad_shutter",
            ("cannot close before it opens", "0.5", "0.25"),
        ),
    ],
)
def test_it_is_one_sentence_that_names_the_camera(client, says, code, words):
    room = ROOM.replace(
        'def Camera "cam"\n    {', f'def Camera "cam" (prepend apiSchemas = ["FilmAPI"])\n    {{\n{says}'
    )
    assert room != ROOM
    shot = send(client, "bad.usda", room.encode()).json()["id"]

    answer = client.get(f"/v1/shots/{shot}/frame", params=SMALL)
    listed = client.get(f"/v1/shots/{shot}/inspect").json()

    assert answer.status_code == 422
    problem = answer.json()
    assert (problem["code"], problem["path"]) == (code, "/World/cam")
    assert all(word in problem["detail"] for word in ("/World/cam", *words))
    assert len([*listed["notes"], *listed["validation"]]) == 1
    assert client.delete(f"/v1/shots/{shot}").status_code == 204
