"""Stages that are sound USD, with numbers and indices that no shot has."""

from __future__ import annotations

from collections.abc import Iterator

from tests.service.conftest import ROOM

NUMBERS = ("nan", "inf", "-inf", "-1e300", "1e18", "0", "-1")
INDICES = (2**31 - 1, -7, 0)
LAYER_NUMBERS = {"startTimeCode": 1, "endTimeCode": 24, "timeCodesPerSecond": 24, "metersPerUnit": 1}
CAMERA_NUMBERS = ("focalLength", "horizontalAperture", "verticalAperture", "fStop", "focusDistance")
IDENTITY = "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
COUNTS = "faceVertexCounts = [4]\n"
PRIMS_OF_NUMBERS = {
    "offset": "def 'A' (references = </World> (offset = N; scale = N)) {}",
    "sphere": "def Sphere 'S' { double radius = N }",
    "samples": "def Sphere 'S' { double radius.timeSamples = { N : 1, 2 : N } }",
    "light": "def SphereLight 'L' { float inputs:intensity = N; float inputs:radius = N }",
    "dome": "def DomeLight 'L' { float inputs:exposure = N; color3f inputs:color = (N, N, N) }",
    "matrix": "def Sphere 'S' { matrix4d xformOp:transform = ((N, 0, 0, 0), (0, N, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))"
    "; uniform token[] xformOpOrder = ['xformOp:transform'] }",
    "curves": "def BasisCurves 'C' { int[] curveVertexCounts = [2]; point3f[] points = [(0, 0, -3), (N, 0, -3)]"
    "; float[] widths = [N]; uniform token type = 'linear' }",
    "places": "def PointInstancer 'I' { rel prototypes = [</World/near>]; int[] protoIndices = [0, 0]"
    "; point3f[] positions = [(N, N, N), (0, 0, 0)]; float3[] scales = [(N, N, N), (1, 1, 1)]"
    "; vector3f[] velocities = [(N, N, N), (1, 1, 1)] }",
}
"""Prims in which N stands for a number, ; for the end of a line and ' for "."""
PRIMS_OF_INDICES = {
    "primvar": "def Mesh 'M' { int[] faceVertexCounts = [3]; int[] faceVertexIndices = [0, 1, 2]"
    "; point3f[] points = [(0, 0, -3), (1, 0, -3), (0, 1, -3)]"
    "; color3f[] primvars:displayColor = [(1, 0, 0)] ( interpolation = 'vertex' )"
    "; int[] primvars:displayColor:indices = [0, N, 0] }",
    "curves": "def BasisCurves 'C' { int[] curveVertexCounts = [N, N]; point3f[] points = [(0, 0, -3), (1, 0, -3)]"
    "; float[] widths = [1] }",
    "instancer": "def PointInstancer 'I' { rel prototypes = [</World/near>]; int[] protoIndices = [N]"
    "; point3f[] positions = [(0, 0, 0)]; int64[] invisibleIds = [N] }",
    "lengths": "def PointInstancer 'I' { rel prototypes = [</World/near>]; int[] protoIndices = [0, N]"
    "; point3f[] positions = [(0, 0, 0)]; quath[] orientations = [(0, 0, 0, 0)]; float3[] scales = [] }",
    "joints": "def SkelRoot 'R' (apiSchemas = ['SkelBindingAPI']) { def Skeleton 'S' {"
    f" uniform token[] joints = ['a', 'a/b/c', 'a/b']; uniform matrix4d[] bindTransforms = [{IDENTITY}]"
    f"; uniform matrix4d[] restTransforms = [{IDENTITY}, {IDENTITY}] }}"
    "; def Mesh 'M' (apiSchemas = ['SkelBindingAPI']) { int[] faceVertexCounts = [3]; int[] faceVertexIndices = [0, 1, 2]"
    "; point3f[] points = [(0, 0, -3), (1, 0, -3), (0, 1, -3)]; rel skel:skeleton = </R/S>"
    "; int[] primvars:skel:jointIndices = [N, 0, 0] ( elementSize = 1; interpolation = 'vertex' )"
    "; float[] primvars:skel:jointWeights = [nan, 1, inf] ( elementSize = 1; interpolation = 'vertex' ) } }",
}
MESH_PARTS = {
    "holes": "int[] holeIndices = [N]",
    "subset": "def GeomSubset 'g' { uniform token elementType = 'face'; int[] indices = [N] }",
    "crease": "int[] creaseIndices = [0, N]; int[] creaseLengths = [N]; float[] creaseSharpnesses = [1e30]",
    "normals": "normal3f[] primvars:normals = [(0, 0, 1)]; int[] primvars:normals:indices = [N]",
    "extent": "float3[] extent = [(N, N, N)]",
}


def absurd_numbers() -> Iterator[tuple[str, str]]:
    """Name and text of each stage."""
    for number in NUMBERS:
        for name, usual in LAYER_NUMBERS.items():
            yield f"{name}-{number}", ROOM.replace(f" {name} = {usual}\n", f" {name} = {number}\n")
        for name in CAMERA_NUMBERS:
            yield f"{name}-{number}", _camera(name, number)
        for group in ("shutter:open N shutter:close N", "exposure:time N exposure:iso N exposure:fStop N"):
            name, lines = group.partition(":")[0], group.replace("N", f"= {number}\n").split("\n")
            kind = "double" if name == "shutter" else "float"
            yield f"{name}-{number}", _camera("fStop", "1.4\n" + "\n".join(f"{kind} {line}" for line in lines if line))
        yield f"clippingRange-{number}", ROOM.replace("(0.1, 100)", f"({number}, {number})")
        yield f"points-{number}", ROOM.replace("(-1, -0.6, -3)", f"({number}, {number}, {number})")
        for name, prim in PRIMS_OF_NUMBERS.items():
            yield f"{name}-{number}", ROOM + usda(prim, number)
    for index in INDICES:
        yield f"index-{index}", ROOM.replace("[0, 1, 2, 3]", f"[0, 1, 2, {index}]")
        yield f"count-{index}", ROOM.replace(COUNTS, f"faceVertexCounts = [{index}]\n")
        for name, part in MESH_PARTS.items():
            yield f"{name}-{index}", ROOM.replace(COUNTS, COUNTS + usda(part, index))
        for name, prim in PRIMS_OF_INDICES.items():
            yield f"{name}-{index}", ROOM + usda(prim, index)


def usda(text: str, number: object = 0) -> str:
    """Text of prims, written on one line with N for a number, ``'`` for ``"`` and ``;`` between lines."""
    words = [str(number) if word == "N" else word for word in _words(text)]
    whole = "".join(words).replace("'", '"').replace("; ", "\n")
    return whole.replace("{ ", "{\n").replace(" }", "\n}") + "\n"


def _words(text: str) -> list[str]:
    """Split a text at each N that stands alone."""
    padded = "".join(letter if letter.isalnum() or letter in "_:" else f"\0{letter}\0" for letter in text)
    return padded.split("\0")


def _camera(name: str, value: str) -> str:
    """The room with another value of its camera."""
    before, _, rest = ROOM.partition(f"float {name} = ")
    return f"{before}float {name} = {value}\n{rest.partition(chr(10))[2]}"
