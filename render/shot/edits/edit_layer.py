"""The one layer that edits go to. The shot's own files are never written.

The layer is the strongest sublayer of the stage's session layer, so it overrides all opinions of the shot, and it can be
saved, downloaded and sublayered over the shot.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, Usd

from render.errors import SettingsError, StageError
from render.files import write_atomic
from render.model.edit_history import EditHistory, check_size
from render.shot.edits.shot_files import check_not_own
from render.stage import quiet_diagnostics
from usd_schemas import SchemaError, keys
from usd_schemas.values import usd_value

MAX_LABELS = 4
"""Labels in that of a step which joins several."""


@dataclass(frozen=True)
class EditsSnapshot:
    """Edits at one moment, for `Edits.restore`.

    Attributes:
        text: the state of the layer.
        history: of the layer.
    """

    text: str
    history: EditHistory


class Edits:
    """The edit layer of one opened stage, and the states that it has had.

    Attributes:
        layer: the anonymous layer that holds the edits.
        path: of the saved edits that it started from, or None.
        revision: counts the edits, so that results from before an edit are known to be outdated.
        history: the states of the layer; its present one is the layer as it is now.
    """

    def __init__(self, path: Path | None = None) -> None:
        """Start without edits, or with a copy of saved ones.

        Args:
            path: a layer that `save` wrote.

        Raises:
            StageError: the layer is missing or damaged.
        """
        self.layer = Sdf.Layer.CreateAnonymous("edits.usda")
        self.path = path
        self.revision = 0
        self._stage: Usd.Stage | None = None
        self._labels: list[str] | None = None  # of the transactions within the one in progress
        if path is not None:
            self.layer.TransferContent(_read_layer(path))
        self.history = EditHistory.beginning_with(self.state())

    def attach(self, stage: Usd.Stage) -> None:
        """Set the stage that is edited.

        A new layer takes over the stage's time codes per second, as USD retimes a sublayer that has others.

        Args:
            stage: opened with `layer` among its session layer's sublayers.
        """
        self._stage = stage
        if self.layer.empty:
            self._begin_layer(self.layer)

    @contextmanager
    def transaction(self, label: str = "", gesture: str = "") -> Iterator[None]:
        """Direct what USD authors to the edit layer as one step of the history; an error reverts all of it.

        Transactions within a transaction are part of its step.

        Args:
            label: of the step; empty joins the labels of the transactions within.
            gesture: names the drag that the edit is part of; consecutive edits of one gesture are one step.

        Raises:
            SettingsError: in place of a `SchemaError`: a value, a name or a time is not allowed.
            InputError: the edits are larger than `MAX_TEXT_BYTES`.
        """
        outer, self._labels = self._labels, []
        text = ""
        try:
            with self._authoring():
                yield
                if outer is None:
                    text = self.state()
                    check_size(text, self.history.present.size_bytes)
            label = label or _join_labels(self._labels) or "edit"
        finally:
            self._labels = outer
        if outer is None:
            self.history = self.history.after(text, label, gesture)
        else:
            outer.append(label)

    @contextmanager
    def _authoring(self) -> Iterator[None]:
        stage = self._attached()
        before = Sdf.Layer.CreateAnonymous("before.usda")
        before.TransferContent(self.layer)
        self.revision += 1
        try:
            target = stage.GetEditTargetForLocalLayer(self.layer)
            with schema_errors_as_settings(), quiet_diagnostics(), Usd.EditContext(stage, target):
                yield
        except BaseException:
            self.revision += 1  # results from within the failed edit are outdated too
            self.layer.TransferContent(before)
            raise

    def replace(self, text: str) -> None:
        """Replace all edits. Outside of a transaction, a new history begins.

        Args:
            text: of a usda layer, as `state` gives it; empty for no edits.

        Raises:
            StageError: the text is no usda; the edits stay as they were.
        """
        if text != self.state():
            other = Sdf.Layer.CreateAnonymous("other.usda")
            if text:
                _import(other, text)
            else:
                self._begin_layer(other)
            self.revision += 1
            self.layer.TransferContent(other)
        if self._labels is None:
            self.history = EditHistory.beginning_with(self.state())

    def undo(self) -> None:
        """Undo the last step.

        Raises:
            EndOfHistoryError: there is no such step.
        """
        self._show(self.history.undone())

    def redo(self) -> None:
        """Redo the step that was undone last.

        Raises:
            EndOfHistoryError: there is no such step.
        """
        self._show(self.history.redone())

    def snapshot(self) -> EditsSnapshot:
        """The edits and their history as they are, for `restore`."""
        return EditsSnapshot(self.state(), self.history)

    def restore(self, snapshot: EditsSnapshot) -> None:
        """Restore edits and history.

        Args:
            snapshot: from `snapshot`.
        """
        self.replace(snapshot.text)
        self.history = snapshot.history

    def resume(self, history: EditHistory) -> None:
        """Continue a history that was stored while the shot was closed; the edits stay as they are.

        Args:
            history: where its present state differs from the edits, these become a new state.
        """
        self.history = history.agreeing_with(self.state())

    def state(self) -> str:
        """The edit layer as usda text; empty where it has no opinions."""
        return self.export() if self.layer.rootPrims or self.layer.subLayerPaths else ""

    def export(self) -> str:
        """The edit layer as usda text."""
        with quiet_diagnostics():
            return str(self.layer.ExportToString())

    def save(self, path: Path) -> None:
        """Write the edit layer as a whole, or not at all.

        Args:
            path: of a .usda file; a file that the shot itself is made of is refused.

        Raises:
            SettingsError: it is not named .usda, or the shot is made of that file.
            OutputError: it cannot be written.
        """
        if path.suffix != ".usda":
            raise SettingsError(f"edits are saved as a .usda file, not as {path}", path=str(path))
        check_not_own(self._attached(), path)
        write_atomic(path, self.export().encode())

    def properties(self, prim_path: Sdf.Path, is_included: Callable[[str], bool]) -> tuple[str, ...]:
        """Edited properties of a prim as usda text, in order of their names.

        Args:
            prim_path: of the prim.
            is_included: whether a property of that name is returned.
        """
        spec = self.layer.GetPrimAtPath(prim_path)
        properties = sorted((spec.properties if spec else ()), key=lambda prop: str(prop.name))
        return tuple(prop.GetAsText() for prop in properties if is_included(prop.name))

    def clear_properties(self, prim_path: Sdf.Path, is_cleared: Callable[[str], bool]) -> None:
        """Take edits of properties of a prim back, within a transaction: the shot's own values are there again.

        Args:
            prim_path: of the prim.
            is_cleared: whether the property of that name is.
        """
        spec = self.layer.GetPrimAtPath(prim_path)
        for prop in list(spec.properties) if spec else ():
            if is_cleared(str(prop.name)):
                spec.RemoveProperty(prop)
        while spec and spec.isInert:
            above, name = spec.nameParent, spec.name
            del (above.nameChildren if above else self.layer.rootPrims)[name]
            spec = above

    def _show(self, history: EditHistory) -> None:
        self.replace(history.present.text)
        self.history = history

    def _begin_layer(self, layer: Sdf.Layer) -> None:
        # This may compose the stage anew, which would repeat USD's warnings about it on the terminal.
        with quiet_diagnostics():
            layer.timeCodesPerSecond = self._attached().GetTimeCodesPerSecond()
        layer.comment = "Edits made in Pullfocus: sublayer this over the shot."

    def _attached(self) -> Usd.Stage:
        if self._stage is None:
            raise RuntimeError("Edits.attach must be called before the first edit")
        return self._stage


def _join_labels(labels: Sequence[str]) -> str:
    """Join the different labels of a step's transactions; of many, the first few."""
    different = list(dict.fromkeys(labels))
    more = len(different) - MAX_LABELS
    return ", ".join(different[:MAX_LABELS]) + (f" and {more} more" if more > 0 else "")


