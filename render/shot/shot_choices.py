"""Variants and payloads of a shot, chosen in its edit layer."""

from __future__ import annotations

from pxr import Usd

from render.shot.edits.edit_layer import Edits
from render.stage.choices import StageChoices, choose_variant, list_choices, show_payload


class ShotChoices:
    """Choices that a shot's stage leaves open. A choice is an edit, and changes what the stage is made of.

    Args:
        stage: the composed stage.
        edits: its edit layer.
    """

    def __init__(self, stage: Usd.Stage, edits: Edits) -> None:
        self._stage = stage
        self._edits = edits

    def read(self) -> StageChoices:
        """List the choices."""
        return list_choices(self._stage, self._edits.layer)

    def choose_variant(self, prim: str, name: str, variant: str | None) -> None:
        """Choose a variant.

        Args:
            prim: prim path.
            name: of a variant set of the prim.
            variant: one of its variants; empty for none of them; None takes the edit back.

        Raises:
            NotFoundError: there is no such prim.
            SettingsError: it has no such variant set or variant, or it lies in an instance.
        """
        with self._edits.transaction(f"choose {name} of {_name(prim)}"):
            choose_variant(self._stage, prim, name, variant)

    def show_payload(self, prim: str, is_shown: bool | None) -> None:
        """Make a prim with a payload part of the stage or not.

        Args:
            prim: prim path.
            is_shown: whether it is part of the stage; None takes the edit back.

        Raises:
            NotFoundError: there is no such prim.
            SettingsError: it has no payload, or lies in an instance.
        """
        words = {True: "show", False: "leave out", None: "reset"}[is_shown]
        with self._edits.transaction(f"{words} {_name(prim)}"):
            show_payload(self._stage, prim, is_shown)


def _name(path: str) -> str:
    return path.rpartition("/")[2]
