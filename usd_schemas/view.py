"""The typed view of a camera: read and author all that the schemas say, at a time code.

A `LensCamera` wraps any UsdGeomCamera prim, whether its type is Camera with the schemas applied or LensCamera. Edits go
to the stage's edit target, so that they are a layer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from pxr import Sdf, Usd, UsdGeom

from usd_schemas import binding
from usd_schemas.applying import applied, apply
from usd_schemas.errors import SchemaError
from usd_schemas.focus_point import FocusPointView
from usd_schemas.keys import Interpolation, Key, Tangents, copy_values, keys, remove_key, set_key
from usd_schemas.registration import FOCUS_POINT, LENS_CAMERA, SINGLE_APPLY
from usd_schemas.settings import ApertureData, FilmData, FocusData, FocusPoint, LensData, TiltShiftData
from usd_schemas.values import Time, misfit, read_value

Data = TypeVar("Data", LensData, ApertureData, TiltShiftData, FilmData, FocusData)


class SchemaView(Generic[Data]):
    """One single-apply schema of one camera.

    Attributes:
        prim: the camera.
        schema: the schema's name, such as "LensAPI".
    """

    def __init__(self, prim: Usd.Prim, schema: str, kind: type[Data]) -> None:
        self.prim = prim
        self.schema = schema
        self._kind: type[Data] = kind

    @property
    def applied(self) -> bool:
        """Whether the camera has the schema."""
        return bool(self.prim.HasAPI(self.schema))

    def read(self, time: Time = None) -> Data:
        """Read the schema at a time code (None: the default time); its fallbacks where it is not applied."""
        return binding.read(self._kind, self.prim, time) if self.applied else self._kind()

    def read_over(self, times: Sequence[float]) -> tuple[Data, ...]:
        """Read the schema at several time codes; its fallbacks where it is not applied."""
        return binding.read_over(self._kind, self.prim, times) if self.applied else (self._kind(),) * len(times)

    def author(self, data: Data, time: Time = None) -> None:
        """Apply the schema if need be, and author what differs from what the camera says.

        Args:
            data: what the camera shall say.
            time: USD time code of the keys; None for values that do not change over time.

        Raises:
            SchemaError: a value is not allowed, or it would be hidden by keys; nothing is authored then.
        """
        with applied(self.prim, self.schema):
            binding.author(data, self.prim, time)


@dataclass(frozen=True)
class Misread:
    """Value of an attribute that its schema does not define.

    Attributes:
        name: of the attribute.
        got: the type of its value; or the token.
        type: that was expected, empty where the token is at fault.
        tokens: that were expected, empty where the type is at fault.
    """

    name: str
    got: str
    type: str = ""
    tokens: tuple[str, ...] = ()


class LensCamera:
    """A camera and all that the schemas say of it.

    Attributes:
        prim: the UsdGeomCamera prim.
        lens: LensAPI.
        aperture: ApertureAPI.
        tilt_shift: TiltShiftAPI.
        film: FilmAPI.
        focus: FocusAPI.

    Raises:
        SchemaError: the prim is invalid or no camera.
    """

    def __init__(self, prim: Usd.Prim) -> None:
        if not prim or not prim.IsA(UsdGeom.Camera):
            got = f"{prim.GetPath()} of type {prim.GetTypeName() or 'none'}" if prim else "an invalid prim"
            raise SchemaError(f"a camera is needed, a prim of type Camera or {LENS_CAMERA}; got {got}")
        self.prim = prim
        self.lens = SchemaView(prim, "LensAPI", LensData)
        self.aperture = SchemaView(prim, "ApertureAPI", ApertureData)
        self.tilt_shift = SchemaView(prim, "TiltShiftAPI", TiltShiftData)
        self.film = SchemaView(prim, "FilmAPI", FilmData)
        self.focus = SchemaView(prim, "FocusAPI", FocusData)

    def focus_points(self) -> list[FocusPointView]:
        """The camera's focus points, in the order in which they are applied."""
        prefix = f"{FOCUS_POINT}:"
        return [
            FocusPointView(self.prim, schema.removeprefix(prefix))
            for schema in self.prim.GetAppliedSchemas()
            if schema.startswith(prefix)
        ]

    def focus_point(self, name: str) -> FocusPointView:
        """The focus point of that name.

        Raises:
            SchemaError: the camera has none of that name.
        """
        existing = [point.name for point in self.focus_points()]
        if name not in existing:
            raise SchemaError(
                f"{self.prim.GetPath()} has no focus point named {name!r}; it has: {', '.join(existing) or 'none'}"
            )
        return FocusPointView(self.prim, name)

    def add_focus_point(self, name: str, data: FocusPoint) -> FocusPointView:
        """Add a focus point.

        Args:
            name: an identifier that no property of the schema has.
            data: what it says; its own name does not matter.

        Raises:
            SchemaError: the name is taken or no identifier, or a value is not allowed.
        """
        if not Sdf.Path.IsValidIdentifier(name):
            raise SchemaError(
                f"a focus point's name must be an identifier (letters, digits and _, no digit first), got {name!r}"
            )
        if any(point.name == name for point in self.focus_points()):
            raise SchemaError(f"{self.prim.GetPath()} already has a focus point named {name!r}")
        view = FocusPointView(self.prim, name)
        with applied(self.prim, FOCUS_POINT, name):
            view.author_all(data)
        return view

    def rename_focus_point(self, name: str, new_name: str) -> FocusPointView:
        """Rename a focus point. It keeps its allowed values and its keys; of those that the edit target applies it becomes last.

        Args:
            name: of the point.
            new_name: an identifier that no other focus point of the camera has.

        Raises:
            SchemaError: the camera has none of that name, or the new one is taken or no identifier.
        """
        old = self.focus_point(name)
        renamed = self.add_focus_point(new_name, old.allowed(old.read()))
        for before, after in zip(old.attributes(), renamed.attributes(), strict=True):
            copy_values(before, after)
        self.remove_focus_point(name)
        return renamed

    def remove_focus_point(self, name: str) -> None:
        """Remove a focus point, and what the edit target says of it.

        Raises:
            SchemaError: the camera has none of that name.
        """
        view = self.focus_point(name)
        for attribute in [*view.attributes(), *view.relationships()]:
            self.prim.RemoveProperty(attribute.GetName())
        self.prim.RemoveAPI(FOCUS_POINT, name)

    def keys(self, attribute: str) -> list[Key]:
        """Keys of any attribute of the camera, by its USD name, such as "focusDistance" or "lens:transmittance"."""
        return keys(self._attribute(attribute))

    def set_key(
        self,
        attribute: str,
        time: float,
        value: Any,
        interpolation: Interpolation = "linear",
        tangents: Tangents | None = None,
    ) -> None:
        """Set a key on any attribute of the camera; see `usd_schemas.keys.set_key`."""
        set_key(self._attribute(attribute), time, value, interpolation, tangents)

    def remove_key(self, attribute: str, time: float) -> None:
        """Remove a key from any attribute of the camera; see `usd_schemas.keys.remove_key`."""
        remove_key(self._attribute(attribute), time)

    def authored(self) -> list[str]:
        """Names of the schemas' properties that have an opinion other than the fallback, or keys.

        For a renderer to say which of them it does not honour.
        """
        names = [name for kind in _KINDS for name in binding.property_names(kind)]
        names += [attribute.GetName() for point in self.focus_points() for attribute in point.attributes()]
        return [name for name in names if binding.has_opinion(self.prim.GetAttribute(name))]

    def misread(self, time: Time = None) -> Iterator[Misread]:
        """Yield values at a time that the schemas do not define, so that a reader would have to guess.

        Args:
            time: USD time code, None for the default time.

        Yields:
            One for each value of another type than the schema's, and each token that is none of the allowed ones.
        """
        for schema, kind in zip(SINGLE_APPLY, _KINDS, strict=True):
            for name in binding.property_names(kind) if self.prim.HasAPI(schema) else ():
                attribute = self.prim.GetAttribute(name)
                if not attribute or not attribute.HasAuthoredValue():
                    continue
                tokens = tuple(attribute.GetMetadata("allowedTokens") or ())
                if kind_got := misfit(attribute, time):
                    yield Misread(name, kind_got, str(attribute.GetTypeName()))
                elif tokens and (token := read_value(attribute, time)) is not None and token not in tokens:
                    yield Misread(name, str(token), "", tokens)

    def _attribute(self, name: str) -> Usd.Attribute:
        attribute = self.prim.GetAttribute(name) if Sdf.Path.IsValidNamespacedIdentifier(name) else None
        if not attribute or not attribute.IsDefined():
            raise SchemaError(f"{self.prim.GetPath()} has no attribute named {name!r}")
        return attribute


_KINDS = (LensData, ApertureData, TiltShiftData, FilmData, FocusData)


def define_lens_camera(stage: Usd.Stage, path: str) -> LensCamera:
    """Define a prim of type LensCamera, and note on the stage that others may take it for a Camera."""
    prim = stage.DefinePrim(path, LENS_CAMERA)
    stage.WriteFallbackPrimTypes()
    return LensCamera(prim)


def define_camera(stage: Usd.Stage, path: str) -> LensCamera:
    """Define a plain Camera, the interchange form, with the five single-apply schemas applied."""
    camera = LensCamera(UsdGeom.Camera.Define(stage, path).GetPrim())
    for schema in SINGLE_APPLY:
        apply(camera.prim, schema)
    return camera
