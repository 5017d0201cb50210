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
        return binding.read(FocusPoint, self.prim, time, self._prefix, name=self.name, **self._related())

    def allowed(self, point: FocusPoint) -> FocusPoint:
        """Return a point with defaults in place of values that are not allowed, such as another tool may write."""
        return binding.allowed(point, self.prim, self._prefix)

    def read_over(self, times: Sequence[float]) -> tuple[FocusPoint, ...]:
        """Read the point at several time codes.

        Raises:
            SchemaError: its target is authored as an attribute.
        """
        return binding.read_over(FocusPoint, self.prim, times, self._prefix, name=self.name, **self._related())

    def author(self, point: FocusPoint, time: Time = None) -> None:
        """Author what differs from what the point says; ``point.name`` does not matter.

        Args:
            point: what it shall say.
            time: USD time code of the keys; None for values that do not change over time. Target, part, kind and topology
                are the same at all times.

        Raises:
            SchemaError: a value is not allowed, or it would be hidden by keys; nothing is authored then.
        """
        targets, parts = _target_paths(point), _part_paths(point)
        binding.author(point, self.prim, time, self._prefix)
        if self._paths(self.target_relationship()) != point.target:
            self.target_relationship().SetTargets(targets)
        if self._related()["part"] != point.part:
            self.part_relationship().SetTargets(parts)

    def author_all(self, point: FocusPoint) -> None:
        """Author every value of a new point, over whatever weaker layers say of a point that once had its name."""
        targets, parts = _target_paths(point), _part_paths(point)
        binding.author_all(point, self.prim, self._prefix)
        self.target_relationship().SetTargets(targets)
        if parts or self.part_relationship().HasAuthoredTargets():
            self.part_relationship().SetTargets(parts)

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

    def part_relationship(self) -> Usd.Relationship:
        """The relationship that names the prim whose bounds the point follows."""
        return self.prim.GetRelationship(f"{self._prefix}part")

    def relationships(self) -> list[Usd.Relationship]:
        """All relationships of the point."""
        return [self.target_relationship(), self.part_relationship()]

    def _related(self) -> dict[str, Any]:
        """The fields that are relationships."""
        parts = self._paths(self.part_relationship())
        return {"target": self._paths(self.target_relationship()), "part": parts[0] if parts else ""}

    def _paths(self, relationship: Usd.Relationship) -> tuple[str, ...]:
        try:
            return tuple(str(path) for path in relationship.GetTargets())
        except Tf.ErrorException as error:
            raise SchemaError(f"{relationship.GetPath()} must be a relationship to a prim, got an attribute") from error

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
    """The target as paths; one, or two for a PointInstancer and its prototype's mesh. A point with a part may have none.

    Raises:
        SchemaError: there are more or fewer, or one is no absolute prim path.
    """
    if len(point.target) not in ((0, 1, 2) if point.part else (1, 2)):
        raise SchemaError(
            f"focus point {point.name!r} needs one target path, or a PointInstancer's and its prototype's, "
            f"got {len(point.target)}"
        )
    return [_prim_path(point, "target", text) for text in point.target]


def _part_paths(point: FocusPoint) -> list[Sdf.Path]:
    """The part as paths; one or none.

    Raises:
        SchemaError: it is no absolute prim path.
    """
    return [_prim_path(point, "part", point.part)] if point.part else []


def _prim_path(point: FocusPoint, what: str, text: str) -> Sdf.Path:
    path = Sdf.Path(text) if Sdf.Path.IsValidPathString(text) else Sdf.Path.emptyPath
    if not (path.IsPrimPath() and path.IsAbsolutePath()):
        raise SchemaError(f"the {what} of focus point {point.name!r} must be an absolute prim path, got {text!r}")
    if Usd.Prim.IsPathInPrototype(path):
        raise SchemaError(
            f"the {what} of focus point {point.name!r} must be a prim of the scene, not of a prototype, got {text!r}"
        )
    return path
