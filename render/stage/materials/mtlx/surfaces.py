"""Surface shaders of MaterialX as the lobes that surfaces have here: one diffuse, one specular, one clear coat."""

from __future__ import annotations

from dataclasses import dataclass


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


def _names(text: str) -> tuple[str, ...]:
    return tuple(text.split())


SURFACES: dict[str, SurfaceShader] = {
    "standard_surface": SurfaceShader(
        "ND_standard_surface_surfaceshader",
        _names(
            "base base_color metalness specular specular_color specular_roughness specular_IOR transmission "
            "transmission_color subsurface subsurface_color coat coat_color coat_roughness coat_IOR coat_affect_color "
            "emission emission_color opacity normal"
        ),
        _names(
            "diffuse_roughness specular_anisotropy transmission_scatter transmission_dispersion "
            "transmission_extra_roughness sheen coat_anisotropy coat_affect_roughness thin_film_thickness"
        ),
        ("opacity", "transmission"),
        (1.0, 0.0),
        "coat",
        "metalness",
        "transmission_color",
    ),
    "open_pbr_surface": SurfaceShader(
        "ND_open_pbr_surface_surfaceshader",
        _names(
            "base_weight base_color base_metalness specular_weight specular_color specular_roughness specular_ior "
            "transmission_weight transmission_color subsurface_weight subsurface_color coat_weight coat_color "
            "coat_roughness coat_ior emission_luminance emission_color geometry_opacity geometry_normal"
        ),
        _names(
            "base_diffuse_roughness specular_roughness_anisotropy transmission_scatter "
            "transmission_dispersion_scale fuzz_weight coat_roughness_anisotropy thin_film_weight"
        ),
        ("geometry_opacity", "transmission_weight"),
        (1.0, 0.0),
        "coat_weight",
        "base_metalness",
        "transmission_color",
    ),
    "gltf_pbr": SurfaceShader(
        "ND_gltf_pbr_surfaceshader",
        _names(
            "base_color metallic roughness normal occlusion transmission specular specular_color ior alpha alpha_mode "
            "alpha_cutoff clearcoat clearcoat_roughness emissive emissive_strength"
        ),
        _names("iridescence sheen_color anisotropy_strength dispersion"),
        ("alpha", "transmission"),
        (1.0, 0.0),
        "clearcoat",
        "metallic",
        "base_color",
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
    ),
    "disney_principled": SurfaceShader(
        "ND_disney_principled",
        _names("baseColor metallic roughness specular specularTint clearcoat clearcoatGloss specTrans"),
        _names("anisotropic sheen subsurface"),
        ("specTrans",),
        (0.0,),
        "clearcoat",
        "metallic",
        "baseColor",
    ),
    "surface_unlit": SurfaceShader(
        "ND_surface_unlit",
        _names("emission emission_color transmission transmission_color opacity"),
        (),
        ("opacity", "transmission"),
        (1.0, 0.0),
        tint="transmission_color",
        is_unlit=True,
    ),
}
"""By category. Each definition gives types and defaults."""
