"""Variants and payloads over REST."""

from __future__ import annotations

import pytest

from tests.service.conftest import send

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
)
def Xform "World"
{
    def Camera "camera" {
    }
    def Xform "toy" (
        variants = { string shape = "ball" }
        prepend variantSets = ["shape"]
    )
    {
        variantSet "shape" = {
            "ball" {
                def Sphere "it" {
                    double3 xformOp:translate = (0, 0, -10)
                    uniform token[] xformOpOrder = ["xformOp:translate"]
                }
            }
            "none" {
            }
        }
    }
}
"""


@pytest.fixture
def shot(client) -> str:
    answer = send(client, "toy.usda", STAGE.encode())
    assert answer.status_code == 201, answer.text
    return f"/v1/shots/{answer.json()['id']}"


def edit(client, shot, **change):
    return client.post(f"{shot}/edits", json={"changes": [change]})


def test_a_variant_is_chosen_by_an_edit_and_drawn(client, shot):
    size = {"time": 1, "width": 16, "height": 16, "rays": 1}
    before = client.get(f"{shot}/frame", params=size)
    chosen = edit(client, shot, type="chooseVariant", prim="/World/toy", variantSet="shape", variant="none")
    assert chosen.status_code == 200, chosen.text
    (variants,) = client.get(f"{shot}/choices").json()["variantSets"]
    assert variants == {
        "prim": "/World/toy",
        "name": "shape",
        "variants": ["ball", "none"],
        "selection": "none",
        "edited": True,
    }
    after = client.get(f"{shot}/frame", params=size)
    assert after.status_code == before.status_code == 200
    assert after.content != before.content
    assert client.post(f"{shot}/edits/undo").status_code == 200
    assert client.get(f"{shot}/choices").json()["variantSets"][0]["selection"] == "ball"


def test_a_choice_that_is_not_there_is_refused(client, shot):
    refused = edit(client, shot, type="chooseVariant", prim="/World/toy", variantSet="shape", variant="bal")
    assert (refused.status_code, refused.json()["code"]) == (422, "no_variant")
    assert "did you mean 'ball'?" in refused.json()["detail"]
    refused = edit(client, shot, type="showPayload", prim="/World/toy", shown=False)
    assert (refused.status_code, refused.json()["code"]) == (422, "no_payload")
