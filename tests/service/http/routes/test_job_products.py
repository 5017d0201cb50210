"""Renders whose products are made as the last part of the job, without anyone asking."""

from __future__ import annotations

import io
from pathlib import Path

import av
import pytest

from service.http import product_runner
from service.http.errors import ServiceError
from service.http.render_products import RenderProducts
from service.http.settings import Settings
from service.jobs.product_queue import ProductQueue
from service.models.render_products import PRODUCTS, needs_pictures
from service.workers.errors import QueueFullError
from tests.service.conftest import hold_back, running, send
from tests.service.kits.renders import SMALL, ended, render_of

PICTURELESS = [name for name in PRODUCTS if not needs_pictures(name)]


def products_of(render):
    return {each["name"]: each["state"] for each in render["products"]}


def no_worker(*_):
    raise AssertionError("it is made again")


@pytest.mark.gl
def test_a_movie_and_a_sheet_are_made_with_the_frames(service, client, room, monkeypatch):
    names = ["movie.mp4", "contact-sheet.png"]
    render = render_of(client, room, frames="1-3", formats=["png"], products=names)
    assert products_of(render) == dict.fromkeys(names, "waiting")
    done = ended(client, render)
    assert (done["state"], products_of(done)) == ("done", dict.fromkeys(names, "done"))
    assert done["finishedAt"] is not None
    monkeypatch.setattr(type(service.internal.render_products.lane), "result", no_worker)
    movie = client.get(f"/v1/renders/{render['id']}/movie")
    assert done["products"][0]["sizeBytes"] == len(movie.content)
    with av.open(io.BytesIO(movie.content)) as opened:
        assert len(list(opened.decode(opened.streams.video[0]))) == 3
    assert client.get(f"/v1/renders/{render['id']}/contact-sheet").content.startswith(b"\x89PNG")


def test_a_render_of_reports_alone_draws_nothing(service, client, room):
    render = render_of(client, room, frames="2-6:2", formats=[], products=PICTURELESS)
    assert (render["count"], render["frames"], render["formats"]) == (0, "2-6:2", [])
    done = ended(client, render)
    assert (done["state"], products_of(done)) == ("done", dict.fromkeys(PICTURELESS, "done"))
    assert client.get(f"/v1/renders/{render['id']}/tasks").json() == {"tasks": []}
    assert client.get(f"/v1/renders/{render['id']}/frames/2").status_code == 404
    client.patch(f"/v1/shots/{room}/camera", json={"focusDistanceM": 9, "focusMode": "manual"})
    sizes = {each["name"]: each["sizeBytes"] for each in done["products"]}
    for name in PICTURELESS:
        kind, _, suffix = name.partition(".")
        answer = client.get(f"/v1/renders/{render['id']}/{kind}", params={"format": suffix})
        assert (answer.status_code, len(answer.content)) == (200, sizes[name]), name
    rows = client.get(f"/v1/renders/{render['id']}/focus-curve", params={"format": "csv"}).text.splitlines()
    assert [row.split(",")[0] for row in rows] == ["frame", "2.0", "4.0", "6.0"]
    folder = service.settings.data / "renders" / render["id"]
    assert len(list((folder / "products").iterdir())) == len(PICTURELESS)
    assert service.internal.renders.get(render["id"]).product_bytes == sum(sizes.values())
    assert client.delete(f"/v1/renders/{render['id']}").status_code == 204
    assert not folder.exists()


def test_a_curve_is_written_when_asked_for_without_a_product(client, room):
    render = render_of(client, room, frames="3", formats=[], products=["focus-report.csv"])
    curve = client.get(f"/v1/renders/{render['id']}/focus-curve")
    assert (curve.status_code, [each["frame"] for each in curve.json()["samples"]]) == (200, [3])
    assert curve.headers["content-disposition"] == f'inline; filename="{render["id"]}-focus.json"'
    ended(client, render)


def test_a_product_whose_shot_is_gone_fails_and_is_retried(service, client, room, monkeypatch):
    hold_back(service.internal.renders.products, monkeypatch)
    render = render_of(client, room, frames="1", formats=[], products=["focus-report.csv"])
    assert client.delete(f"/v1/shots/{room}").status_code == 204
    monkeypatch.undo()
    failed = ended(client, render)
    (product,) = failed["products"]
    assert (failed["state"], product["state"], product["sizeBytes"]) == ("failed", "failed", None)
    assert "needs the shot" in product["error"]
    (trashed,) = [each for each in client.get("/v1/trash").json()["shots"] if each["shot"] == room]
    assert client.post(f"/v1/trash/{trashed['id']}/restore").status_code < 300
    assert client.post(f"/v1/renders/{render['id']}/retry").json()["state"] in ("queued", "running")
    assert ended(client, render)["state"] == "done"


