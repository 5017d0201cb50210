"""FocusPointAPI: a thing that must be sharp, or soft."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.setting import Bounds, Slider, Triple, relationship, schema_group, setting

FocusPointKind = Literal["sharp", "soft"]
FocusPointColor = Literal["none", "red", "orange", "yellow", "green", "teal", "blue", "purple", "pink"]
MAX_INDEX = 2**31 - 1
"""The largest int of USD."""
MOST_BOUNDS_SIZES = 1000.0
"""Farthest that a point may lie from the bounds that it follows, in their sizes."""


@schema_group("Focus Point", rest="focusPoint")
@dataclass(frozen=True)
class FocusPoint:
    """One instance of FocusPointAPI: a thing that must be sharp, or soft; ``name`` is the instance's name, an identifier."""

    name: str
    target: tuple[str, ...] = relationship(
        "target",
        "Target",
        "Anchor of the point: one path of a mesh, an implicit prim, an instance proxy or any Xformable; "
        "or two paths, a PointInstancer and the prototype's mesh, with `instance` saying which.",
        unit="none, prim paths",
    )
    face: int = setting(
        "face",
        -1,
        "Face",
        "Index of the target mesh's face as it is authored; -1 anchors to the origin of the target's own space.",
        "Of an implicit prim, the face of the mesh that stands for it; of Gaussian splats, the splat.",
        unit="none, an index from 0",
        hard=(-1, None),
        bounds=Bounds(-1, MAX_INDEX),
    )
    fan_triangle: int = setting(
        "fanTriangle",
        0,
        "Triangle of the Face",
        "Which triangle of the face: triangle i joins the face's corners 0, i + 1 and i + 2 in authored order.",
        unit="none, an index from 0",
        hard=(0, None),
        bounds=Bounds(0, MAX_INDEX),
    )
    barycentric: Triple = setting(
        "barycentric",
        (1.0, 0.0, 0.0),
        "Barycentric Coordinates",
        "Weights of the triangle's three corners, in that order; they sum to 1.",
        unit="none, ratios",
        bounds=Bounds(-0.01, 1.01),
    )
    instance: int = setting(
        "instance",
        -1,
        "Instance",
        "Which instance of the PointInstancer: its id where the instancer has ids, else its index (as for "
        "invisibleIds); -1 where the target is none.",
        "Instancers in instancers are numbered by index, each as the digits of one number: outer index times the "
        "count of inner instances, plus the inner index.",
        unit="none, a number from 0",
        hard=(-1, None),
        bounds=Bounds(-1, MAX_INDEX),
    )
    offset: Triple = setting(
        "offset",
        (0.0, 0.0, 0.0),
        "Offset",
        "Moves the point off the surface, in the target's own space, or off its place in the bounds, in the part's.",
        unit="scene units",
        bounds=Bounds(-1e9, 1e9),
    )
    part: str = relationship(
        "part",
        "Part",
        "Prim whose bounds the point follows, at `boundsPoint`, in place of its target's surface: a mesh, a group, a whole "
        "character.",
        "Empty: the point stays on its target. The bounds hold what is visible of the prim, of the purposes default and "
        "render, in the prim's own space at the time.",
        default="",
        unit="none, a prim path",
        bounds=Bounds(length=2000),
    )
    bounds_point: Triple = setting(
        "boundsPoint",
        (0.5, 0.5, 0.5),
        "Place in the Bounds",
        "Where the point is in the bounds of its `part`, along each axis of the part's own space: 0 is their least corner, "
        "1 their greatest, 0.5 their middle.",
        "Numbers outside 0 to 1 lie outside the bounds.",
        unit="none, ratios",
        bounds=Bounds(-MOST_BOUNDS_SIZES, MOST_BOUNDS_SIZES),
    )
    kind: FocusPointKind = setting(
        "kind",
        "sharp",
        "Kind",
        "Whether the target shall be sharp, or soft by `blur` or `surfaceOffset`.",
        unit="none, a token",
        keyable=False,
    )
    blur: float = setting(
        "blur",
        0.0,
        "Blur",
        "Wanted diameter of the circle of confusion at the target: for a soft point what it shall have, for a sharp "
        "point what it may have at most where the points also set the stop.",
        unit="millimetres on the film",
        hard=(0, None),
        soft=(None, 2),
        bounds=Bounds(0, 1e6),
        rest_name="blur_mm",
        slider=Slider(0, 1, 0.01, unit="mm"),
    )
    weight: float = setting(
        "weight",
        1.0,
        "Weight",
        "Weight of the point among the others; 0 equals absence.",
        "Racks are weights that cross over time.",
        unit="none, a ratio",
        hard=(0, None),
        soft=(None, 1),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 1, 0.05),
    )
    falloff: float = setting(
        "falloff",
        0.0,
        "Falloff",
        "Screen distance at which the point has lost its influence on the focal surface, in frame widths; 0 reaches "
        "everywhere.",
        unit="none, frame widths",
        hard=(0, None),
        soft=(None, 1),
        bounds=Bounds(0, 1e6),
        slider=Slider(0, 1, 0.05, zero="all", label="Reach"),
    )
    enabled: bool = setting(
        "enabled",
        True,
        "Enabled",
        "Whether the point counts at all.",
        "Keys hold their value until the next.",
        unit="none, a switch",
    )
    surface_offset: float = setting(
        "surfaceOffset",
        0.0,
        "Offset of the Focal Surface",
        "For a soft point with no `blur`: how far behind the target along the view axis the focal surface lies "
        "there; negative lies before it.",
        unit="scene units",
        soft=(-100, 100),
        bounds=Bounds(-1e9, 1e9),
    )
    extent: float = setting(
        "extent",
        1.0,
        "Extent",
        "Depth of field around the target in surface mode, relative to the lens's own: 2 is twice as deep.",
        unit="none, a ratio above 0",
        hard=(0.001, None),
        soft=(0.1, 10),
        bounds=Bounds(0.001, 1e6),
        slider=Slider(0.1, 4, 0.1, unit="×", label="Depth"),
    )
    color: FocusPointColor = setting(
        "color",
        "none",
        "Colour",
        "Colour in which an editor draws the point, its keys and its distance, to tell it from the others.",
        "It changes nothing in a picture.",
        unit="none, a token",
        keyable=False,
    )
    group: str = setting(
        "group",
        "",
        "Group",
        "Name of the group that an editor lists the point in, with the others of that name; empty for none.",
        "It changes nothing in a picture.",
        unit="none, text",
        bounds=Bounds(length=100),
        keyable=False,
    )
    topology: str = setting(
        "topology",
        "",
        "Topology",
        "Fingerprint of the target mesh's topology when the point was placed: a tool that finds another one there "
        "should say that face and triangle may mean something else now.",
        "Empty where it was not taken.",
        unit="none, text (hexadecimal)",
        rest="",
        keyable=False,
    )
