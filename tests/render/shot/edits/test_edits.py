"""Edits are a layer over the shot: theirs alone, whole or not at all, and good for any USD tool."""

import pytest
from pxr import Sdf, Usd

from render.errors import CameraError, NotFoundError, OutputError, SettingsError, StageError
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, NEAR, Units, open_bare, write_shot
from usd_schemas import FocusPoint

HERO = FocusPoint("hero", target=(NEAR,), face=0, barycentric=(1 / 3, 1 / 3, 1 / 3))


@pytest.fixture
def path(tmp_path):
    return write_shot(tmp_path / "shot.usda")


@pytest.fixture
def shot(path):
    return Shot.open(path)


def test_no_file_of_the_users_is_written(path, shot):
    before = path.read_bytes()
    shot.focus.add_point(CAMERA, "hero", HERO)
    shot.focus.set_key(CAMERA, "hero", "weight", 1, 0.5)
    shot.camera.set(CAMERA, f_stop=4.0, time=3)
    shot.focus.update_point(CAMERA, "hero", blur=0.1, kind="soft")
    assert not shot.stage.GetRootLayer().dirty
    assert shot.stage.GetSessionLayer().GetPrimAtPath(CAMERA) is None
    assert shot.edits.layer.GetPrimAtPath(CAMERA) is not None
    assert path.read_bytes() == before
    assert [p.name for p in path.parent.iterdir()] == ["shot.usda"]


@pytest.mark.parametrize("per_second", [24.0, 25.0, 48.0, 1000.0])
def test_saved_edits_are_a_sublayer_for_any_usd_tool(tmp_path, per_second):
    path = write_shot(tmp_path / "shot.usda", Units(per_second=per_second))
    shot = Shot.open(path)
    shot.camera.set(CAMERA, f_stop=4.0, time=10)
    shot.camera.set(CAMERA, f_stop=8.0, time=20)
    shot.focus.add_point(CAMERA, "hero", HERO)
    shot.edits.save(tmp_path / "edits.usda")
    (tmp_path / "over.usda").write_text(
        f"#usda 1.0\n(\n timeCodesPerSecond = {per_second}\n subLayers = [@./edits.usda@, @./shot.usda@]\n)\n"
    )
    stage = Usd.Stage.Open(str(tmp_path / "over.usda"))
    camera = stage.GetPrimAtPath(CAMERA)
    assert [camera.GetAttribute("fStop").Get(t) for t in (10, 20)] == [4.0, 8.0]
    assert camera.GetAttribute("fStop").Get(15) == pytest.approx(6.0)
    assert camera.GetAttribute("focus:mode").Get() == "points"
    assert camera.GetRelationship("focusPoint:hero:target").GetTargets() == [Sdf.Path(NEAR)]


def test_edits_go_on_where_they_were_saved(tmp_path, path, shot):
    shot.focus.add_point(CAMERA, "hero", HERO)
    shot.focus.set_key(CAMERA, "hero", "weight", 1, 0.25)
    saved = tmp_path / "edits.usda"
    shot.edits.save(saved)
    text = saved.read_text()
    again = Shot.open(path, edits=saved)
    assert [p.point.weight for p in again.focus.points(CAMERA, 1)] == [0.25]
    assert again.edits.export() == shot.edits.export()
    again.focus.remove_point(CAMERA, "hero")
    assert saved.read_text() == text, "the saved layer is copied, not written to"


def test_edits_can_be_replaced_by_text_and_bad_text_changes_nothing(path, shot):
    shot.focus.add_point(CAMERA, "hero", HERO)
    other = Shot.open(path)
    other.edits.replace(shot.edits.export())
    assert [p.point.name for p in other.focus.points(CAMERA, 1)] == ["hero"]
    for bad in (" ", "#usda 1.0\ndef {", "nonsense"):
        with pytest.raises(StageError, match="readable"):
            other.edits.replace(bad)
    assert other.edits.export() == shot.edits.export()


