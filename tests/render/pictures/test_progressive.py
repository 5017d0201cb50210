"""The progressive renderer: a preview, then better, then exactly the picture of `record`; and nothing is computed twice."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np
import pytest
from pxr import Gf, UsdGeom

from render.film import GradeChoice
from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import CancellationPoint, Cancelled
from render.lab.reference.metrics import psnr_db
from render.layers.peel import Peeler, PeelKey
from render.layers.peeled import Layers
from render.layers.renderer import LayerRenderer
from render.model.arrays import FloatArray
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import make_picture
from render.pictures.progressive import PreviewRequest, ProgressivePicture
from render.pictures.progressive.background import run_in_background
from render.pictures.progressive.equality import have_equal_content
from render.pictures.progressive.frames import enlarge
from render.pictures.progressive.planner import GOOD_RAYS
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot
from render.shot.film import finish as finishing
from render.trace.highlights import finder
from render.trace.tracer import Tracer
from tests.render.kits.moving_shots import add_card, key_move, write_posts_shot

SETTINGS = FrameSettings(160, 90, rays=40, layers=3, supersample=1.5)


@pytest.fixture
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as own:
        yield own


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    """A camera that looks at posts before a wall, and a card that moves."""
    stage = write_posts_shot(tmp_path / "room.usda")
    card = add_card(stage, "/card", size=(0.7, 0.8), depth=3.0, colour=(1, 1, 0.2))
    key_move(card.AddTranslateOp(), Gf.Vec3d(-0.4, 0, 0), Gf.Vec3d(0.4, 0, 0))
    stage.Save()
    return Shot.open(tmp_path / "room.usda")


@pytest.fixture
def progressive(renderer: FrameRenderer, shot: Shot) -> ProgressiveRenderer:
    return ProgressiveRenderer(renderer, shot, LiveFinisher(renderer))


class Counted:
    """Count of the calls of a method."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, owner: type, name: str) -> None:
        self.calls = 0
        plain: Callable[..., object] = getattr(owner, name)

        def counted(*arguments: object, **named: object) -> object:
            self.calls += 1
            return plain(*arguments, **named)

        monkeypatch.setattr(owner, name, counted)

    def since(self) -> int:
        calls, self.calls = self.calls, 0
        return calls


def last(pictures: Iterator[ProgressivePicture]) -> ProgressivePicture:
    return list(pictures)[-1]


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"engine": "flag"},
        {"engine": "scatter"},
        {"engine": "importance"},
        {"engine": "linear"},
        {"engine": "gather", "width": 80, "height": 46},
        {"engine": "pinhole"},
        {"engine": "accumulation", "rays": 8},
        {"rays": 200, "wavelengths": 1},
        {"motion": 4, "motion_by": "velocities"},
        {"motion": 3, "aovs": ("color", "depth")},
        {"aovs": ("color", "coc", "albedo")},
    ],
)
def test_the_last_picture_is_that_of_record(
    progressive: ProgressiveRenderer, shot: Shot, changes: dict[str, object]
) -> None:
    settings = replace(SETTINGS, **changes)  # type: ignore[arg-type]
    pictures = list(progressive.pictures(PreviewRequest("/cam", 2.0, settings, choice=GradeChoice(view="Raw"))))
    assert pictures[0].stage == "preview"
    assert [shown.stage for shown in pictures[1:-1]] == ["refining"] * (len(pictures) - 2)
    final = pictures[-1]
    with FrameRenderer() as other:
        plain = make_picture(other, shot, "/cam", 2.0, settings, choice=GradeChoice(view="Raw"))
    assert final.is_final
    assert final.picture is not None
    np.testing.assert_array_equal(final.graded, plain.graded)
    np.testing.assert_array_equal(final.picture.frame.color, plain.frame.color)
    assert final.picture.frame.aovs.keys() == plain.frame.aovs.keys()
    assert have_equal_content(final.picture.metadata.settings, plain.metadata.settings)


