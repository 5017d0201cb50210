"""The edits of one opened shot as a whole: undone, done again, replaced, saved."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pxr import Sdf

from render.model.edit_history import EditHistory
from render.shot.edits.edit_layer import EditsSnapshot
from render.shot.view import ShotView

FOCUS_POINTS = "focusPoint:"
"""What the names of all properties of focus points begin with."""


class EditableShot(ShotView):
    """The part of `Shot` that knows the edit layer and its history, and not what an edit is about."""

    @property
    def edit_layer(self) -> Sdf.Layer:
        """The layer that all edits go to."""
        return self._edits.layer

    @contextmanager
    def one_edit(self, label: str = "", gesture: str = "") -> Iterator[None]:
        """Make all edits within one step: they are undone together, and an error takes all of them back.

        Args:
            label: what is done; empty takes what the edits within say.
            gesture: names the drag of a hand that the edit is part of: such edits, one after the other, are one step.
        """
        with self._edits.editing(label, gesture):
            yield

    def undo(self) -> None:
        """Take back the last edit.

        Raises:
            EndOfHistoryError: there is none.
        """
        self._edits.undo()

    def redo(self) -> None:
        """Do again the edit that was undone last.

        Raises:
            EndOfHistoryError: there is none.
        """
        self._edits.redo()

    @property
    def history(self) -> EditHistory:
        """The states that the edit layer has had since the shot was opened, or since `go_on_from`."""
        return self._edits.history

    def go_on_from(self, history: EditHistory) -> None:
        """Take over a history that was kept while the shot was not open; the edits stay what they are.

        Args:
            history: where it does not agree with the edits, these become its present state.
        """
        self._edits.history = history.agreeing_with(self._edits.state())

    def snapshot_edits(self) -> EditsSnapshot:
        """The edits and their history as they are, for `back_to`."""
        return self._edits.snapshot()

    def back_to(self, snapshot: EditsSnapshot) -> None:
        """Make the edits and their history what they were: for what failed after it was edited.

        Args:
            snapshot: as `snapshot_edits` gave it.
        """
        self._edits.back_to(snapshot)

    def replace_edits(self, text: str) -> None:
        """Put other edits in place of all there are. Their history begins here, unless this is part of `one_edit`.

        Args:
            text: of a usda layer, as `export_edits` gives it; empty for no edits.

        Raises:
            StageError: it is no usda; the edits there were stay.
        """
        self._edits.replace(text)

    def save_edits(self, path: Path) -> None:
        """Write the edit layer, as a whole or not at all.

        Args:
            path: of a .usda file; a file that the shot itself is made of is refused.

        Raises:
            SettingsError: it is not named .usda, or the shot is made of that file.
            OutputError: it cannot be written.
        """
        self._edits.save(path)

    def camera_edits(self, camera_path: str | None) -> tuple[str, ...]:
        """What is edited on a camera, its focus points aside: the same words as long as nobody changes that.

        Args:
            camera_path: of a camera.

        Raises:
            CameraError: there is no such camera.
        """
        prim = self._lens_camera(camera_path).prim.GetPath()
        return (str(prim), *self._edits.said_of(prim, lambda name: not name.startswith(FOCUS_POINTS)))

    def point_edits(self, camera_path: str | None, name: str | None = None) -> tuple[str, ...]:
        """What is edited on focus points: the same words as long as nobody changes that.

        Args:
            camera_path: of a camera.
            name: of a focus point; None for all of them, and which there are.

        Raises:
            CameraError: there is no such camera.
            NotFoundError: it has no such point.
        """
        prim = self._lens_camera(camera_path).prim.GetPath()
        if name is None:
            names = [view.name for view in self._lens_camera(camera_path).focus_points()]
            return (str(prim), *names, *self._edits.said_of(prim, lambda name: name.startswith(FOCUS_POINTS)))
        prefix = f"{FOCUS_POINTS}{self._point(camera_path, name).name}:"
        return (str(prim), name, *self._edits.said_of(prim, lambda name: name.startswith(prefix)))
