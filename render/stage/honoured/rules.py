"""Rules: which properties of which schemas are honoured, and why others change nothing.

A property that no rule mentions is not honoured, and neither is a schema without rules: properties of later versions of
OpenUSD are so named by `inspect` until somebody decides about them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from usd_schemas import HydraDistortion
from usd_schemas.binding import property_names

EVERYTHING = "*"


Status = Literal["honoured", "neutral", "ignored", "named"]


@dataclass(frozen=True)
class Ruling:
    """Ruling on one property.

    Attributes:
        status: one of `Status`.
        text: what `Rules` says about that status.
    """

    status: Status
    text: str = ""


@dataclass(frozen=True)
class Rules:
    """Rules for the properties of one schema, given by name; several names are separated by spaces.

    Names of multiple-apply schemas are without the instance's: ``collection:excludes`` for ``collection:lightLink:excludes``.

    Attributes:
        honoured: read and obeyed; `EVERYTHING` for all that are not mentioned otherwise.
        neutral: without effect on any picture, with the reason.
        ignored: not honoured, with what is drawn instead.
        named: not honoured, with the code of the finding that the reader makes of it.
    """

    honoured: str = ""
    neutral: Mapping[str, str] = field(default_factory=dict)
    ignored: Mapping[str, str] = field(default_factory=dict)
    named: Mapping[str, str] = field(default_factory=dict)

    def ruling(self, name: str) -> Ruling | None:
        """The ruling on a property, or None where it is not mentioned.

        Args:
            name: of the property, without an instance's.
        """
        mentions: dict[Status, Mapping[str, str]] = {
            "neutral": self.neutral,
            "ignored": self.ignored,
            "named": self.named,
        }
        for status, texts in mentions.items():
            for names, text in texts.items():
                if name in names.split():
                    return Ruling(status, text)
        return Ruling("honoured") if {name, EVERYTHING} & set(self.honoured.split()) else None


NEUTRAL_PLUGINS = {
    "usdMedia": "sound, previews and authorship",
    "usdPhysics": "input of simulations; their results are in transforms and points",
    "UsdProfiles": "claims about the file",
    "usdRi": "for RenderMan alone",
    "usdSemantics": "labels for training of classifiers",
    "usdUI": "for user interfaces",
}
"""Plugins of OpenUSD none of whose schemas has an effect on pictures, with the reason."""

FILTER_TYPES = (
    "PxrIntMultLightFilter",
    "PxrBarnLightFilter",
    "PxrRampLightFilter",
    "PxrRodLightFilter",
    "PxrBlockerLightFilter",
    "PxrGoboLightFilter",
    "PxrCookieLightFilter",
)
"""Types of light filters that USD does not know; the reader of lights honours or names them, where a light does."""

NAMED_SCHEMAS = {
    "Gprim": "unsupported_geometry",
    "GenerativeProcedural": "unsupported_geometry",
    "BoundableLightBase": "unsupported_light",
    "NonboundableLightBase": "unsupported_light",
    "PluginLight": "unsupported_light",
    "VolumeLightAPI": "unsupported_light",
}
"""Schemas without rules of their own, or bases of such, with the code of the finding that the reader makes of their prims."""

IGNORED_SCHEMAS = {
    "PluginLightFilter": "light is not filtered",
    "VisibilityAPI": "visibility and purpose alone decide",
}
"""Schemas without rules, each with what is drawn instead."""

_CONE = "inputs:shaping:cone:angle inputs:shaping:cone:softness inputs:shaping:focus inputs:shaping:focusTint"
_PROFILE = "inputs:shaping:ies:angleScale inputs:shaping:ies:file inputs:shaping:ies:normalize"
_LIGHT = "inputs:color inputs:colorTemperature inputs:enableColorTemperature inputs:exposure inputs:intensity inputs:normalize"
_MULTIPLIERS = "inputs:diffuse inputs:specular"
_WHICH = "collection:excludes collection:expansionRule collection:includeRoot collection:membershipExpression collection:mode"

RULES = {
    "Imageable": Rules("visibility purpose", neutral={"proxyPrim": "for programs that swap prims"}),
    "Xformable": Rules("xformOpOrder"),
    "Boundable": Rules("extent"),
    "Scope": Rules(),
    "ColorSpaceAPI": Rules("colorSpace:name"),
    "ColorSpaceDefinitionAPI": Rules(EVERYTHING),
    "Xform": Rules(),
    "Gprim": Rules("doubleSided primvars:displayColor primvars:displayOpacity"),
    "PointBased": Rules("points normals velocities accelerations"),
    "Mesh": Rules(
        "faceVertexCounts faceVertexIndices holeIndices orientation subdivisionScheme cornerIndices cornerSharpnesses "
        "creaseIndices creaseLengths creaseSharpnesses interpolateBoundary faceVaryingLinearInterpolation "
        "triangleSubdivisionRule",
    ),
    "BasisCurves": Rules("basis type wrap"),
    "Curves": Rules("curveVertexCounts widths"),
    "NurbsCurves": Rules("knots order pointWeights ranges"),
    "NurbsPatch": Rules(
        "pointWeights uForm uKnots uOrder uRange uVertexCount vForm vKnots vOrder vRange vVertexCount trimCurve:counts "
        "trimCurve:knots trimCurve:orders trimCurve:points trimCurve:ranges trimCurve:vertexCounts"
    ),
    "HermiteCurves": Rules("tangents"),
    "Points": Rules("widths", neutral={"ids": "names of points for programs that follow them"}),
    "ParticleField3DGaussianSplat": Rules(
        "opacities opacitiesh orientations orientationsh positions positionsh radiance:sphericalHarmonicsCoefficients "
        "radiance:sphericalHarmonicsCoefficientsh radiance:sphericalHarmonicsDegree scales scalesh",
        neutral={"doubleSided orientation": "splats have no sides"},
        ignored={
            "primvars:displayColor primvars:displayOpacity": "splats have colours and opacities of their own",
            "projectionModeHint": "splats are projected by perspective",
            "sortingModeHint": "splats are sorted by their depth",
        },
    ),
    "TetMesh": Rules("orientation surfaceFaceVertexIndices tetVertexIndices"),
    "Capsule": Rules("axis height radius"),
    "Capsule_1": Rules("axis height radiusBottom radiusTop"),
    "Cone": Rules("axis height radius"),
    "Cube": Rules("size"),
    "Cylinder": Rules("axis height radius"),
    "Cylinder_1": Rules("axis height radiusBottom radiusTop"),
    "Plane": Rules("axis length width"),
    "Sphere": Rules("radius"),
    "GeomSubset": Rules("elementType familyName indices"),
    "PointInstancer": Rules(
        "accelerations angularVelocities ids invisibleIds orientations orientationsf positions protoIndices prototypes "
        "scales velocities"
    ),
    "GeomModelAPI": Rules(EVERYTHING),
    "LODRootAPI": Rules("lod:default:index lod:heuristics"),
    "LODOverrideAPI": Rules("lod:override:mode lod:override:index"),
    "LODHeuristic": Rules("lod:domain"),
    "LODDistanceHeuristic": Rules("center boundingVolume thresholds blendThresholds"),
    "LODScreenSizeHeuristic": Rules("extent boundingVolume projectionMethod thresholds blendThresholds"),
    "MotionAPI": Rules(
        ignored={
            "motion:blurScale": "motion is blurred as long as the shutter is open",
            "motion:nonlinearSampleCount": "the number of moments is a setting of the picture",
            "motion:velocityScale": "velocities are not scaled",
        }
    ),
    "Camera": Rules(
        "clippingPlanes clippingRange exposure exposure:fStop exposure:iso exposure:responsivity exposure:time fStop "
        "focalLength focusDistance horizontalAperture horizontalApertureOffset projection shutter:close shutter:open "
        "stereoRole verticalAperture verticalApertureOffset",
    ),
    "LensCamera": Rules(),
    "BackPlateAPI": Rules(EVERYTHING),
    "ApertureAPI": Rules(EVERYTHING),
    "FilmAPI": Rules(EVERYTHING),
    "FocusAPI": Rules(EVERYTHING),
    "FocusPointAPI": Rules(EVERYTHING),
    "LensAPI": Rules(
        EVERYTHING,
        ignored={
            "lens:entrancePupilOffset": "the camera's position is the entrance pupil",
            " ".join(property_names(HydraDistortion)): "distortion is that of the lens:* properties",
        },
    ),
    "TiltShiftAPI": Rules(EVERYTHING),
    "LightAPI": Rules(
        f"{_LIGHT} {_MULTIPLIERS} light:filters",
        ignored={
            "light:materialSyncMode": "a mesh that shines is drawn with its material, and its light has its own colour",
            "light:shaderId": "the prim's type decides",
        },
    ),
    "LightFilter": Rules("lightFilter:shaderId"),
    "CollectionAPI:filterLink": Rules(EVERYTHING),
    "CollectionAPI:lightLink": Rules(EVERYTHING),
    "CollectionAPI:shadowLink": Rules(EVERYTHING),
    "CollectionAPI": Rules(neutral={f"collection collection:includes {_WHICH}": "a set for other properties to name"}),
    "ShadowAPI": Rules(EVERYTHING),
    "ShapingAPI": Rules(f"{_CONE} {_PROFILE}"),
    "DiskLight": Rules("inputs:radius"),
    "DistantLight": Rules(
        "inputs:angle",
        ignored={f"{_CONE} {_PROFILE}": "a distant light has no cone"},
    ),
    "CylinderLight": Rules(
        "inputs:length inputs:radius", neutral={"treatAsLine": "allows a renderer to be less exact"}
    ),
    "GeometryLight": Rules("geometry"),
    "MeshLightAPI": Rules(),
    "PortalLight": Rules(
        neutral={
            f"inputs:height inputs:width {_LIGHT} {_MULTIPLIERS}": "guides the sampling of a dome, which is not sampled",
        }
    ),
    "RectLight": Rules("inputs:height inputs:texture:file inputs:width"),
    "SphereLight": Rules("inputs:radius", neutral={"treatAsPoint": "allows a renderer to be less exact"}),
    "DomeLight": Rules(
        "inputs:diffuse inputs:specular inputs:texture:file inputs:texture:format",
        neutral={
            "guideRadius": "size of its outline in viewers",
            "inputs:normalize": "a dome has no area",
            "portals": "they guide the sampling of a dome, which is not sampled",
        },
        ignored={
            "inputs:shadow:color inputs:shadow:distance inputs:shadow:enable inputs:shadow:falloff inputs:shadow:falloffGamma": (
                "domes cast no shadows"
            ),
            f"{_CONE} {_PROFILE}": "a dome has no cone",
        },
    ),
    "LightListAPI": Rules(neutral={"lightList lightList:cacheBehavior": "all lights are found anyway"}),
    "ListAPI": Rules(neutral={"lightList lightList:cacheBehavior": "all lights are found anyway"}),
    "Material": Rules(
        "outputs:surface", ignored={"outputs:displacement": "that of UsdPreviewSurface alone is", "outputs:volume": ""}
    ),
    "MaterialBindingAPI": Rules(),
    "NodeGraph": Rules(),
    "Shader": Rules(),
    "NodeDefAPI": Rules("info:id", neutral={"info:implementationSource": "a shader without info:id is named"}),
    "CoordSysAPI": Rules(neutral={"coordSys:binding": "for shaders that name it, and none of those is honoured"}),
    "HydraPrimAPI": Rules(neutral={"hydra:expandInstances": "instances look the same"}),
    "SkelRoot": Rules(),
    "Skeleton": Rules("bindTransforms joints restTransforms", neutral={"jointNames": "names for users"}),
    "SkelAnimation": Rules("blendShapeWeights blendShapes joints rotations scales translations"),
    "SkelBindingAPI": Rules(EVERYTHING),
    "BlendShape": Rules("offsets pointIndices normalOffsets"),
    "RenderSettingsBase": Rules(
        "aspectRatioConformPolicy camera dataWindowNDC disableDepthOfField disableMotionBlur instantaneousShutter "
        "pixelAspectRatio resolution"
    ),
    "RenderSettings": Rules("includedPurposes materialBindingPurposes products renderingColorSpace"),
    "RenderProduct": Rules("orderedVars productName productType"),
    "RenderVar": Rules("dataType sourceName sourceType"),
    "RenderPass": Rules(
        "renderSource", neutral={"command fileName passType": "for programs that start other renderers by it"}
    ),
    "CollectionAPI:renderVisibility": Rules(EVERYTHING),
    "CollectionAPI:prune": Rules(EVERYTHING),
    "CollectionAPI:cameraVisibility": Rules(EVERYTHING),
    "CollectionAPI:matte": Rules(EVERYTHING),
}
"""Rules by schema: a type, a base of types, an API schema, or one instance of a multiple-apply schema.

For a property of a prim those of the prim's type come first, then those of its bases, then those of the API schema that
declares the property.
"""
RULES["DomeLight_1"] = Rules(
    f"{RULES['DomeLight'].honoured} poleAxis", RULES["DomeLight"].neutral, RULES["DomeLight"].ignored
)

NODE_RULES = {
    "UsdPreviewSurface": Rules(EVERYTHING),
}
"""Rules for the inputs of shader nodes; all inputs of other nodes are honoured, or the node is named as a whole."""
