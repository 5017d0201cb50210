"""The one layer that edits go to. Nobody's own file is ever written.

The layer is the strongest sublayer of the stage's session layer, so it wins over all that the shot says, and it can be
saved, downloaded and sublayered over the shot by anyone.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, Usd

from render.errors import SettingsError, StageError
from render.files import write_atomic
from render.shot.own_files import check_not_own
from render.stage import quiet_diagnostics
from usd_schemas import SchemaError, keys
from usd_schemas.values import usd_value


class Edits:
    """The edit layer of one opened stage.

    Attributes:
        layer: the anonymous layer that holds the edits.
        path: of the saved edits that it started from, or None.
        revision: counts the edits, so that what was found before one is known to be old.
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
        if path is not None:
            self.layer.TransferContent(_read_layer(path))

    def attach(self, stage: Usd.Stage) -> None:
        """Say which stage is edited.

        A new layer takes over the stage's time codes per second, as USD retimes a sublayer that says otherwise.

        Args:
            stage: opened with `layer` among its session layer's sublayers.
        """
        self._stage = stage
        if self.layer.empty:
            # This composes the stage anew, which would repeat USD's warnings about it on the terminal.
            with quiet_diagnostics():
                self.layer.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
            self.layer.comment = "Edits made in Pullfocus: sublayer this over the shot."

    @contextmanager
    def editing(self) -> Iterator[None]:
        """Direct what USD authors to the edit layer; if an error comes out, take back all that was authored.

        Raises:
            SettingsError: in place of a `SchemaError`: what was to be authored is not allowed.
        """
        stage = self._attached()
        before = Sdf.Layer.CreateAnonymous("before.usda")
        before.TransferContent(self.layer)
        self.revision += 1
        try:
            target = stage.GetEditTargetForLocalLayer(self.layer)
            with schema_errors_as_settings(), quiet_diagnostics(), Usd.EditContext(stage, target):
                yield
        except BaseException:
            self.layer.TransferContent(before)
            raise

    def replace(self, text: str) -> None:
        """Put other edits in place of all there are.

        Args:
            text: of a usda layer, as `export` gives it.

        Raises:
            StageError: it is no usda; the edits there were stay.
        """
        if text == self.export():
            return
        other = Sdf.Layer.CreateAnonymous("other.usda")
        try:
            read = other.ImportFromString(text)
        except Tf.ErrorException:
            read = False
        if not read:
            raise StageError("the given edits are no readable USD layer", code="bad_edits")
        self.revision += 1
        self.layer.TransferContent(other)

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

    def _attached(self) -> Usd.Stage:
        if self._stage is None:
            raise RuntimeError("Edits.attach must say which stage is edited before anything is")
        return self._stage


@contextmanager
def schema_errors_as_settings() -> Iterator[None]:
    """Say in this package's own error that a value, a name or a time is not allowed.

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
        attribute: what to set.
        value: in the attribute's own unit.
        time: USD time code of the key; None drops the keys there and holds the value for all time.

    Raises:
        SchemaError: the value or the time is not allowed.
    """
    if time is not None:
        keys.set_key(attribute, time, value, keys.following_interpolation(attribute, time))
        return
    checked = usd_value(attribute, value)
    attribute.Clear()
    attribute.Set(checked)


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
