"""The typed view of one focus point of a camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from pxr import Sdf, Tf, Usd

from usd_schemas import binding
from usd_schemas.errors import SchemaError
from usd_schemas.keys import Interpolation, Key, Tangents, keys, remove_key, set_key
from usd_schemas.settings import FocusPoint
from usd_schemas.values import Time

NAMESPACE = "focusPoint"


class FocusPointView:
    """One instance of FocusPointAPI on a camera.

    Attributes:
        prim: the camera.
        name: the instance name.
    """

    def __init__(self, prim: Usd.Prim, name: str) -> None:
        self.prim = prim
        self.name = name

    def read(self, time: Time = None) -> FocusPoint:
        """Read the point at a time code (None: the default time).

        Raises:
            SchemaError: its target is authored as an attribute.
        """
        return binding.read(FocusPoint, self.prim, time, self._prefix, name=self.name, target=self._targets())

    def read_over(self, times: Sequence[float]) -> tuple[FocusPoint, ...]:
        """Read the point at several time codes.

        Raises:
            SchemaError: its target is authored as an attribute.
        """
        return binding.read_over(FocusPoint, self.prim, times, self._prefix, name=self.name, target=self._targets())

    def author(self, point: FocusPoint, time: Time = None) -> None:
        """Author what differs from what the point says; ``point.name`` does not matter.

        Args:
            point: what it shall say.
            time: USD time code of the keys; None for values that do not change over time. Target, kind and topology are
                the same at all times.

        Raises:
            SchemaError: a value is not allowed, or it would be hidden by keys; nothing is authored then.
        """
        paths = _target_paths(point)
        binding.author(point, self.prim, time, self._prefix)
        if self._targets() != point.target:
            self.target_relationship().SetTargets(paths)

    def author_all(self, point: FocusPoint) -> None:
        """Author every value of a new point, over whatever weaker layers say of a point that once had its name."""
        paths = _target_paths(point)
        binding.author_all(point, self.prim, self._prefix)
        self.target_relationship().SetTargets(paths)

    def keys(self, attribute: str) -> list[Key]:
        """Keys of one attribute, by the name of the `FocusPoint` field or of the USD property."""
        return keys(self._attribute(attribute))

    def set_key(
        self,
        attribute: str,
        time: float,
        value: Any,
        interpolation: Interpolation = "linear",
        tangents: Tangents | None = None,
    ) -> None:
        """Set a key on one attribute; see `usd_schemas.keys.set_key`."""
        set_key(self._attribute(attribute), time, value, interpolation, tangents)

    def remove_key(self, attribute: str, time: float) -> None:
        """Remove a key from one attribute; see `usd_schemas.keys.remove_key`."""
        remove_key(self._attribute(attribute), time)

    def attributes(self) -> list[Usd.Attribute]:
        """All attributes of the point."""
        return [self.prim.GetAttribute(self._prefix + name) for name in binding.property_names(FocusPoint)]

    def target_relationship(self) -> Usd.Relationship:
        """The relationship that names the target."""
        return self.prim.GetRelationship(f"{self._prefix}target")

    def _targets(self) -> tuple[str, ...]:
        try:
            return tuple(str(path) for path in self.target_relationship().GetTargets())
        except Tf.ErrorException as error:
            path = self.prim.GetPath().AppendProperty(f"{self._prefix}target")
            raise SchemaError(f"{path} must be a relationship to a prim, got an attribute") from error

    @property
    def _prefix(self) -> str:
        return f"{NAMESPACE}:{self.name}:"

    def _attribute(self, name: str) -> Usd.Attribute:
        by_name = {item.name: item.metadata["usd"] for item in fields(FocusPoint) if "usd" in item.metadata}
        base = by_name.get(name, name)
        if base not in by_name.values():
            expected = ", ".join(by_name)
            raise SchemaError(f"a focus point has the attributes {expected}; got {name!r}")
        return self.prim.GetAttribute(self._prefix + base)


def _target_paths(point: FocusPoint) -> list[Sdf.Path]:
    """The target as paths; one, or two for a PointInstancer and its prototype's mesh.

    Raises:
        SchemaError: there are more or fewer, or one is no absolute prim path.
    """
    if len(point.target) not in (1, 2):
        raise SchemaError(
            f"focus point {point.name!r} needs one target path, or a PointInstancer's and its prototype's, "
            f"got {len(point.target)}"
        )
    paths = [Sdf.Path(text) if Sdf.Path.IsValidPathString(text) else Sdf.Path.emptyPath for text in point.target]
    for text, path in zip(point.target, paths, strict=True):
        if not (path.IsPrimPath() and path.IsAbsolutePath()):
            raise SchemaError(f"the target of focus point {point.name!r} must be an absolute prim path, got {text!r}")
    return paths