def test_saved_edits_that_are_missing_or_damaged_are_named(tmp_path, path):
    with pytest.raises(StageError, match=r"none\.usda") as caught:
        Shot.open(path, edits=tmp_path / "none.usda")
    assert caught.value.code == "missing_edits"
    (tmp_path / "bad.usda").write_text("#usda 1.0\nover {")
    with pytest.raises(StageError, match=r"bad\.usda"):
        Shot.open(path, edits=tmp_path / "bad.usda")


def test_the_shots_own_files_are_never_saved_over(path, shot):
    before = path.read_bytes()
    with pytest.raises(SettingsError, match="the shot itself"):
        shot.edits.save(path)
    with pytest.raises(SettingsError, match=r"\.usda"):
        shot.edits.save(path.with_suffix(".txt"))
    with pytest.raises(OutputError, match="folder"):
        shot.edits.save(path.parent / "nowhere" / "edits.usda")
    assert path.read_bytes() == before


def test_a_failed_edit_leaves_all_as_it_was(shot):
    shot.focus.add_point(CAMERA, "hero", HERO)
    before = shot.edits.export()
    attempts = [
        lambda: shot.focus.update_point(CAMERA, "hero", weight=0.5, blur=-1.0),
        lambda: shot.focus.update_point(CAMERA, "hero", weight=0.5, target=("not a path",)),
        lambda: shot.focus.update_point(CAMERA, "hero", colour="red"),
        lambda: shot.camera.set(CAMERA, f_stop=4.0, focal_length_mm=-50.0),
        lambda: shot.camera.set(CAMERA, f_stop=4.0, focus_mode="by feel"),
        lambda: shot.camera.set(CAMERA, f_stop=4.0, focal_length_mm=35.0, time=float("nan")),
        lambda: shot.focus.add_point(CAMERA, "other", FocusPoint("other", target=(NEAR,), weight=-1.0)),
    ]
    for attempt in attempts:
        with pytest.raises(SettingsError):
            attempt()
        assert shot.edits.export() == before


def test_a_key_over_the_shots_own_keys_keeps_the_others(tmp_path, path):
    stage = open_bare(path)
    attribute = stage.GetPrimAtPath(CAMERA).GetAttribute("fStop")
    for time, value in ((1, 2.0), (24, 4.0)):
        attribute.Set(value, time)
    stage.GetRootLayer().Export(str(tmp_path / "keyed.usda"))
    shot = Shot.open(tmp_path / "keyed.usda")
    shot.camera.set(CAMERA, f_stop=8.0, time=12)
    assert [shot.focus.read(CAMERA, t).f_stop for t in (1, 12, 24)] == [2.0, 8.0, 4.0]
    shot.camera.set(CAMERA, f_stop=5.6)
    assert [shot.focus.read(CAMERA, t).f_stop for t in (1, 12, 24)] == pytest.approx([5.6] * 3)


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"focal_length_mm": -50.0}, "focal length"),
        ({"focal_length_mm": 0.0}, "focal length"),
        ({"focal_length_mm": float("nan")}, "focal length"),
        ({"f_stop": -1.0}, "f-number"),
        ({"f_stop": float("inf")}, "f-number"),
        ({"focus_distance_m": -2.0}, "focus distance"),
        ({"focus_distance_m": float("nan")}, "focus distance"),
        ({"focus_mode": "by feel"}, "focus:mode"),
        ({"f_stop": 4.0, "time": float("inf")}, "time"),
    ],
)
def test_impossible_lens_settings_are_named(shot, changes, named):
    with pytest.raises(SettingsError, match=named):
        shot.camera.set(CAMERA, **changes)


@pytest.mark.parametrize("name", ["", "1st", "my point", "a:b", "a/b", "héro!", "../up", "target" * 2 + "-"])
def test_illegal_names_are_refused_with_the_legal_form(shot, name):
    with pytest.raises(SettingsError, match="identifier"):
        shot.focus.add_point(CAMERA, name, HERO)


def test_a_name_is_given_once(shot):
    shot.focus.add_point(CAMERA, "hero", HERO)
    with pytest.raises(SettingsError, match="already has a focus point named 'hero'") as caught:
        shot.focus.add_point(CAMERA, "hero", HERO)
    assert caught.value.code == "name_taken"
    shot.focus.remove_point(CAMERA, "hero")
    shot.focus.add_point(CAMERA, "hero", HERO)


