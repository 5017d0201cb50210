"""Undo is a property of the edit layer's history: whole states, one step for each thing that was done."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.model.edit_history import MAX_STATES, EditHistory, revision_of
from render.shot import Shot
from tests.render.kits.focus_shot import CAMERA, NEAR, write_shot
from usd_schemas import FocusPoint

HERO = FocusPoint("hero", target=(NEAR,), face=0, barycentric=(1 / 3, 1 / 3, 1 / 3))


@pytest.fixture
def shot(tmp_path):
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def stop_of(shot):
    return shot.readout(CAMERA, 1).f_stop


def test_every_edit_is_a_step_that_can_be_taken_back_and_done_again(shot):
    states = [shot.history.present.text]
    for edit in (
        lambda: shot.set_camera(CAMERA, f_stop=4.0),
        lambda: shot.add_focus_point(CAMERA, "hero", HERO),
        lambda: shot.set_key(CAMERA, "hero", "weight", 1, 0.5),
        lambda: shot.remove_focus_point(CAMERA, "hero"),
    ):
        edit()
        states.append(shot.export_edits())
        assert shot.history.present.text == shot.export_edits()
    for state in reversed(states[1:-1]):
        shot.undo()
        assert shot.export_edits() == state
    shot.undo()
    assert shot.history.present.text == states[0] == ""
    assert shot.edit_layer.GetPrimAtPath(CAMERA) is None
    assert stop_of(shot) == 2.0
    for state in states[1:]:
        shot.redo()
        assert shot.export_edits() == state


def test_steps_say_what_they_did(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    shot.add_focus_point(CAMERA, "hero", HERO)
    assert [state.label for state in shot.history.states] == ["", "set f-number of cam", "add focus point hero"]
    shot.undo()
    assert (shot.history.undo_label, shot.history.redo_label) == ("set f-number of cam", "add focus point hero")


def test_there_is_an_end_in_both_directions(shot):
    for step, code in ((shot.undo, "nothing_to_undo"), (shot.redo, "nothing_to_redo")):
        with pytest.raises(InputError) as caught:
            step()
        assert caught.value.code == code


def test_an_edit_after_an_undo_ends_what_was_undone(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    shot.undo()
    shot.set_camera(CAMERA, f_stop=8.0)
    with pytest.raises(InputError):
        shot.redo()
    shot.undo()
    assert stop_of(shot) == 2.0


def test_an_edit_that_changes_nothing_or_fails_is_no_step(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    before = shot.history
    shot.set_camera(CAMERA, f_stop=4.0)
    with pytest.raises(SettingsError):
        shot.set_camera(CAMERA, f_stop=-4.0)
    with pytest.raises(SettingsError):
        _set_stop_and_focal_length(shot, 8.0, -1.0)
    assert shot.history is before
    assert stop_of(shot) == 4.0


def _set_stop_and_focal_length(shot, f_stop, focal_length_mm):
    with shot.one_edit():
        shot.set_camera(CAMERA, f_stop=f_stop)
        shot.set_camera(CAMERA, focal_length_mm=focal_length_mm)


def test_edits_within_one_edit_are_one_step(shot):
    with shot.one_edit():
        shot.set_camera(CAMERA, f_stop=4.0)
        shot.add_focus_point(CAMERA, "hero", HERO)
    assert shot.history.undo_label == "set f-number of cam, add focus point hero"
    shot.undo()
    assert shot.history.present.text == ""


def test_a_drag_is_one_step_and_a_drag_to_where_it_began_is_none(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    for stop in (5.0, 6.0, 7.0):
        with shot.one_edit(gesture="drag 1"):
            shot.set_camera(CAMERA, f_stop=stop)
    assert len(shot.history.states) == 3
    with shot.one_edit(gesture="drag 2"):
        shot.set_camera(CAMERA, f_stop=9.0)
    shot.undo()
    assert stop_of(shot) == 7.0
    shot.undo()
    assert stop_of(shot) == 4.0
    for stop in (5.0, 4.0):
        with shot.one_edit(gesture="drag 3"):
            shot.set_camera(CAMERA, f_stop=stop)
    assert len(shot.history.states) == 2


def test_replaced_edits_begin_a_history_unless_that_is_an_edit(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    text = shot.export_edits()
    with shot.one_edit("restore"):
        shot.replace_edits("")
    assert stop_of(shot) == 2.0
    assert shot.history.undo_label == "restore"
    shot.replace_edits(text)
    assert stop_of(shot) == 4.0
    assert shot.history.undo_label is None


def test_a_history_goes_on_from_the_layer_as_it_is_found(shot):
    for stop in (4.0, 5.0, 6.0):
        shot.set_camera(CAMERA, f_stop=stop)
    kept = shot.history
    shot.undo()
    shot.go_on_from(kept)
    assert shot.history.redo_label is not None
    shot.undo()
    assert stop_of(shot) == 4.0
    shot.replace_edits(kept.present.text.replace("fStop = 6", "fStop = 11"))
    shot.go_on_from(kept)
    assert shot.history.undo_label == "edited elsewhere"
    assert stop_of(shot) == 11.0
    shot.undo()
    assert stop_of(shot) == 6.0


def test_what_failed_after_an_edit_leaves_edits_and_history_as_they_were(shot):
    shot.set_camera(CAMERA, f_stop=4.0)
    before = shot.snapshot_edits()
    shot.set_camera(CAMERA, f_stop=8.0)
    shot.back_to(before)
    assert stop_of(shot) == 4.0
    assert shot.history == before.history


def test_the_oldest_states_go_first():
    history = EditHistory.beginning_with("")
    for number in range(MAX_STATES + 10):
        history = history.after(str(number), "count")
    assert len(history.states) == MAX_STATES
    assert history.present.text == str(MAX_STATES + 9)
    assert history.states[0].text == "10"


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