@contextmanager
def schema_errors_as_settings() -> Iterator[None]:
    """Translate schema errors: a value, a name or a time is not allowed.

    Raises:
        SettingsError: in place of a `SchemaError`.
    """
    try:
        yield
    except SchemaError as error:
        raise SettingsError(str(error), code="bad_value") from error


def set_value(attribute: Usd.Attribute, value: Any, time: float | None) -> None:
    """Give an attribute a value for all time, or a key at one time, in the stage's edit target.

    Args:
        attribute: the attribute.
        value: in the attribute's own unit.
        time: USD time code of the key; None drops the keys there are and holds the value for all time.

    Raises:
        SchemaError: the value or the time is not allowed.
    """
    if time is not None:
        keys.set_key(attribute, time, value, keys.following_interpolation(attribute, time))
        return
    checked = usd_value(attribute, value)
    attribute.Clear()
    attribute.Set(checked)


def _import(layer: Sdf.Layer, text: str) -> None:
    try:
        read = layer.ImportFromString(text)
    except Tf.ErrorException:
        read = False
    if not read:
        raise StageError("the given edits are no readable USD layer", code="bad_edits")


def _read_layer(path: Path) -> Sdf.Layer:
    if not path.is_file():
        raise StageError(f"there is no layer of saved edits at {path}", code="missing_edits", path=str(path))
    try:
        layer = Sdf.Layer.OpenAsAnonymous(str(path))
    except Tf.ErrorException:
        layer = None
    if layer is None:
        raise StageError(f"the saved edits at {path} are no readable USD layer", code="bad_edits", path=str(path))
    return layer
