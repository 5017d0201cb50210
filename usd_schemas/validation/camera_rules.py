"""Rules for a camera's numbers and for its lens, aperture and film."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import fields
from itertools import pairwise
from typing import Any

from pxr import Sdf, Usd, UsdGeom

from usd_schemas.settings import DataSheet, Prescription
from usd_schemas.validation.rule import Fault, Fix, Rule, authored_values
from usd_schemas.values import is_animated, limit_problem, misfit, read_value
from usd_schemas.view import LensCamera

_POSITIVE = (
    *("focalLength", "horizontalAperture", "verticalAperture"),
    *("exposure:time", "exposure:fStop", "exposure:iso", "exposure:responsivity"),
)
_NOT_NEGATIVE = ("fStop", "focusDistance")


def camera_numbers(prim: Usd.Prim) -> Iterator[Fault]:
    """UsdGeomCamera's own numbers make a camera."""
    for name in (*_POSITIVE, *_NOT_NEGATIVE):
        attribute = prim.GetAttribute(name)
        for where, value in authored_values(attribute):
            if not math.isfinite(value) or value < 0 or (value == 0 and name in _POSITIVE):
                wanted = "positive" if name in _POSITIVE else "0 or more"
                yield Fault(attribute.GetPath(), f"{name}{where} must be {wanted}, got {value:g}")
    clipping = UsdGeom.Camera(prim).GetClippingRangeAttr()
    for where, (near, far) in authored_values(clipping):
        if not 0 < near < far:
            yield Fault(clipping.GetPath(), f"clippingRange{where} must be 0 < near < far, got ({near:g}, {far:g})")
    opening, closing = (read_value(prim.GetAttribute(f"shutter:{end}")) or 0.0 for end in ("open", "close"))
    for end, value in (("open", opening), ("close", closing)):
        if not math.isfinite(value):
            path = prim.GetPath().AppendProperty(f"shutter:{end}")
            yield Fault(path, f"shutter:{end} must be a finite number of frames, got {value:g}")
    if opening > closing:
        path = prim.GetPath().AppendProperty("shutter:close")
        yield Fault(path, f"shutter:close must not be before shutter:open ({opening:g}), got {closing:g}")


def authored_types(prim: Usd.Prim) -> Iterator[Fault]:
    """Each layer authors the camera's attributes with the types that their schemas give them."""
    for attribute in prim.GetAuthoredAttributes():
        for spec in attribute.GetPropertyStack(Usd.TimeCode.Default()):
            wanted = attribute.GetTypeName()
            is_attribute = isinstance(spec, Sdf.AttributeSpec)
            if not is_attribute or spec.typeName != wanted:
                got = f"{spec.typeName if is_attribute else 'a relationship'} in {spec.layer.identifier}"
                yield Fault(attribute.GetPath(), f"{attribute.GetName()} must be of type {wanted}, got {got}")


def schema_attributes(prim: Usd.Prim) -> list[Usd.Attribute]:
    """All attributes that the camera has from our schemas and that say something."""
    return [prim.GetAttribute(name) for name in LensCamera(prim).authored()]


def _numbers(value: Any) -> Iterator[float]:
    """The numbers in a value, however deep."""
    if isinstance(value, tuple):
        for item in value:
            yield from _numbers(item)
    elif isinstance(value, float):
        yield value


def values_allowed(prim: Usd.Prim) -> Iterator[Fault]:
    """Each value of our schemas is finite, within its hard limits and one of its allowed tokens."""
    for attribute in schema_attributes(prim):
        tokens = attribute.GetMetadata("allowedTokens")
        for where, value in authored_values(attribute):
            name = attribute.GetName() + where
            if not all(math.isfinite(number) for number in _numbers(value)):
                yield Fault(attribute.GetPath(), f"{name} must be finite, got {value}")
            elif problem := limit_problem(attribute, value):
                yield Fault(attribute.GetPath(), f"{name} {problem}")
            elif tokens and value not in tokens:
                yield Fault(attribute.GetPath(), f"{name} must be one of {', '.join(tokens)}, got {value!r}")


def _can_clamp(stage: Usd.Stage, path: Sdf.Path) -> bool:
    attribute = stage.GetAttributeAtPath(path)
    if not attribute or is_animated(attribute):
        return False
    value = read_value(attribute)
    return bool(limit_problem(attribute, value)) and math.isfinite(value)


def _clamp(stage: Usd.Stage, path: Sdf.Path) -> None:
    attribute = stage.GetAttributeAtPath(path)
    hard = attribute.GetHardLimits()
    value, least, most = read_value(attribute), hard.GetMinimum(), hard.GetMaximum()
    attribute.Set(least if least is not None and value < least else most)


