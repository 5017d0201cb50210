"""Undo is a property of the edit layer's history: whole states, one step for each thing that was done."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.model import edit_history
from render.model.edit_history import MAX_STATES, EditHistory, revision_of
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, NEAR, write_shot
from usd_schemas import FocusPoint

HERO = FocusPoint("hero", target=(NEAR,), face=0, barycentric=(1 / 3, 1 / 3, 1 / 3))


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def stop_of(shot):
    return shot.focus.read(CAMERA, 1).f_stop


def test_every_edit_is_a_step_that_can_be_taken_back_and_done_again(shot):
    states = [shot.edits.history.present.text]
    for edit in (
        lambda: shot.camera.set(CAMERA, f_stop=4.0),
        lambda: shot.focus.add_point(CAMERA, "hero", HERO),
        lambda: shot.focus.set_key(CAMERA, "hero", "weight", 1, 0.5),
        lambda: shot.focus.remove_point(CAMERA, "hero"),
    ):
        edit()
        states.append(shot.edits.export())
        assert shot.edits.history.present.text == shot.edits.export()
    for state in reversed(states[1:-1]):
        shot.edits.undo()
        assert shot.edits.export() == state
    shot.edits.undo()
    assert shot.edits.history.present.text == states[0] == ""
    assert shot.edits.layer.GetPrimAtPath(CAMERA) is None
    assert stop_of(shot) == 2.0
    for state in states[1:]:
        shot.edits.redo()
        assert shot.edits.export() == state


def test_steps_say_what_they_did(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    shot.focus.add_point(CAMERA, "hero", HERO)
    assert [state.label for state in shot.edits.history.states] == ["", "set f-number of cam", "add focus point hero"]
    shot.edits.undo()
    assert (shot.edits.history.undo_label, shot.edits.history.redo_label) == (
        "set f-number of cam",
        "add focus point hero",
    )


def test_there_is_an_end_in_both_directions(shot):
    for step, code in ((shot.edits.undo, "nothing_to_undo"), (shot.edits.redo, "nothing_to_redo")):
        with pytest.raises(InputError) as caught:
            step()
        assert caught.value.code == code


def test_an_edit_after_an_undo_ends_what_was_undone(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    shot.edits.undo()
    shot.camera.set(CAMERA, f_stop=8.0)
    with pytest.raises(InputError):
        shot.edits.redo()
    shot.edits.undo()
    assert stop_of(shot) == 2.0


def test_an_edit_that_changes_nothing_or_fails_is_no_step(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    before = shot.edits.history
    shot.camera.set(CAMERA, f_stop=4.0)
    with pytest.raises(SettingsError):
        shot.camera.set(CAMERA, f_stop=-4.0)
    with pytest.raises(SettingsError):
        _set_stop_and_focal_length(shot, 8.0, -1.0)
    assert shot.edits.history is before
    assert stop_of(shot) == 4.0


def _set_stop_and_focal_length(shot, f_stop, focal_length_mm):
    with shot.edits.transaction():
        shot.camera.set(CAMERA, f_stop=f_stop)
        shot.camera.set(CAMERA, focal_length_mm=focal_length_mm)


def test_edits_within_one_edit_are_one_step(shot):
    with shot.edits.transaction():
        shot.camera.set(CAMERA, f_stop=4.0)
        shot.focus.add_point(CAMERA, "hero", HERO)
    assert shot.edits.history.undo_label == "set f-number of cam, add focus point hero"
    shot.edits.undo()
    assert shot.edits.history.present.text == ""


def test_a_drag_is_one_step_and_a_drag_to_where_it_began_is_none(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    for stop in (5.0, 6.0, 7.0):
        with shot.edits.transaction(gesture="drag 1"):
            shot.camera.set(CAMERA, f_stop=stop)
    assert len(shot.edits.history.states) == 3
    with shot.edits.transaction(gesture="drag 2"):
        shot.camera.set(CAMERA, f_stop=9.0)
    shot.edits.undo()
    assert stop_of(shot) == 7.0
    shot.edits.undo()
    assert stop_of(shot) == 4.0
    for stop in (5.0, 4.0):
        with shot.edits.transaction(gesture="drag 3"):
            shot.camera.set(CAMERA, f_stop=stop)
    assert len(shot.edits.history.states) == 2


def test_replaced_edits_begin_a_history_unless_that_is_an_edit(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    text = shot.edits.export()
    with shot.edits.transaction("restore"):
        shot.edits.replace("")
    assert stop_of(shot) == 2.0
    assert shot.edits.history.undo_label == "restore"
    shot.edits.replace(text)
    assert stop_of(shot) == 4.0
    assert shot.edits.history.undo_label is None


def test_a_history_goes_on_from_the_layer_as_it_is_found(shot):
    for stop in (4.0, 5.0, 6.0):
        shot.camera.set(CAMERA, f_stop=stop)
    kept = shot.edits.history
    shot.edits.undo()
    shot.edits.resume(kept)
    assert shot.edits.history.redo_label is not None
    shot.edits.undo()
    assert stop_of(shot) == 4.0
    shot.edits.replace(kept.present.text.replace("fStop = 6", "fStop = 11"))
    shot.edits.resume(kept)
    assert shot.edits.history.undo_label == "edited elsewhere"
    assert stop_of(shot) == 11.0
    shot.edits.undo()
    assert stop_of(shot) == 6.0


def test_a_failed_edit_leaves_edits_and_history_unchanged(shot):
    shot.camera.set(CAMERA, f_stop=4.0)
    before = shot.edits.snapshot()
    shot.camera.set(CAMERA, f_stop=8.0)
    shot.edits.restore(before)
    assert stop_of(shot) == 4.0
    assert shot.edits.history == before.history


def test_the_oldest_states_go_first():
    history = EditHistory.beginning_with("")
    for number in range(MAX_STATES + 10):
        history = history.after(str(number), "count")
    assert len(history.states) == MAX_STATES
    assert history.present.text == str(MAX_STATES + 9)
    assert history.states[0].text == "10"


def test_the_text_of_all_states_is_bounded(monkeypatch):
    monkeypatch.setattr(edit_history, "MAX_HISTORY_BYTES", 1000)
    history = EditHistory.beginning_with("")
    for letter in "abcdef":
        history = history.after(300 * letter, "write")
    assert [state.text[0] for state in history.states] == ["d", "e", "f"]
    history = history.after(2000 * "g", "write")
    assert [state.text[0] for state in history.states] == ["g"], "the present one stays"


def test_edits_that_are_too_large_are_refused_and_change_nothing(shot, monkeypatch):
    shot.camera.set(CAMERA, f_stop=4.0)
    before = shot.edits.history
    monkeypatch.setattr(edit_history, "MAX_TEXT_BYTES", 10)
    with pytest.raises(InputError, match="the edits of the shot would take more than"):
        shot.camera.set(CAMERA, f_stop=8.0, focal_length_mm=35.0)
    assert (stop_of(shot), shot.edits.history) == (4.0, before)
    shot.camera.set(CAMERA, f_stop=2.0)
    assert stop_of(shot) == 2.0, "it is no larger than before"


STEPS = st.lists(st.sampled_from(["undo", "redo", "a", "b", "c", "d"]), max_size=40)


def taken(step, history, done, undone):
    """The history after a step, which the two stacks take too."""
    if step in ("undo", "redo"):
        source, target = (done, undone) if step == "undo" else (undone, done)
        if len(source) > (step == "undo"):
            target.append(source.pop())
            return history.undone() if step == "undo" else history.redone()
        with pytest.raises(InputError):
            history.undone() if step == "undo" else history.redone()
        return history
    if step != done[-1]:
        done.append(step)
        undone.clear()
    return history.after(step, step)


@given(STEPS)
def test_histories_are_walked_as_by_two_stacks(steps):
    history, done, undone = EditHistory.beginning_with(""), [""], []
    for step in steps:
        history = taken(step, history, done, undone)
        assert history.present.text == done[-1]
        assert history.find(revision_of(done[-1])).text == done[-1]
        assert [state.text for state in history.states] == done + undone[::-1]
