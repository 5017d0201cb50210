"""Movies and contact sheets of renders over REST."""

from __future__ import annotations

import av
import numpy as np
import OpenImageIO as oiio
import pytest

from service.http.errors import ServiceError
from service.storage.database.connection import transaction
from service.storage.database.tables import TaskRow
from tests.service.kits.renders import ended, render_of, watched

pytestmark = pytest.mark.gl


@pytest.mark.parametrize(("format", "codec"), [("mp4", "h264"), ("mov", "prores"), ("webm", "vp9")])
def test_a_movie_holds_the_frames_of_a_render(client, room, tmp_path, format, codec):
    render = render_of(client, room, frames="1-7:2", formats=["exr", "png"], name="dailies/x")
    assert ended(client, render)["state"] == "done"
    address = f"/v1/renders/{render['id']}"
    answer = client.get(f"{address}/movie", params={"format": format})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] in ("video/mp4", "video/quicktime", "video/webm")
    assert f'filename="x.{format}"' in answer.headers["content-disposition"]
    path, still = tmp_path / f"a.{format}", tmp_path / "a.png"
    path.write_bytes(answer.content)
    still.write_bytes(client.get(f"{address}/frames/3", params={"format": "png"}).content)
    with av.open(str(path)) as movie:
        stream = movie.streams.video[0]
        frames = list(movie.decode(stream))
        assert (stream.codec.name, len(frames), float(stream.average_rate)) == (codec, 4, pytest.approx(12, rel=0.01))
        assert (frames[0].color_primaries, frames[0].color_trc, frames[0].colorspace) == (1, 1, 1)
    picture = oiio.ImageBuf(str(still)).get_pixels(oiio.UINT8)
    height, width, _ = picture.shape
    shown = frames[1].to_ndarray(format="rgb24")[:height, :width].astype(float).mean((0, 1))
    np.testing.assert_allclose(
        shown, picture.astype(float).mean((0, 1)), atol=4
    )  # FFmpeg's conversion to RGB rounds down


def test_a_product_is_made_once_and_again_for_new_frames(service, client, room):
    render = render_of(client, room, frames="1-2", formats=["png"])
    ended(client, render)
    address, folder = f"/v1/renders/{render['id']}", service.settings.data / "renders" / render["id"]
    first = client.get(f"{address}/movie")
    (made,) = (folder / "products").iterdir()
    stamp = made.stat().st_mtime_ns
    assert client.get(f"{address}/movie").headers["etag"] == first.headers["etag"]
    assert made.stat().st_mtime_ns == stamp
    queue = service.internal.renders
    assert queue.get(render["id"]).product_bytes == len(first.content)
    part = client.get(f"{address}/movie", headers={"Range": "bytes=4-7"})
    assert (part.status_code, part.content) == (206, b"ftyp")

    next(folder.glob("2.*.png")).unlink()
    gone = client.get(f"{address}/movie")
    assert (gone.status_code, gone.json()["code"]) == (404, "frame_file_gone")
    client.post(f"{address}/retry")
    ended(client, render)
    assert client.get(f"{address}/movie").content == first.content  # the same frame was drawn again
    assert made.stat().st_mtime_ns == stamp
    with transaction(queue._engine) as session:
        task = session.get(TaskRow, (render["id"], 2))
        task.files = {"png": {**task.files["png"], "sha256": "another"}}
    assert client.get(f"{address}/movie").headers["etag"] != first.headers["etag"]
    (anew,) = (folder / "products").iterdir()
    assert anew != made
    assert client.delete(address).status_code == 204
    assert not folder.exists()


def test_a_movie_that_cannot_be_made_leaves_nothing(service, client, room):
    render = render_of(client, room, frames="1-2", formats=["png"])
    ended(client, render)
    address, folder = f"/v1/renders/{render['id']}", service.settings.data / "renders" / render["id"]
    for path in folder.glob("*.png"):
        path.write_bytes(bytes(path.stat().st_size))  # damaged, and of the size that it had
    answer = client.get(f"{address}/movie")
    assert (answer.status_code, answer.json()["code"]) == (422, "bad_input")
    assert "1.1.png cannot be read" in answer.json()["detail"]
    assert str(service.settings.data) not in answer.text
    assert list((folder / "products").iterdir()) == []


def test_a_movie_that_a_project_has_no_room_for_is_removed(service, client, room, monkeypatch):
    render = render_of(client, room, frames="1-2", formats=["png"])
    ended(client, render)

    def refuse(project, size_bytes):
        raise ServiceError(403, "quota_stored", "There is no room.")

    monkeypatch.setattr(service.internal.quotas, "check_room", refuse)
    answer = client.get(f"/v1/renders/{render['id']}/movie")
    assert (answer.status_code, answer.json()["code"]) == (403, "quota_stored")
    products = service.settings.data / "renders" / render["id"] / "products"
    assert list(products.iterdir()) == []


def test_a_contact_sheet_shows_each_frame(client, room, tmp_path):
    render = render_of(client, room, frames="1-5", formats=["png"])
    ended(client, render)
    answer = client.get(f"/v1/renders/{render['id']}/contact-sheet")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "image/png")
    (tmp_path / "sheet.png").write_bytes(answer.content)
    (tmp_path / "frame.png").write_bytes(client.get(f"/v1/renders/{render['id']}/frames/4").content)
    sheet, frame = (oiio.ImageBuf(str(tmp_path / name)).get_pixels(oiio.UINT8) for name in ("sheet.png", "frame.png"))
    windows = np.lib.stride_tricks.sliding_window_view(sheet[..., :3], frame.shape)[:, :, 0]
    assert (windows == frame).all((2, 3, 4)).any()


@pytest.mark.parametrize("product", ["movie", "contact-sheet"])
def test_products_need_graded_frames_of_an_ended_render(client, room, product):
    linear = render_of(client, room, frames="1", formats=["exr"])
    ended(client, linear)
    answer = client.get(f"/v1/renders/{linear['id']}/{product}")
    assert (answer.status_code, answer.json()["code"]) == (409, "no_graded_frames")
    assert '"formats": ["exr", "png"]' in answer.json()["detail"]

    paused = render_of(client, room, frames="1-24", formats=["png"])
    client.post(f"/v1/renders/{paused['id']}/pause")
    watched(client, paused, lambda now: now["state"] == "paused")
    answer = client.get(f"/v1/renders/{paused['id']}/{product}")
    assert (answer.status_code, answer.json()["code"]) == (409, "render_not_ended")
    client.post(f"/v1/renders/{paused['id']}/cancel")