def test_focus_maps_come_with_the_first_and_last(progressive: ProgressiveRenderer) -> None:
    request = PreviewRequest("/cam", 2.0, replace(SETTINGS, aovs=("color", "coc", "depth")), maps_focus=True)
    pictures = list(progressive.pictures(request))
    first, final = pictures[0].focus, pictures[-1].focus
    assert first is not None
    assert final is not None
    assert not any(shown.focus for shown in pictures[1:-1])
    frame = pictures[-1].picture.frame  # type: ignore[union-attr]
    np.testing.assert_array_equal(final.coc_px, frame.aovs["coc"])
    np.testing.assert_array_equal(final.depth_m, frame.aovs["depth"])
    assert np.median(np.abs(first.depth_m - final.depth_m)) < 0.01
    hurried = progressive.pictures(replace(request, time=1.0, is_moving=True, is_hurried=True))
    assert [shown.focus for shown in hurried] == [None]


def test_the_first_picture_is_like_the_last(progressive: ProgressiveRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("render.pictures.progressive.frames._LEAST_RAY_SHARE", 0.0)
    pictures = list(progressive.pictures(PreviewRequest("/cam", 2.0, SETTINGS, budget_ms=1.0)))
    assert pictures[0].rays == GOOD_RAYS
    first, final = pictures[0].graded, pictures[-1].graded
    assert psnr_db(enlarge(first, 160, 90), final) > 22
    assert pictures[0].timing.total_ms >= pictures[0].timing.blur_ms > 0
    better = pictures[1]
    assert better.rays > pictures[0].rays
    assert better.graded.shape > first.shape
    assert psnr_db(enlarge(better.graded, 160, 90), final) > 30


def test_a_drag_of_the_focus_searches_for_highlights_once(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With two focal surfaces, between which it may be dragged; again only where the stop is opened."""
    request = PreviewRequest("/cam", 2.0, SETTINGS, is_moving=True)
    searched = []
    plain = finder.find_highlights
    monkeypatch.setattr(finder, "find_highlights", lambda *args: searched.append(args) or plain(*args))
    shot.camera.set("/cam", f_stop=2.0)
    next(progressive.pictures(request))  # a sketch of the view
    shot.camera.set("/cam", focus_distance_m=2.9)
    next(progressive.pictures(request))
    first = len(searched)
    for metres in (2.0, 3.0, 5.0):
        shot.camera.set("/cam", focus_distance_m=metres)
        next(progressive.pictures(request))
    assert len(searched) == first == 4
    shot.camera.set("/cam", f_stop=4.0)
    next(progressive.pictures(request))
    assert len(searched) == first
    shot.camera.set("/cam", f_stop=1.4)
    next(progressive.pictures(request))
    assert len(searched) == first + 2


def test_a_preview_that_waits_for_its_layers_has_more_rays(
    progressive: ProgressiveRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The time until its layers are there is much longer than a budget of a millisecond."""
    work = []
    for share, time in ((0.0, 1.0), (2.0, 3.0)):
        monkeypatch.setattr("render.pictures.progressive.frames._LEAST_RAY_SHARE", share)
        first = next(progressive.pictures(PreviewRequest("/cam", time, SETTINGS, budget_ms=1.0, is_moving=True)))
        work.append(first.graded.size * first.rays)
    assert work[1] > 2 * work[0]


def test_a_brief_preview_of_a_new_view_has_one_layer(
    progressive: ProgressiveRenderer, renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    layers: list[int] = []
    peel = Peeler.peel_by

    def note_layers(self: Peeler, key: PeelKey, **named: Any) -> Layers:
        layers.append(key.layers)
        return peel(self, key, **named)

    monkeypatch.setattr(Peeler, "peel_by", note_layers)
    for time, named in ((1.0, {}), (2.0, {"is_hurried": True}), (3.0, {"is_moving": True})):
        assert next(progressive.pictures(PreviewRequest("/cam", time, SETTINGS, **named))).stage == "preview"
    assert layers == [2, 1, 1 if renderer.graphics.is_software else 2]


def test_a_moving_view_that_is_shown_again_needs_no_new_layers(
    progressive: ProgressiveRenderer, renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = Counted(monkeypatch, LayerRenderer, "draw_layer")
    for time in (1.0, 3.0, 2.0):
        next(progressive.pictures(PreviewRequest("/cam", time, SETTINGS, is_moving=True)))
    assert drawn.since() > 0
    next(progressive.pictures(PreviewRequest("/cam", 1.0, SETTINGS, is_moving=True)))
    assert drawn.since() == 0 or not renderer.graphics.is_software


def test_hurried_previews_keep_the_layers_of_many_views(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    def preview(time: float) -> FloatArray:
        request = PreviewRequest("/cam", time, SETTINGS, budget_ms=1000.0, is_moving=True, is_hurried=True)
        return next(progressive.pictures(request)).graded

    drawn = Counted(monkeypatch, LayerRenderer, "draw_layer")
    shot.camera.set("/cam", focus_distance_m=2.0, f_stop=1.0)
    first = [preview(time) for time in (1.0, 3.0, 2.0)]
    assert drawn.since() > 0
    assert psnr_db(preview(1.0), first[0]) > 50.0
    shot.camera.set("/cam", focus_distance_m=5.0)
    assert psnr_db(preview(3.0), first[1]) < 45.0
    assert drawn.since() == 0
    UsdGeom.Mesh(shot.stage.GetPrimAtPath("/card")).GetDisplayColorAttr().Set([(0, 0, 1)])
    preview(1.0)
    assert drawn.since() > 0


def test_a_drag_gets_previews_alone(progressive: ProgressiveRenderer) -> None:
    pictures = list(progressive.pictures(PreviewRequest("/cam", 2.0, SETTINGS, is_moving=True)))
    assert [shown.stage for shown in pictures] == ["preview"]


def test_a_change_of_focus_or_stop_peels_nothing_at_first(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = Counted(monkeypatch, LayerRenderer, "draw_layer")
    shadows = Counted(monkeypatch, LayerRenderer, "draw_shadow")
    moving = PreviewRequest("/cam", 2.0, SETTINGS, budget_ms=1000.0, is_moving=True)  # enough on a busy machine too
    sketched = last(progressive.pictures(moving)).graded
    before = last(progressive.pictures(moving)).graded
    assert sketched.shape < before.shape, "what is new, and may change at once again, is sketched"
    assert drawn.since() > 0
    shadows.since()
    for distance, stop in ((2.0, 0.5), (5.0, 0.5), (5.0, 8.0)):
        shot.camera.set("/cam", focus_distance_m=distance, f_stop=stop)
        after = last(progressive.pictures(moving)).graded
        assert np.abs(after - before).max() > 0.05
        before = after
    assert (drawn.since(), shadows.since()) == (0, 0)
    last(progressive.pictures(replace(moving, time=3.0)))
    assert drawn.since() > 0


def test_previews_of_pictures_in_several_sizes_share_their_layers(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    shot.camera.set("/cam", focal_length_mm=43.7)
    moving = PreviewRequest("/cam", 2.0, replace(SETTINGS, width=960, height=540), is_moving=True)
    for _ in range(2):  # sketched first
        last(progressive.pictures(moving))
    drawn = Counted(monkeypatch, LayerRenderer, "draw_layer")
    for width, height in ((864, 486), (1056, 594), (1216, 684)):
        last(progressive.pictures(replace(moving, settings=replace(SETTINGS, width=width, height=height))))
    assert drawn.since() == 0


def test_more_rays_of_a_preview_are_drawn_only_while_layers_are(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("render.pictures.progressive.frames._LEAST_RAY_SHARE", 0.0)
    request = PreviewRequest("/cam", 2.0, SETTINGS, budget_ms=1.0)

    def further_previews(changed: PreviewRequest) -> int:
        return sum(shown.stage == "refining" and shown.share == 0 for shown in progressive.pictures(changed))

    shot.camera.set("/cam", focus_distance_m=2.0)
    assert further_previews(request) == 1
    shot.camera.set("/cam", focus_distance_m=2.02)
    assert further_previews(request) == 0, "layers are kept"
    assert further_previews(replace(request, time=3.0)) == 1
    shot.camera.set("/cam", focus_distance_m=0.5)
    assert further_previews(replace(request, time=3.0)) == 1, "a wider guard band needs new layers"


def test_a_change_of_grade_or_film_traces_nothing(
    progressive: ProgressiveRenderer, shot: Shot, monkeypatch: pytest.MonkeyPatch
) -> None:
    traced = Counted(monkeypatch, Tracer, "passes")
    developed = Counted(monkeypatch, finishing, "develop_on_film")  # type: ignore[arg-type]
    request = PreviewRequest("/cam", 2.0, SETTINGS, stock="5219")
    one = last(progressive.pictures(request))
    assert traced.since() > 0
    assert developed.since() == 1
    raw = last(progressive.pictures(replace(request, choice=GradeChoice(view="Raw"))))
    assert (traced.since(), developed.since()) == (0, 0)
    assert np.abs(raw.graded - one.graded).max() > 0.02
    other = last(progressive.pictures(replace(request, stock="5222")))
    assert (traced.since(), developed.since()) == (0, 1)
    assert np.abs(other.graded - one.graded).max() > 0.02
    shot.camera.set("/cam", f_stop=11.0)
    last(progressive.pictures(request))
    assert traced.since() > 0


def test_stale_work_is_cancelled_and_spoils_nothing(progressive: ProgressiveRenderer, shot: Shot) -> None:
    """Cancelled between any two pieces: the next picture is right."""
    request = PreviewRequest("/cam", 2.0, SETTINGS)
    plain = last(progressive.pictures(request)).graded
    polls = 0

    def counting() -> bool:
        nonlocal polls
        polls += 1
        return False

    progressive.release()
    last(progressive.pictures(replace(request, time=2.5), is_stale=counting))
    assert polls > 20, "staleness is polled often"
    ended = []
    for until in np.linspace(1, polls, 9).astype(int):
        left = int(until)

        def is_stale() -> bool:
            nonlocal left
            left -= 1
            return left <= 0

        progressive.release()
        pictures = list(progressive.pictures(replace(request, time=2.0 + 0.1 * until), is_stale=is_stale))
        ended.append(pictures[-1].is_final)
        progressive.release()
        np.testing.assert_array_equal(last(progressive.pictures(request)).graded, plain)
    assert not any(ended[:-2]), "stale work is not finished"


def test_a_closed_iterator_cancels_the_work(progressive: ProgressiveRenderer) -> None:
    request = PreviewRequest("/cam", 2.0, SETTINGS)
    plain = last(progressive.pictures(request)).graded
    progressive.release()
    for count in (1, 2):
        work = progressive.pictures(replace(request, time=1.0 + count))
        for _ in range(count):
            next(work)
        work.close()
    np.testing.assert_array_equal(last(progressive.pictures(request)).graded, plain)


def test_unfinished_pictures_are_shown_between_pieces(
    progressive: ProgressiveRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("render.pictures.progressive.renderer.REFRESH_MS", 0.0)
    monkeypatch.setattr("render.gl.cancellation.PIECE_MS", 1.0)
    request = PreviewRequest("/cam", 2.0, replace(SETTINGS, rays=160))
    pictures = list(progressive.pictures(request))
    shares = [shown.share for shown in pictures if shown.stage == "refining" and shown.share > 0]
    assert len(shares) > 1
    assert shares == sorted(shares)
    whole = [psnr_db(shown.graded, pictures[-1].graded) for shown in pictures if shown.share > 0]
    assert whole[-2] > whole[0]
    progressive.release()
    monkeypatch.setattr("render.pictures.progressive.renderer.REFRESH_MS", 1e9)
    np.testing.assert_array_equal(last(progressive.pictures(request)).graded, pictures[-1].graded)


def test_unfinished_pictures_take_a_part_of_the_time(
    progressive: ProgressiveRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a clock that goes on by a second with each reading, so that each picture takes one."""
    monkeypatch.setattr("render.pictures.progressive.renderer._LONGEST_WAIT_MS", 1e9)
    seconds = itertools.count()
    monkeypatch.setattr("render.pictures.progressive.renderer.perf_counter", seconds.__next__)
    monkeypatch.setattr("render.gl.cancellation.PIECE_MS", 1.0)
    pictures = list(progressive.pictures(PreviewRequest("/cam", 2.0, replace(SETTINGS, rays=160))))
    unfinished = [shown for shown in pictures if shown.stage == "refining" and shown.share > 0]
    assert 1 < len(unfinished) <= next(seconds) / 5


def test_an_edit_of_the_scene_shows(progressive: ProgressiveRenderer, shot: Shot) -> None:
    request = PreviewRequest("/cam", 2.0, SETTINGS)
    before = last(progressive.pictures(request)).graded
    with shot.edits.transaction("hide the card"):
        UsdGeom.Imageable(shot.stage.GetPrimAtPath("/card")).MakeInvisible()
    after = last(progressive.pictures(request)).graded
    assert np.abs(after - before).max() > 0.2


@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (90, 160)])
def test_enlarging_keeps_what_is_even(shape: tuple[int, int]) -> None:
    picture = np.full((*shape, 3), 0.3, np.float32)
    np.testing.assert_allclose(enlarge(picture, 160, 90), np.full((90, 160, 3), 0.3), rtol=1e-6)
    ramp = np.broadcast_to(np.linspace(0, 1, 40, dtype=np.float32)[None, :, None], (7, 40, 1))
    assert np.all(np.diff(enlarge(ramp, 160, 20)[:, :, 0], axis=1) >= 0)


def test_equality_is_that_of_the_content() -> None:
    one = SETTINGS
    assert have_equal_content(one, replace(one))
    assert not have_equal_content(one, replace(one, rays=41))
    assert have_equal_content(one, replace(one, rays=41), except_fields=("rays",))
    assert have_equal_content((np.arange(3.0), {"a": [1]}), (np.arange(3.0), {"a": [1]}))
    assert not have_equal_content(np.arange(3.0), np.arange(4.0))
    assert not have_equal_content({"a": 1}, {"a": 2})
    assert have_equal_content(np.array([np.nan]), np.array([np.nan]))
    assert not have_equal_content(1, 1.0)


def test_background_work_stops_when_nothing_waits_for_it() -> None:
    cancellation = CancellationPoint(lambda: None)
    assert run_in_background(lambda: 7, cancellation) == 7
    with pytest.raises(ZeroDivisionError), cancellation.cancel_when(lambda: False):
        run_in_background(lambda: 1 // 0, cancellation)
    ended, asked = Event(), itertools.count()
    try:
        with pytest.raises(Cancelled), cancellation.cancel_when(lambda: next(asked) > 2):
            run_in_background(ended.wait, cancellation)  # it ends for nothing else
    finally:
        ended.set()


@pytest.mark.parametrize("engine", ["flag", "importance", "gather"])
def test_engines_that_blur_one_picture_are_previewed_in_their_time(
    progressive: ProgressiveRenderer, monkeypatch: pytest.MonkeyPatch, engine: str
) -> None:
    settings = replace(SETTINGS, engine=engine)
    request = PreviewRequest("/cam", 2.0, settings, is_moving=True, budget_ms=1e5)  # enough on a busy machine too
    sizes = [last(progressive.pictures(request)).graded.shape[1] for _ in range(2)]
    assert sizes == [107, 160], "sketched, and then whole"
    slow = PreviewRequest("/cam", 2.0, settings, is_moving=True, budget_ms=1e-3)
    assert last(progressive.pictures(slow)).graded.shape[1] == 107, "where there is no time, it stays a sketch"
