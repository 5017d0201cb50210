"""Stages of a few kilobytes that are sound USD: loops, files of other kinds, and more of everything than anybody has."""

from __future__ import annotations

from collections.abc import Iterator

from tests.hostile.absurd_numbers import COUNTS, usda
from tests.service.conftest import ROOM

FILES = (
    "a.abc",
    "a.vdb",
    "a.mtlx",
    "a.gltf",
    "a.obj",
    "a.ply",
    "a.usd",
    "a.usdz[b.usda]",
    "a.usdz[../../etc/passwd]",
    "anon:0x1:a",
)
ARCS = ("references", "payload", "inherits", "specializes")
EXPRESSIONS = ('`"${A}"`', '`if(true, "/etc/passwd", "b")`', "`${A`", "`" + "if(true, " * 3000 + "`")
CLIP_RANGES = (
    ("-1e300", "1e300", "1"),
    ("nan", "nan", "nan"),
    ("0", "1e5", "1"),
    ("0", "10", "1e-300"),
    ("0", "inf", "1"),
)
CLIP_PATTERNS = ("c.#" + "#" * 5000 + ".usd", "/etc/###", "../###.usd", "###.###.###")
CLIPS = (
    "def 'W' (clips = { dictionary default = { string templateAssetPath = '{}'; double templateStartTime = {}"
    "; double templateEndTime = {}; double templateStride = {}; string primPath = '/W' } }) {}"
)
INSTANCER = (
    "def PointInstancer '{}' {{ rel prototypes = [{}]; int[] protoIndices = [{}]; point3f[] positions = [{}] }}\n"
)
COLLECTIONS = (
    "def 'A' (apiSchemas = ['CollectionAPI:x']) { rel collection:x:includes = [</B.collection:y>, </World>] }\n"
    "def 'B' (apiSchemas = ['CollectionAPI:y']) { rel collection:y:includes = [</A.collection:x>] }"
)
MATERIAL_LOOP = (
    "def Material 'M' { token outputs:surface.connect = </M/A.outputs:surface>"
    "; def Shader 'A' { uniform token info:id = 'UsdPreviewSurface'"
    "; color3f inputs:diffuseColor.connect = </M/B.outputs:rgb>; token outputs:surface }"
    "; def Shader 'B' { uniform token info:id = 'UsdUVTexture'; asset inputs:file.connect = </M/B.inputs:file>"
    "; float2 inputs:st.connect = </M/B.outputs:rgb>; float4 inputs:scale.connect = </M/B.outputs:rgb>"
    "; float3 outputs:rgb } }"
)
TILED = (
    "def Material 'm{0}' {{ token outputs:surface.connect = </m{0}/a.outputs:surface>"
    "; def Shader 't' {{ uniform token info:id = 'UsdUVTexture'; asset inputs:file = @a{0}.<UDIM>.png@; float3 outputs:rgb }}"
    "; def Shader 'a' {{ uniform token info:id = 'UsdPreviewSurface'"
    "; color3f inputs:diffuseColor.connect = </m{0}/t.outputs:rgb>; token outputs:surface }} }}\n"
)


def stage_attacks() -> Iterator[tuple[str, str]]:
    """Name and text of each stage."""
    for name, text in (*_loops(), *_files(), *_clips(), *_many()):
        yield name, text if text.startswith("#usda") else ROOM + usda(text)


def _loops() -> Iterator[tuple[str, str]]:
    for arc in ARCS:
        loop = "def 'A' (ARC = </B>) {}\ndef 'B' (ARC = </A>) {}\ndef 'C' (ARC = </C/D>) { def 'D' (ARC = </C>) {} }"
        yield f"loop/{arc}", loop.replace("ARC", arc)
    yield "loop/relationships", "".join(f"def 'R{i}' {{ rel x = </R{(i + 1) % 2000}.x> }}\n" for i in range(2000))
    bound = ROOM.replace(COUNTS, f"{COUNTS}rel material:binding = </M>\n")
    yield "loop/connections", bound + usda(MATERIAL_LOOP)
    yield "loop/collections", COLLECTIONS
    yield "loop/sublayers", ROOM.replace("(\n", "(\nsubLayers = [@a.usda@, @./a.usda@, @../a.usda@]\n", 1)


def _files() -> Iterator[tuple[str, str]]:
    for file in FILES:
        for arc in ("references", "payload"):
            yield f"file/{arc}-{file}", f"def 'A' ({arc} = @{file}@) {{}}"
            arguments = "SDF_FORMAT_ARGS:target=x&root=/etc/passwd"
            yield f"file/{arc}-{file}-arguments", f"def 'A' ({arc} = @{file}:{arguments}@) {{}}"
    variables = ROOM.replace("(\n", '(\nexpressionVariables = { string A = "`${A}`" }\n', 1)
    for expression in EXPRESSIONS:
        yield f"expression/{expression[:20]}", f'{variables}def "A" (references = @{expression}@) {{}}\n'
    field = "def OpenVDBAsset 'F' { asset filePath = @/etc/passwd@; token fieldName = 'x' }"
    yield "volume/vdb", f"def Volume 'V' {{ rel field:density = </F> }}\n{field}"


def _clips() -> Iterator[tuple[str, str]]:
    cases = [("./c.###.usd", *numbers) for numbers in CLIP_RANGES] + [
        (pattern, "0", "3", "1") for pattern in CLIP_PATTERNS
    ]
    for number, values in enumerate(cases):
        text = CLIPS
        for value in values:
            text = text.replace("{}", value, 1)
        yield f"clips/{number}", text


def _many() -> Iterator[tuple[str, str]]:
    zeros, places = ", ".join(["0"] * 2000), ", ".join(["(0, 0, -5)"] * 2000)
    nested = [INSTANCER.format(f"I{i}", f"</I{i + 1}>" if i < 5 else "</World/near>", zeros, places) for i in range(6)]
    yield "instancer/nested", "".join(nested)
    yield (
        "instancer/prototypes",
        INSTANCER.format("I", ", ".join(f"</World/x{i}>" for i in range(20_000)), "0", "(0, 0, 0)"),
    )
    for scheme in ("catmullClark", "loop", "bilinear", "nonsense"):
        yield f"mesh/{scheme}", ROOM.replace(COUNTS, f'{COUNTS}uniform token subdivisionScheme = "{scheme}"\n')
    linked = ", ".join(f"</World/x{i}>" for i in range(50_000))
    link = (
        "def SphereLight 'L' (apiSchemas = ['CollectionAPI:lightLink']) {{ rel collection:lightLink:includes = [{}] }}"
    )
    yield "links/prims", link.format(linked)
    yield "lights", "".join(f"def SphereLight 'L{i}' {{}}\n" for i in range(5000))
    yield "cameras", "".join(f"def Camera 'C{i}' {{}}\n" for i in range(20_000))
    sets = "".join(f"; variantSet 'v{i}' = {{ 'x' {{ def Sphere 's{i}' {{}} }}; 'y' {{}} }}" for i in range(300))
    names = ", ".join(f"'v{i}'" for i in range(300))
    yield "variants/sets", f"def 'V' (variantSets = [{names}]) {{{sets} }}"
    yield "names/prim", f"def Sphere '{'a' * 1_000_000}' {{}}"
    yield "names/camera", ROOM.replace('"cam"', f'"{"c" * 100_000}"')
    bound = "".join(
        f"def Sphere 's{i}' (apiSchemas = ['MaterialBindingAPI']) {{ rel material:binding = </m{i}> }}\n"
        for i in range(500)
    )
    yield "textures/tiles", bound + "".join(TILED.format(i) for i in range(500))