def _unequal(prim: Usd.Prim, kind: type, leader: str) -> Iterator[Fault]:
    """Arrays of a group that are as long neither as the leading one nor empty."""
    count = len(read_value(prim.GetAttribute(leader)) or ())
    for item in fields(kind):
        attribute = prim.GetAttribute(item.metadata["usd"])
        got = len(read_value(attribute) or ()) if attribute.GetTypeName().isArray else 0
        if got not in (0, count):
            yield Fault(
                attribute.GetPath(), f"{attribute.GetName()} must have {count} entries like {leader}, got {got}"
            )


def prescription(prim: Usd.Prim) -> Iterator[Fault]:
    """The prescription's arrays belong together and describe glass that can be."""
    if not prim.HasAPI("LensAPI"):
        return
    yield from _unequal(prim, Prescription, "lens:prescription:radius")
    lens = LensCamera(prim).lens.read()
    surfaces, base = lens.prescription, prim.GetPath().AppendProperty("lens:prescription:radius")
    count = len(surfaces.radius)
    if lens.model == "prescription" and count == 0:
        yield Fault(base, "lens:model is prescription, which needs at least one surface, got none")
    if lens.model in ("spherical", "heightField") and count != 2:
        yield Fault(base, f"lens:model is {lens.model}, which needs two surfaces, got {count}")
    for name, least in (("index", 1.0), ("abbe", 0.0), ("clearDiameter", 0.0), ("coatingWavelength", 0.0)):
        yield from _entries_at_least(prim.GetAttribute(f"lens:prescription:{name}"), least)
    if surfaces.stop_surface >= count > 0:
        path = prim.GetPath().AppendProperty("lens:prescription:stopSurface")
        yield Fault(
            path, f"the stop must be one of the {count} surfaces (0 to {count - 1}), got {surfaces.stop_surface}"
        )
    for name, (first, last) in (
        ("focusGroup", surfaces.focus_group),
        ("focusGroupAcross", surfaces.focus_group_across),
    ):
        if (first, last) != (-1, -1) and not 0 <= first <= last < count:
            path = prim.GetPath().AppendProperty(f"lens:prescription:{name}")
            yield Fault(path, f"the focus group must be surfaces 0 <= first <= last < {count}, got ({first}, {last})")


def configurations(prim: Usd.Prim) -> Iterator[Fault]:
    """The positions of zoom and focus belong to the surfaces, and are as many in every array."""
    if not prim.HasAPI("LensAPI"):
        return
    lens = LensCamera(prim).lens.read()
    surfaces, rows = len(lens.prescription.radius), lens.configurations
    attribute = prim.GetAttribute("lens:configuration:thickness")
    if rows.thickness and (surfaces == 0 or len(rows.thickness) % surfaces):
        wanted = f"one entry for each of the {surfaces} surfaces in each position"
        yield Fault(attribute.GetPath(), f"{attribute.GetName()} must have {wanted}, got {len(rows.thickness)}")
        return
    count = len(rows.thickness) // surfaces if surfaces else 0
    yield from _entries_at_least(attribute, 0.0)
    for name, values in (
        ("objectDistance", rows.object_distance),
        ("focalLength", rows.focal_length),
        ("fStop", rows.f_stop),
    ):
        attribute = prim.GetAttribute(f"lens:configuration:{name}")
        if len(values) not in (0, count):
            wanted = f"{count} entries, one for each position of lens:configuration:thickness"
            yield Fault(attribute.GetPath(), f"{attribute.GetName()} must have {wanted}, got {len(values)}")
        yield from _entries_at_least(attribute, 0.0)


def _entries_at_least(attribute: Usd.Attribute, least: float) -> Iterator[Fault]:
    for where, values in authored_values(attribute):
        for index, value in enumerate(values):
            if value < least:
                message = f"entry {index} of {attribute.GetName()}{where} must be at least {least:g}, got {value:g}"
                yield Fault(attribute.GetPath(), message)


def data_sheet(prim: Usd.Prim) -> Iterator[Fault]:
    """The tables of a data sheet belong together, by increasing image height."""
    if not prim.HasAPI("LensAPI"):
        return
    yield from _unequal(prim, DataSheet, "lens:table:height")
    lens = LensCamera(prim).lens.read()
    path = prim.GetPath().AppendProperty("lens:table:height")
    heights = lens.data_sheet.height
    if lens.model == "dataSheet" and not heights:
        yield Fault(path, "lens:model is dataSheet, which needs tables, got none")
    if heights and (heights[0] != 0 or any(b <= a for a, b in pairwise(heights))):
        yield Fault(path, f"lens:table:height must increase from 0, got {heights}")
    for name, least in (
        ("vignetting", 0.0),
        ("sagittalBlur", 0.0),
        ("tangentialBlur", 0.0),
        ("sphericalAberration", -1.0),
    ):
        yield from _entries_at_least(prim.GetAttribute(f"lens:table:{name}"), least)


