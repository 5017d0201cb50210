"""Surface shaders of MaterialX as the lobes that surfaces have here: a diffuse, a specular, a coat, a sheen, a thin film."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class SurfaceShader:
    """Surface shader that is drawn.

    Attributes:
        definition: name of its nodedef in MaterialX's library.
        inputs: those that are read, in the order of the arguments of ``surface_<category>`` in ``layers/graph_surfaces.glsl``.
        lobes: inputs of which each adds what is not drawn, wherever it has another value than its default.
        opacity: inputs that make it partly transparent.
        opaque: the values of these at which it is opaque.
        coat: input that gives the amount of its clear coat, or None.
        metal: input that gives how much of it is metal, which lets nothing through, or None.
        tint: input that gives the colour of what comes through, or None.
        is_unlit: whether it only emits.
        color: input of its base colour, or of what it emits where it only emits.
        sheen: input that gives the amount of its sheen, or None.
        film: input that gives that of its thin film, or its thickness, or None.
        own: type and default of the inputs, by name, of a shader that is not of the library.
    """

    definition: str
    inputs: tuple[str, ...]
    lobes: tuple[str, ...] = ()
    opacity: tuple[str, ...] = ()
    opaque: tuple[float, ...] = ()
    coat: str | None = None
    metal: str | None = None
    tint: str | None = None
    is_unlit: bool = False
    color: str = "base_color"
    sheen: str | None = None
    film: str | None = None
    own: Mapping[str, tuple[str, str]] = field(default_factory=dict)


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


_LOBES = {
    "diffuse": ("color3", "0, 0, 0"),
    "f0": ("color3", "0, 0, 0"),
    "metal": ("color3", "0, 0, 0"),
    "roughness": ("float", "0"),
    "normal": ("vector3", ""),
    "coat": ("float", "0"),
    "coat_roughness": ("float", "0"),
    "through": ("color3", "0, 0, 0"),
    "through_weight": ("float", "0"),
    "emission": ("color3", "0, 0, 0"),
    "opacity": ("float", "1"),
    "sheen": ("color3", "0, 0, 0"),
    "sheen_weight": ("float", "0"),
    "sheen_roughness": ("float", "0.3"),
    "is_fuzz": ("float", "0"),
    "film_nm": ("float", "0"),
    "film_ior": ("float", "1.5"),
}
"""Inputs of what `render.stage.materials.mtlx.lobes` makes of a ``surface``."""

MIXED = "mixed_surface"
"""Category of what `render.stage.materials.mtlx.mixes` makes of a mix of surfaces."""

SURFACES: dict[str, SurfaceShader] = {
    MIXED: SurfaceShader(
        "",
        ("bg", "fg", "share"),
        own={"bg": ("float", "0"), "fg": ("float", "0"), "share": ("float", "0")},
    ),
    "surface": SurfaceShader(
        "",
        tuple(_LOBES),
        (),
        ("opacity", "through"),
        (1.0, 0.0),
        "coat",
        color="diffuse",
        own=_LOBES,
        sheen="sheen",
        film="film_nm",
    ),
    "standard_surface": SurfaceShader(
        "ND_standard_surface_surfaceshader",
        _names(
            "base base_color metalness specular specular_color specular_roughness specular_IOR transmission "
            "transmission_color subsurface subsurface_color coat coat_color coat_roughness coat_IOR coat_affect_color "
            "emission emission_color opacity normal sheen sheen_color sheen_roughness thin_film_thickness thin_film_IOR"
        ),
        _names(
            "diffuse_roughness specular_anisotropy transmission_scatter transmission_dispersion "
            "transmission_extra_roughness coat_anisotropy coat_affect_roughness"
        ),
        ("opacity", "transmission"),
        (1.0, 0.0),
        "coat",
        "metalness",
        "transmission_color",
        sheen="sheen",
        film="thin_film_thickness",
    ),
    "open_pbr_surface": SurfaceShader(
        "ND_open_pbr_surface_surfaceshader",
        _names(
            "base_weight base_color base_metalness specular_weight specular_color specular_roughness specular_ior "
            "transmission_weight transmission_color subsurface_weight subsurface_color coat_weight coat_color "
            "coat_roughness coat_ior emission_luminance emission_color geometry_opacity geometry_normal "
            "fuzz_weight fuzz_color fuzz_roughness thin_film_weight thin_film_thickness thin_film_ior"
        ),
        _names(
            "base_diffuse_roughness specular_roughness_anisotropy transmission_scatter "
            "transmission_dispersion_scale coat_roughness_anisotropy"
        ),
        ("geometry_opacity", "transmission_weight"),
        (1.0, 0.0),
        "coat_weight",
        "base_metalness",
        "transmission_color",
        sheen="fuzz_weight",
        film="thin_film_weight",
    ),
    "gltf_pbr": SurfaceShader(
        "ND_gltf_pbr_surfaceshader",
        _names(
            "base_color metallic roughness normal occlusion transmission specular specular_color ior alpha alpha_mode "
            "alpha_cutoff clearcoat clearcoat_roughness emissive emissive_strength sheen_color sheen_roughness "
            "iridescence iridescence_ior iridescence_thickness"
        ),
        _names("anisotropy_strength dispersion"),
        ("alpha", "transmission"),
        (1.0, 0.0),
        "clearcoat",
        "metallic",
        "base_color",
        sheen="sheen_color",
        film="iridescence",
    ),
    "UsdPreviewSurface": SurfaceShader(
        "ND_UsdPreviewSurface_surfaceshader",
        _names(
            "diffuseColor emissiveColor useSpecularWorkflow specularColor metallic roughness clearcoat clearcoatRoughness "
            "opacity opacityMode opacityThreshold ior normal occlusion"
        ),
        ("displacement",),
        ("opacity",),
        (1.0,),
        "clearcoat",
        color="diffuseColor",
    ),
    "disney_principled": SurfaceShader(
        "ND_disney_principled",
        _names("baseColor metallic roughness specular specularTint clearcoat clearcoatGloss specTrans sheen sheenTint"),
        _names("anisotropic subsurface"),
        ("specTrans",),
        (0.0,),
        "clearcoat",
        "metallic",
        "baseColor",
        color="baseColor",
        sheen="sheen",
    ),
    "surface_unlit": SurfaceShader(
        "ND_surface_unlit",
        _names("emission emission_color transmission transmission_color opacity"),
        (),
        ("opacity", "transmission"),
        (1.0, 0.0),
        tint="transmission_color",
        is_unlit=True,
        color="emission_color",
    ),
}
"""By category. Each definition gives types and defaults."""