@pytest.mark.parametrize("refusal", [ServiceError(409, "render_not_ended", "It is running."), QueueFullError()])
def test_a_product_that_comes_too_early_is_made_later(service, client, room, monkeypatch, refusal):
    find, tried = RenderProducts.find_text, []

    async def find_later(*args):
        tried.append(args)
        if len(tried) == 1:
            raise refusal
        return await find(*args)

    monkeypatch.setattr(RenderProducts, "find_text", find_later)
    monkeypatch.setattr(product_runner, "BUSY_PAUSE_S", 0.1)
    render = render_of(client, room, frames="1", formats=[], products=["focus-report.csv"])
    assert (ended(client, render)["state"], len(tried)) == ("done", 2)


def test_what_others_write_meanwhile_is_not_counted(service, client, room, monkeypatch):
    stat = Path.stat

    def stat_late(path, **options):
        if path.name == "gone.csv":
            raise FileNotFoundError(path)
        return stat(path, **options)

    monkeypatch.setattr(Path, "stat", stat_late)
    folder = service.internal.render_files.products
    find = RenderProducts.find_text

    async def find_beside(products, render, *args):
        folder(render.id).mkdir(parents=True)
        (folder(render.id) / "gone.csv").write_bytes(b"abc")
        (folder(render.id) / ".movie.mp4.1.part").write_bytes(b"abc")
        return await find(products, render, *args)

    monkeypatch.setattr(RenderProducts, "find_text", find_beside)
    done = ended(client, render_of(client, room, frames="1", formats=[], products=["focus-report.csv"]))
    assert done["state"] == "done"
    assert service.internal.renders.get(done["id"]).product_bytes == done["products"][0]["sizeBytes"]


def test_a_render_is_under_way_until_its_products_are_made(service, client, room, monkeypatch):
    hold_back(service.internal.renders.products, monkeypatch)
    render = render_of(client, room, frames="1", formats=[], products=["focus-curve.csv"])
    assert (render["state"], render["secondsLeft"], render["finishedAt"]) == ("queued", None, None)
    assert client.delete(f"/v1/renders/{render['id']}").status_code == 409
    assert client.post(f"/v1/renders/{render['id']}/pause").json()["state"] == "paused"
    canceled = client.post(f"/v1/renders/{render['id']}/cancel").json()
    assert (canceled["state"], products_of(canceled)) == ("canceled", {"focus-curve.csv": "canceled"})
    assert canceled["finishedAt"] is not None


def test_what_products_need_is_told_at_once(client, room):
    def refusal(**request):
        answer = client.post("/v1/renders", json=SMALL | {"shot": room} | request)
        assert answer.status_code == 422, answer.text
        return answer.text

    assert "add png or jpeg" in refusal(formats=["exr"], products=["movie.mp4"])
    assert "add png or jpeg" in refusal(formats=[], products=["contact-sheet.png"])
    assert "each product may come once" in refusal(products=["focus-report.csv"] * 2)
    assert "draws no frame" in refusal(formats=[])
    assert "AOVs are parts of EXR files" in refusal(formats=[], products=["focus-report.csv"], aovs=["depth"])
    assert "graded pictures" in refusal(formats=[], products=["focus-report.csv"], burnIn=["frame"])
    refusal(products=["movie.gif"])
    refusal(products="movie.mp4")


def test_a_plan_of_reports_alone_costs_nothing(client, room):
    body = SMALL | {"shot": room, "frames": "1-3", "formats": [], "products": ["focus-report.csv"]}
    plan = client.post("/v1/render-plans", json=body).json()
    assert (plan["count"], plan["frames"], plan["secondsOfProcessor"]) == (0, "1-3", 0)
    assert plan["settings"]["formats"] == []
    outside = client.post("/v1/render-plans", json=body | {"frames": "900"}).json()
    assert [each["code"] for each in outside["findings"]] == ["frames_outside_shot"]


def test_a_service_that_starts_again_goes_on_with_products(tmp_path, room_file, monkeypatch):
    settings = Settings(data=tmp_path, demo=False)
    with running(settings) as first:
        products = first.internal.renders.products
        hold_back(products, monkeypatch)
        shot = send(first.client, "room.usda", room_file.read_bytes()).json()["id"]
        render = render_of(first.client, shot, frames="1", formats=[], products=["focus-report.csv", "focus-curve.csv"])
        assert ProductQueue.claim(products, 60.0).name == "focus-report.csv"  # and is killed
    with running(settings) as second:
        assert ended(second.client, render)["state"] == "done"