def iris(prim: Usd.Prim) -> Iterator[Fault]:
    """The iris lets light through: no blades or at least three, weights that are not all nought."""
    if not prim.HasAPI("ApertureAPI"):
        return
    blades = prim.GetAttribute("aperture:blades")
    for where, count in authored_values(blades):
        if count in (1, 2):
            yield Fault(blades.GetPath(), f"aperture:blades{where} must be 0 (round) or at least 3, got {count}")
    weights = prim.GetAttribute("aperture:radialWeights")
    yield from _entries_at_least(weights, 0.0)
    for where, values in authored_values(weights):
        if values and not any(values):
            yield Fault(weights.GetPath(), f"aperture:radialWeights{where} must let light through somewhere, got all 0")


def film_curves(prim: Usd.Prim) -> Iterator[Fault]:
    """Characteristic curves go forward in exposure and one way in density."""
    if not prim.HasAPI("FilmAPI"):
        return
    film = LensCamera(prim).film.read()
    for group, curve in (("curve", film.curve), ("printCurve", film.print_curve)):
        for channel in ("red", "green", "blue"):
            path = prim.GetPath().AppendProperty(f"film:{group}:{channel}")
            knots = getattr(curve, channel)
            exposures, densities = [knot[0] for knot in knots], [knot[1] for knot in knots]
            for before, after in pairwise(exposures):
                if not after > before:
                    yield Fault(path, f"log exposure of {path.name} must increase, got {after:g} after {before:g}")
            rises = [after - before for before, after in pairwise(densities)]
            if any(rise > 0 for rise in rises) and any(rise < 0 for rise in rises):
                yield Fault(path, f"density of {path.name} must rise or fall throughout, got {densities}")
    is_read = not misfit(prim.GetAttribute("film:curve:green"))  # of another type, another rule tells of it
    if film.curve.source == "knots" and len(film.curve.green) < 2 and is_read:
        path = prim.GetPath().AppendProperty("film:curve:green")
        yield Fault(
            path, f"film:curve:source is knots, which needs at least 2 green knots, got {len(film.curve.green)}"
        )


def assets_resolve(prim: Usd.Prim) -> Iterator[Fault]:
    """Files that the schemas name are there."""
    for attribute in schema_attributes(prim):
        if attribute.GetTypeName() == Sdf.ValueTypeNames.Asset:
            for where, asset in authored_values(attribute):
                if asset.path and not asset.resolved:
                    yield Fault(
                        attribute.GetPath(), f"{attribute.GetName()}{where} names {asset.path}, which is not there"
                    )


def lens_reach(prim: Usd.Prim) -> Iterator[Fault]:
    """The lens's f-numbers go from wide open to closed down, and the camera's stop is one of them."""
    if not prim.HasAPI("LensAPI"):
        return
    widest, smallest = LensCamera(prim).lens.read().f_stop_range
    if 0 < smallest < widest:
        path = prim.GetPath().AppendProperty("lens:fStopRange")
        yield Fault(path, f"lens:fStopRange must go from wide open to closed down, got {widest:g} and {smallest:g}")
        return
    stop = prim.GetAttribute("fStop")
    slack = 1e-6  # fStop is of single precision, the range is not
    for where, value in authored_values(stop):
        if value > 0 and (value < widest * (1 - slack) or (smallest > 0 and value > smallest * (1 + slack))):
            reach = f"from f/{widest:g}" + (f" to f/{smallest:g}" if smallest else "")
            yield Fault(stop.GetPath(), f"the lens opens {reach}, got fStop{where} of {value:g}")


CAMERA_RULES = (
    Rule("AuthoredTypes", authored_types.__doc__ or "", "error", "camera", authored_types),
    Rule("CameraNumbers", camera_numbers.__doc__ or "", "error", "camera", camera_numbers),
    Rule(
        "ValuesAllowed",
        values_allowed.__doc__ or "",
        "error",
        "camera",
        values_allowed,
        Fix("ClampToLimit", "Set a value that does not change over time to the limit it passed.", _can_clamp, _clamp),
    ),
    Rule("Prescription", prescription.__doc__ or "", "error", "camera", prescription),
    Rule("Configurations", configurations.__doc__ or "", "error", "camera", configurations),
    Rule("DataSheet", data_sheet.__doc__ or "", "error", "camera", data_sheet),
    Rule("Iris", iris.__doc__ or "", "error", "camera", iris),
    Rule("FilmCurves", film_curves.__doc__ or "", "error", "camera", film_curves),
    Rule("AssetsResolve", assets_resolve.__doc__ or "", "warning", "camera", assets_resolve),
    Rule("LensReach", lens_reach.__doc__ or "", "warning", "camera", lens_reach),
)