def test_unknown_focus_points_keys_and_attributes_are_named(shot):
    shot.focus.add_point(CAMERA, "hero", HERO)
    for attempt in (
        lambda: shot.focus.update_point(CAMERA, "villain", weight=1.0),
        lambda: shot.focus.remove_point(CAMERA, "villain"),
        lambda: shot.focus.set_key(CAMERA, "villain", "weight", 1, 1.0),
        lambda: shot.focus.remove_key(CAMERA, "villain", "weight", 1),
        lambda: shot.focus.keys(CAMERA, "villain", "weight"),
    ):
        with pytest.raises(NotFoundError, match="no focus point named 'villain', it has: hero"):
            attempt()
    with pytest.raises(NotFoundError, match="no key at time 7"):
        shot.focus.remove_key(CAMERA, "hero", "weight", 7)
    with pytest.raises(SettingsError, match="colour"):
        shot.focus.set_key(CAMERA, "hero", "colour", 1, 1.0)


@pytest.mark.parametrize(
    ("attribute", "time", "value", "named"),
    [
        ("weight", float("nan"), 1.0, "time"),
        ("weight", 1, float("nan"), "weight"),
        ("weight", 1, -1.0, "weight"),
        ("weight", 1, "much", "weight"),
        ("enabled", 1, 2.0, "enabled"),
        ("kind", 1, "soft", "kind"),
    ],
)
def test_impossible_keys_are_named(shot, attribute, time, value, named):
    shot.focus.add_point(CAMERA, "hero", HERO)
    with pytest.raises(SettingsError, match=named):
        shot.focus.set_key(CAMERA, "hero", attribute, time, value)


@pytest.mark.parametrize("camera", ["/World/nothing", NEAR, "not a path", ""])
def test_a_camera_path_that_is_no_camera_is_named(shot, camera):
    for attempt in (
        lambda: shot.camera_at(camera, 1, 16, 9),
        lambda: shot.focus.read(camera, 1),
        lambda: shot.focus.points(camera, 1),
        lambda: shot.focus.add_point(camera, "hero", HERO),
        lambda: shot.camera.set(camera, f_stop=2.0),
        lambda: shot.focus.curve(camera, [1, 2]),
    ):
        with pytest.raises(CameraError):
            attempt()


def test_what_is_edited_on_a_camera_leaves_the_scene_as_it_was_read(shot):
    before = shot.scene_at(1)
    shot.camera.set(CAMERA, f_stop=4.0)  # the first edit of all, which adds the prims that hold it
    edited = shot.edits.history.present.text
    for text in ("", edited, ""):
        shot.edits.replace(text)
    assert shot.scene_at(1) is before


def test_a_camera_with_impossible_numbers_can_be_mended(tmp_path):
    path = write_shot(tmp_path / "shot.usda")
    stage = open_bare(path)
    stage.GetPrimAtPath(CAMERA).GetAttribute("focalLength").Set(-50.0)
    stage.GetRootLayer().Export(str(tmp_path / "broken.usda"))
    shot = Shot.open(tmp_path / "broken.usda")
    with pytest.raises(CameraError, match="focalLength"):
        shot.focus.read(CAMERA, 1)
    shot.camera.set(CAMERA, focal_length_mm=35.0)
    assert shot.focus.read(CAMERA, 1).focal_length_mm == pytest.approx(35.0)


def test_a_camera_in_an_instance_can_be_looked_through_but_not_edited(tmp_path):
    write_shot(tmp_path / "shot.usda")
    (tmp_path / "twice.usda").write_text(
        '#usda 1.0\n(\n metersPerUnit = 1\n upAxis = "Y"\n)\n'
        'def "copy" (\n instanceable = true\n references = @./shot.usda@\n)\n{\n}\n'
    )
    shot = Shot.open(tmp_path / "twice.usda")
    assert shot.focus.read("/copy/cam", 1).focus_distance_m == pytest.approx(3.0)
    for attempt in (
        lambda: shot.camera.set("/copy/cam", f_stop=4.0),
        lambda: shot.focus.add_point("/copy/cam", "hero", HERO),
    ):
        with pytest.raises(CameraError, match="instance"):
            attempt()
