"""The editor in Firefox: the picture, its keys, an edit, a drag, the overlay of WebGL, a pick, and playing."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import numpy as np
import pytest
from marionette_driver.keys import Keys

from tests.e2e.editor import FAR, NEAR, focus_points
from tests.e2e.firefox import Firefox

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME, LAST = 40, 42
"""Frames that are played."""
PLAYED = """
    const [count, done] = arguments;
    const canvas = document.querySelector("canvas");
    const [times, pictures] = [[], new Map()];
    const watch = new MutationObserver(() => {
        times.push(Number(canvas.dataset.time));
        pictures.set(times.at(-1), canvas.toDataURL());
        if (times.length < count) return;
        watch.disconnect();
        done([times, new Set(pictures.values()).size]);
    });
    watch.observe(canvas, { attributes: true, attributeFilter: ["data-time"] });
"""


@pytest.fixture(scope="module")
def firefox(service: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    """Firefox, started once."""
    with Firefox.started(service, tmp_path_factory.mktemp("firefox")) as started:
        yield started


@pytest.fixture
def page(firefox: Firefox, service: str) -> Iterator[Firefox]:
    """The editor, open on the demo shot as it comes; an error that the page does not catch fails the test."""
    edits = f"{service}/v1/shots/demo/edits"
    untouched = httpx.get(f"{edits}/history", timeout=120).json()["steps"][0]["revision"]
    httpx.put(edits, json={"revision": untouched}, timeout=120).raise_for_status()
    firefox.open("/?shot=demo&time=1")
    firefox.wait_settled(1)
    yield firefox
    errors = firefox.errors()
    firefox.forget()
    assert errors == []


def test_a_key_steps_to_the_next_frame_and_its_picture(page: Firefox) -> None:
    page.wait_value("Frame", "1")
    page.wait("return document.querySelectorAll('.marker').length === 2")
    first = page.picture()
    assert first[..., :3].std() > 10
    page.press(Keys.ARROW_RIGHT)
    page.wait_settled(2)
    page.wait_value("Frame", "2")
    assert np.abs(page.picture().astype(int) - first).max() > 10


def test_a_typed_f_number_is_saved_and_undone(page: Firefox, service: str) -> None:
    opened, revision = page.value("f-number"), page.revision()
    page.box("f-number").click()
    page.press("8")
    page.press(Keys.ENTER)
    revision = page.wait_edited(revision)
    page.wait_value("f-number", "f/8")
    assert f_stop(service) == 8
    page.press(Keys.CONTROL, "z")
    page.wait_edited(revision)
    page.wait_value("f-number", opened)
    assert f"f/{f_stop(service):g}" == opened


def test_a_dragged_key_is_saved_and_undone(page: Firefox, service: str) -> None:
    before = weights(service)
    time, weight = before[1]
    key, bed = page.wait_for(f'[data-stack="point {NEAR}@{time:g}"]').rect, page.wait_for(".scrub-bed").rect
    x, y, frame = key["x"] + key["width"] / 2, key["y"] + key["height"] / 2, bed["width"] / 95
    revision = page.revision()
    page.drag((x, y), (x - 4 * frame, y), (x - 7.2 * frame, y))
    revision = page.wait_edited(revision)
    assert weights(service) == [before[0], (time - 7, weight), *before[2:]]
    page.press(Keys.CONTROL, "z")
    page.wait_edited(revision)
    assert weights(service) == before


def test_what_is_sharp_is_drawn_over_the_picture(page: Firefox) -> None:
    page.press("p")
    peaking = page.picture("canvas.sharpness[data-look=peaking][data-painted=final]")
    assert 0.02 < (peaking[..., 3] > 0).mean() < 0.5


def test_a_click_on_the_picture_makes_a_focus_point(page: Firefox, service: str) -> None:
    before, revision = focus_points(service, 1), page.revision()
    page.press("m")  # the markers away: the click is for the subject, not for the point on it
    page.wait("return document.querySelector('.marker') === null")
    (x, y), box = before[FAR]["screen"], page.wait_for("canvas").rect
    page.drag((box["x"] + x * box["width"], box["y"] + y * box["height"]))
    page.wait_edited(revision)
    after = focus_points(service, 1)
    (name,) = set(after) - set(before)
    assert after[name]["depthM"] == pytest.approx(before[FAR]["depthM"], rel=0.1)


def test_a_cached_range_plays(page: Firefox) -> None:
    page.open(f"/?shot=demo&time={FRAME}")
    page.wait_settled(FRAME)
    page.press("i")
    for _ in range(LAST - FRAME):
        page.press(Keys.ARROW_RIGHT)
    page.press("o")
    page.press_button("Playback ▾")
    page.press_button("Cache range")
    page.wait_for(f'.cached[data-cached="{LAST - FRAME + 1}"]')
    page.press(Keys.ESCAPE)
    page.press("l")
    times, pictures = page.read_later(PLAYED, 10)
    page.press("k")
    assert set(times) == set(range(FRAME, LAST + 1))
    assert pictures == LAST - FRAME + 1


def test_errors_of_the_page_are_found(page: Firefox) -> None:
    """All other tests look for them; what the security policy forbids is one, and is stopped."""
    page.read("""
        const script = document.createElement("script");
        script.textContent = "document.title = 'run'";
        document.body.append(script);
        window.wrappedJSObject.reportError("a test");
    """)
    page.until(lambda: len(page.errors()) == 2, "two errors")
    errors = "\n".join(page.errors())
    page.forget()
    assert "Content-Security-Policy" in errors
    assert "uncaught exception: a test" in errors
    assert page.read("return document.title") != "run"


def f_stop(service: str) -> float:
    """Return the f-number that the service has."""
    return float(httpx.get(f"{service}/v1/shots/demo/readout", params={"time": 1}, timeout=120).json()["fStop"])


def weights(service: str) -> list[tuple[float, float]]:
    """Return time and value of the weight keys of the near subject."""
    return [(key["time"], key["value"]) for key in focus_points(service, 1)[NEAR]["keys"]["weight"]]
