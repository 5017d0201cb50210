"""The scene at one time, as flat arrays: what the stage reader fills and the layer renderer draws.

Defined without pxr, so that tests and generated scenes can fill it by hand. Everything is immutable and shared: when
the time changes, the reader returns a new `Scene` that holds the same `Geometry`, `Image` and `Material` objects for
all that did not change, and the renderer uploads only objects it has not seen.

Conventions: world space is right-handed in metres, with the stage's own up axis turned to +Y. Matrices are
``(4, 4)`` float64 for *column* vectors (``world = M @ local``), which is the transpose of USD's. Colours are
scene-linear in the working space. Images have row 0 at the top; texture coordinates have t = 0 at the bottom, as in USD.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.face_places import FacePlaces
from render.model.light_filters import LightFilter
from render.model.splats import SplatBatch

Wrap = Literal["repeat", "clamp", "mirror", "black"]
VALUES_WIDTH = 6
"""Further numbers of a vertex that a material may read."""
LEAST_GLASS_OPACITY = 1 / 256
"""Opacity of glass that hides nothing, so that its highlights, which are kept relative to its opacity, are drawn."""
MAX_TEXTURES = 8
"""Images, or ways to wrap them, that one material looks up."""
CameraRole = Literal["seen", "holdout", "unseen"]
"""Role of a surface for the camera: seen; a holdout, which hides what is behind it and leaves neither colour nor coverage; or
not seen at all. All three cast shadows."""


@dataclass(frozen=True, eq=False)
class Image:
    """A texture image, or a set of UDIM tiles.

    Attributes:
        pixels: ``(height, width, 4)`` float16; colour in the working space (or raw data), alpha in the last channel. Of a set,
            ``(count, height, width, 4)``.
        name: the file it came from, for messages.
        channels: number of channels of that file.
        tiles: numbers of a set's tiles, ascending, in the order of ``pixels``; empty for a single image. Tile 1001 + column +
            10 * row shows in the unit square of texture coordinates whose lower left corner is (column, row).
    """

    pixels: NDArray[np.float16]
    name: str = ""
    channels: int = 4
    tiles: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class TextureLookup:
    """Image look-up of one material input: ``value = texel * scale + bias``.

    Attributes:
        image: the image.
        uv_transform: ``(2, 3)`` float32; maps the mesh's ``(s, t, 1)`` to the lookup position (UsdTransform2d).
        scale: ``(4,)`` float32.
        bias: ``(4,)`` float32.
        wrap_s: wrapping across the image.
        wrap_t: wrapping up the image.
        channel: which channel a scalar input takes: 0 red, 1 green, 2 blue, 3 alpha; -1 where the input is a colour.
        fallback: ``(4,)`` float32 value, without scale and bias, where a set of tiles has none. Sets ignore the wrapping.
        uv_at: first of the two numbers of ``Geometry.values`` that are its texture coordinates; -1 for ``Geometry.uvs``.
    """

    image: Image
    uv_transform: FloatArray = field(default_factory=lambda: np.array([[1, 0, 0], [0, 1, 0]], np.float32))
    scale: FloatArray = field(default_factory=lambda: np.ones(4, np.float32))
    bias: FloatArray = field(default_factory=lambda: np.zeros(4, np.float32))
    wrap_s: Wrap = "repeat"
    wrap_t: Wrap = "repeat"
    channel: int = -1
    fallback: FloatArray = field(default_factory=lambda: np.zeros(4, np.float32))
    uv_at: int = -1


@dataclass(frozen=True)
class SurfaceGraph:
    """Network of nodes that gives a surface, as GLSL for ``layers/graph.glsl``.

    Attributes:
        functions: its functions.
        numbers: for the block that they read, four for each row.
        reads_place: whether geometries hold the place in the prim's own space where they hold colours otherwise.
        may_be_transparent: whether a fragment may be wholly or partly transparent.
        opacity: share of what is behind that it hides, as far as it is known without the device.
        has_sheen: whether it may have a sheen.
        has_film: whether it may have a thin film.
        mixed: surfaces that it evaluates for each fragment, mixes among them.
    """

    functions: str
    numbers: tuple[float, ...]
    reads_place: bool = False
    may_be_transparent: bool = False
    opacity: float = 1.0
    has_sheen: bool = False
    has_film: bool = False
    mixed: int = 1


@dataclass(frozen=True, eq=False)
class Material:
    """A UsdPreviewSurface. Textures, where present in ``lookups``, replace the constant of the same name.

    Attributes:
        name: the material's prim path, or a made-up name.
        base_color: diffuseColor.
        emissive: emissiveColor, radiance that leaves the surface; may exceed 1.
        metallic: 0 dielectric to 1 metal.
        roughness: UsdPreviewSurface roughness (GGX alpha is its square).
        specular: reflectance at normal incidence for the specular workflow, else ``None``.
        ior: index of refraction, gives the dielectric's reflectance.
        opacity: 1 is opaque.
        opacity_threshold: above 0, a cut-out: opacity below it is a hole, above it is opaque.
        fades_highlights: opacity fades all of the surface's light; else its diffuse response alone, as of glass.
        occlusion: share of the dome that the surface sees.
        clearcoat: amount of the second specular lobe.
        clearcoat_roughness: its roughness.
        uses_display_color: multiply base_color and opacity by the mesh's displayColor and displayOpacity
            (a mesh with no material bound has a white material with this set).
        unlit: show ``emissive`` alone, whatever the lights and the shading, and cast no shadow.
        values: first of the numbers of ``Geometry.values`` that replace the constant of an input, by its name: one number, or
            three of colours.
        lookups: textures by input name: base_color, emissive, metallic, roughness, specular, opacity, normal, occlusion,
            clearcoat, clearcoat_roughness, ior; of a graph by the name of the sampler. They show at most `MAX_TEXTURES` images,
            twice as many of a graph.
        graph: the network that gives the surface in place of all inputs but ``clearcoat``, which says whether there is a clear
            coat at all; or None.
    """

    name: str = ""
    base_color: tuple[float, float, float] = (0.18, 0.18, 0.18)
    emissive: tuple[float, float, float] = (0.0, 0.0, 0.0)
    metallic: float = 0.0
    roughness: float = 0.5
    specular: tuple[float, float, float] | None = None
    ior: float = 1.5
    opacity: float = 1.0
    opacity_threshold: float = 0.0
    fades_highlights: bool = True
    occlusion: float = 1.0
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.01
    uses_display_color: bool = False
    unlit: bool = False
    values: dict[str, int] = field(default_factory=dict)
    lookups: dict[str, TextureLookup] = field(default_factory=dict)
    graph: SurfaceGraph | None = None

    @property
    def may_have_coat(self) -> bool:
        """Whether it may have a clear coat somewhere."""
        return self.clearcoat > 0 or "clearcoat" in self.lookups or "clearcoat" in self.values

    @property
    def may_be_transparent(self) -> bool:
        """Whether it may be wholly or partly transparent somewhere, whatever the colours of a geometry."""
        is_clear = self.graph is not None and self.graph.may_be_transparent
        return is_clear or self.opacity < 1 or self.opacity_threshold > 0 or "opacity" in self.lookups


@dataclass(frozen=True, eq=False)
class Geometry:
    """Triangles that are drawn with one material. Several prims may be merged in one.

    Attributes:
        positions: ``(n, 3)`` float32 metres, in the space that the batch's poses map to the world.
        normals: ``(n, 3)`` float32, unit length.
        uvs: ``(n, 2)`` float32 or None.
        colors: ``(n, 4)`` float32 displayColor and displayOpacity, or None for white.
        values: ``(n, VALUES_WIDTH)`` float32 further numbers that the material reads, or None.
        triangles: ``(m, 3)`` int32 vertex indices, counter-clockwise seen from outside in this space: a pose that mirrors it
            turns the winding in the world around, and not the side that is outside.
        prim_ids: ``(m,)`` int32 index into ``Scene.prim_paths`` for each triangle.
        face_ids: ``(m,)`` int32 index of the authored face for each triangle.
        fan_ids: ``(m,)`` int32: triangle i of the face's fan is its corners ``(0, i + 1, i + 2)``, in authored order.
        places: places of triangles that are finer than the fans of their faces, where there are any; else None.
        swapped: ``(m,)`` bool: triangles whose last two corners stand in the other order here, since the face or its
            transform is left-handed; or None for none. Barycentric coordinates of a hit swap likewise.
        material_ids: ``(m,)`` int32 index into ``Scene.material_paths`` of the material that each triangle's prim is bound to,
            of which the drawn one may be a copy; -1 for none; or None for none at all.
    """

    positions: FloatArray
    normals: FloatArray
    triangles: IntArray
    prim_ids: IntArray
    face_ids: IntArray
    fan_ids: IntArray
    uvs: FloatArray | None = None
    colors: FloatArray | None = None
    swapped: NDArray[np.bool_] | None = None
    material_ids: IntArray | None = None
    places: FacePlaces | None = None
    values: FloatArray | None = None

    def coordinates(self, lookup: TextureLookup) -> FloatArray | None:
        """Texture coordinates ``(n, 2)`` of a look-up; None where there are none."""
        if lookup.uv_at < 0 or self.values is None:
            return self.uvs
        return self.values[:, lookup.uv_at : lookup.uv_at + 2]

    def fan_points(self, triangles: NDArray[np.integer], weights: DoubleArray) -> tuple[IntArray, DoubleArray]:
        """Triangles ``(n,)`` of the fans of authored faces, and weights ``(n, 3)`` there, of points of triangles.

        Args:
            triangles: ``(n,)``.
            weights: ``(n, 3)`` barycentric coordinates in these.
        """
        if self.swapped is not None:
            weights = np.where(self.swapped[triangles][:, None], weights[:, [0, 2, 1]], weights)
        fans = self.fan_ids[triangles]
        return (fans, weights) if self.places is None else self.places.to_fans(triangles, fans, weights)


@dataclass(frozen=True)
class LightLinks:
    """Lights that leave a surface out (UsdLux's collections ``lightLink`` and ``shadowLink``).

    Attributes:
        unlit_by: paths of the lights, or the dome, that do not shine on it.
        unshadowed: paths of the lights for which it casts no shadow.
    """

    unlit_by: frozenset[str] = frozenset()
    unshadowed: frozenset[str] = frozenset()


MAX_LINK_SETS = 256
"""Sets of lights that leave surfaces out, in one scene; the empty one is one of them."""
UNLINKED = LightLinks()
"""Links of a surface that all lights shine on, and that casts a shadow for all."""


@dataclass(frozen=True, eq=False)
class Batch:
    """One draw: a geometry, its material and where its instances stand.

    Attributes:
        geometry: geometry that is drawn.
        material: with what.
        poses: ``(k, 4, 4)`` float64 world from geometry space, one for each instance.
        double_sided: whether both sides are outsides: drawn, with normals towards the eye.
        culls_backs: whether back faces are left out where ``double_sided`` is False; otherwise they are drawn with the normals of
            the front, as in Storm: lights in front of the surface light them.
        insides: ``(n, 2, 3)`` least and greatest corners of boxes in geometry space, metres, where all of the geometry's surfaces
            are closed (`render.stage.geometry.closed`): seen from outside of all boxes, opaque front faces hide the back faces.
            None where one is open.
        instance_prim_ids: ``(k,)`` int32 index into ``Scene.prim_paths`` of the prim an instance is picked as, or None
            where the triangle's own prim is. For native instances: one entry for each instance, and each is the instance
            proxy's path of the mesh. For a PointInstancer: the instancer.
        instance_colors: ``(k, 4)`` float32 colour and opacity that each instance multiplies the geometry's ``colors`` by, or None
            for white.
        instance_numbers: ``(k,)`` int32 the PointInstancer's id of the instance, its index where it has no ids, or -1.
        instance_material_ids: ``(k,)`` int32 as `Geometry.material_ids`, or None where the triangles' own count.
        camera_role: what the camera makes of it.
        seen_by: path of the only camera that sees it, or None for all cameras.
        links: lights that leave it out.
    """

    geometry: Geometry
    material: Material
    poses: DoubleArray
    double_sided: bool = False
    instance_prim_ids: IntArray | None = None
    instance_numbers: IntArray | None = None
    insides: DoubleArray | None = None
    culls_backs: bool = True
    instance_colors: FloatArray | None = None
    instance_material_ids: IntArray | None = None
    camera_role: CameraRole = "seen"
    seen_by: str | None = None
    links: LightLinks = UNLINKED

    @property
    def has_backs(self) -> bool:
        """Whether back faces are drawn."""
        return self.double_sided or not self.culls_backs


PROFILE_SHAPE = 64, 256
"""Directions of a light's profile: around its axis, and away from it."""
POINT_RADIUS_M = 1e-3
"""Radius of the sphere that a light without a size is drawn as. Its shadows are those of a point."""
LightKind = Literal["distant", "sphere", "disk", "rect", "cylinder", "mesh"]


@dataclass(frozen=True, eq=False)
class Light:
    """A UsdLux light, in physical terms.

    Attributes:
        kind: its shape.
        radiance: ``(3,)`` of the emitting surface: colour · intensity · 2^exposure, divided by the area where
            ``normalize`` is set; for a distant light the *irradiance* on a surface that faces it.
        pose: ``(4, 4)`` float64 world from light; it shines along -Z.
        radius_m: of a sphere, disk or cylinder; of the sphere around a mesh, whose pose stands in its middle.
        width_m: of a rect, along its X.
        height_m: of a rect, along its Y.
        length_m: of a cylinder, along its X; its ends are dark.
        triangles: ``(m, 3, 3)`` float64 corners of a mesh, world, counter-clockwise seen from outside, where it shines; or None.
        image: multiplier of a rect's radiance, or None: seen from where it shines, upright, row 0 at +Y and column 0 at +X.
        angle_rad: full angle of a distant light.
        cone_angle_rad: half angle of the shaping cone; pi for none.
        cone_softness: 0 hard to 1: share of the cone's angle, from its edge, over which its light ends.
        diffuse: multiplier of the diffuse response.
        specular: multiplier of the specular response.
        profile: `PROFILE_SHAPE` float32 multiplier of its light by direction: rows by the angle around -Z from +X towards +Y, at
            the middle of each; columns by the angle from -Z, from 0 to pi. None for 1.
        focus: exponent of the cosine from the light's axis, ahead or behind, that multiplies its light; 0 for none.
        focus_tint: ``(3,)`` colour that the light fades to off its axis.
        filters: what its light goes through.
        casts_shadow: UsdLuxShadowAPI.
        shadow_color: ``(3,)`` share of its light that its shadows keep.
        shadow_reach_m: how far from what casts it a shadow falls; infinity for any distance.
        shadow_fade_m: the last part of that, in which the shadow fades.
        shadow_gamma: exponent of that fading; 1 for a linear one.
        path: prim path.
    """

    kind: LightKind
    radiance: tuple[float, float, float]
    pose: DoubleArray
    radius_m: float = 0.0
    width_m: float = 0.0
    height_m: float = 0.0
    length_m: float = 0.0
    triangles: DoubleArray | None = None
    image: Image | None = None
    angle_rad: float = 0.0
    cone_angle_rad: float = float(np.pi)
    cone_softness: float = 0.0
    diffuse: float = 1.0
    specular: float = 1.0
    profile: FloatArray | None = None
    focus: float = 0.0
    focus_tint: tuple[float, float, float] = (0.0, 0.0, 0.0)
    filters: tuple[LightFilter, ...] = ()
    casts_shadow: bool = True
    shadow_color: tuple[float, float, float] = (0.0, 0.0, 0.0)
    shadow_reach_m: float = float("inf")
    shadow_fade_m: float = 0.0
    shadow_gamma: float = 1.0
    path: str = ""


@dataclass(frozen=True, eq=False)
class Dome:
    """Light from all around.

    Attributes:
        radiance: ``(3,)`` multiplier: colour · intensity · 2^exposure.
        image: latitude-longitude environment as OpenEXR (and so UsdLux) defines it, or None for a uniform dome: row 0
            looks up (+Y), the centre column along +Z, and +X is a quarter of the width to the left of it.
        pose: ``(4, 4)`` float64, world from dome.
        diffuse: multiplier of the diffuse response.
        specular: multiplier of the specular response.
        visible: whether the camera sees it behind everything.
        path: prim path.
    """

    radiance: tuple[float, float, float]
    pose: DoubleArray
    image: Image | None = None
    diffuse: float = 1.0
    specular: float = 1.0
    visible: bool = True
    path: str = ""


LitBy = Literal["auto", "stage", "camera", "both"]
"""Lights of a picture: the stage's, or one at the camera where there are none; the stage's; one at the camera; or both."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that is drawn, at one time. The camera travels beside it, not in it.

    Attributes:
        batches: batches that are drawn.
        lights: lights with a place or a direction.
        dome: light from all around, or None.
        prim_paths: the paths that prim ids index.
        time: USD time code.
        stage_from_world: ``(4, 4)`` float64, to the stage's own units and up axis.
        lit_by: lights that it is drawn with.
        material_paths: the paths that material ids index.
        version: two scenes of equal versions show the same; None where nothing is known.
        splats: Gaussian splats, which are no surfaces: neither lit nor picked, and casting no shadows.
    """

    batches: tuple[Batch, ...] = ()
    lights: tuple[Light, ...] = ()
    dome: Dome | None = None
    prim_paths: tuple[str, ...] = ()
    time: float = 0.0
    stage_from_world: DoubleArray = field(default_factory=lambda: np.eye(4))
    lit_by: LitBy = "auto"
    material_paths: tuple[str, ...] = ()
    version: Hashable = None
    splats: tuple[SplatBatch, ...] = ()

    def seen_by(self, camera_path: str) -> Scene:
        """The scene as a camera sees it, without what only other cameras see; the same object where there is none of that."""
        seen = tuple(batch for batch in self.batches if batch.seen_by in (None, camera_path))
        return self if len(seen) == len(self.batches) else replace(self, batches=seen)

    @property
    def triangle_count(self) -> int:
        """Triangles drawn, instances counted."""
        return sum(len(b.geometry.triangles) * len(b.poses) for b in self.batches)
