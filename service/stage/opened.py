"""The shot that a worker process holds open between calls; state of the stage workers."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Concatenate, ParamSpec, TypeVar

from pxr import Work

from render.errors import NotFoundError, PullfocusError
from render.model.edit_history import EditHistory, revision_of
from render.shot import Shot
from render.shot.edits.edit_layer import EditsSnapshot
from render.stage.faults import faults_of_stage
from render.steps import step
from service.edit_context import ANY_CONTEXT, EditContext
from service.storage.edit_files import clear_unfinished, load_history, save_edits
from service.storage.store import ShotRecord
from service.workers.calls import register

log = logging.getLogger("pullfocus.service")

Arguments = ParamSpec("Arguments")
Reply = TypeVar("Reply")


@register
class OpenedShot:
    """The one shot that a worker process holds open. A worker sees the files of no other (see `service.workers.places`)."""

    def __init__(self) -> None:
        Work.SetMaximumConcurrencyLimit()  # threads of USD that start from here on are in the worker's sandbox
        self._shot: Shot | None = None

    @contextmanager
    def use(self, record: ShotRecord, edit_text: str | None = None) -> Iterator[Shot]:
        """Open a shot, or return the open one. Errors name files by their path in the upload, not on this machine.

        Args:
            record: the shot.
            edit_text: its edit layer, empty for no edits; None keeps the present one, or loads the saved one.

        Raises:
            NotFoundError: the shot was removed.
            StageError: the shot is no stage, or refers to files that were not sent with it.
        """
        try:
            with faults_of_stage(record.root_path.name):
                shot = self._get(record, load_edits=edit_text is None)
                if edit_text is not None and edit_text != shot.edits.history.present.text:
                    shot.edits.replace(edit_text)
                yield shot
        except PullfocusError as error:
            if type(error.__cause__) is RuntimeError:  # of USD, or a fault of this program
                log.warning("while shot %s was read:", record.id, exc_info=error.__cause__)
            raise _error_as_sent(error, record) from error

    @contextmanager
    def edit(self, record: ShotRecord, context: EditContext = ANY_CONTEXT, label: str = "") -> Iterator[Shot]:
        """Edit a shot in one step of its history. The edit is saved at the end, or undone where it fails.

        Args:
            record: the shot.
            context: its gesture is used; the caller checks its tag.
            label: label of the step; empty derives it from the edits.
        """
        with self.change(record) as shot, shot.edits.transaction(label, context.gesture):
            yield shot

    @contextmanager
    def change(self, record: ShotRecord) -> Iterator[Shot]:
        """Edit a shot, or undo and redo its edits. The change is saved at the end, or undone where it fails.

        Args:
            record: the shot.
        """
        with self.use(record) as shot:
            before = shot.edits.snapshot()
            try:
                yield shot
                if shot.edits.history != before.history:
                    save_edits(record.edits_folder, shot.edits.history, before.history)
            except BaseException:
                self._take_back(record, shot, before)
                raise

    def _take_back(self, record: ShotRecord, shot: Shot, before: EditsSnapshot) -> None:
        """Undo an edit that failed. Where it may have been saved for all that, the shot is read from the disk at its next use."""
        if shot.edits.history == before.history:
            return
        shot.edits.restore(before)
        try:
            is_saved = revision_of(record.edit_text()) != before.history.present.revision
        except PullfocusError:
            is_saved = True
        if is_saved:
            self._shot = None

    def _get(self, record: ShotRecord, *, load_edits: bool) -> Shot:
        if self._shot is None:
            if not record.root_path.is_file():
                raise NotFoundError(f"There is no shot {record.id!r} any more.", code="shot_not_found", path=record.id)
            edits = record.edits if load_edits and record.edits.is_file() else None
            with step("open shot"):
                shot = Shot.open(record.root_path, confined_to=record.files, edits=edits)
            kept = _load_history(record) if load_edits else None  # a picture worker may not read it
            if kept is not None:
                shot.edits.resume(kept)
            self._shot = shot
        return self._shot


def stage_function(
    function: Callable[Concatenate[OpenedShot, Arguments], Reply],
) -> Callable[Concatenate[OpenedShot, Arguments], Reply]:
    """Register a function that the HTTP process may call in the stage process (see `service.workers.calls`)."""
    return register(function)


@stage_function
def warm_up(opened: OpenedShot) -> None:
    """Do nothing: an answer shows that a worker has started."""


def _load_history(record: ShotRecord) -> EditHistory | None:
    with suppress(OSError):  # a worker that opens an upload may not write, and there is nothing
        clear_unfinished(record.edits_folder)
    return load_history(record.edits_folder)


def as_sent(text: str, record: ShotRecord) -> str:
    """Replace absolute paths in a text by paths relative to the upload, which hides the layout of this machine."""
    folders = record.files, record.edits_folder, record.folder  # the upload, and where its edits are kept
    for folder in (*folders, *(folder.resolve() for folder in folders)):
        text = text.replace(f"{folder}/", "").replace(str(folder), "the shot's folder")
    return text


def _error_as_sent(error: PullfocusError, record: ShotRecord) -> PullfocusError:
    path = as_sent(error.path, record) if error.path else None
    return type(error)(as_sent(error.detail, record), code=error.code, path=path)
