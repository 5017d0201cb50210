"""The shaders are GLSL 4.50 as Khronos' reference compiler reads it, within the least that OpenGL 4.5 promises."""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.shaders import load_source
from render.lab.reference.scenes import spheres_over_checkerboard
from render.layers.materials import INPUTS
from render.model.lens import Lens
from render.trace.lens_fit import row_length
from render.trace.ray_buffers import _POINTS_ACROSS, _ROW_DEFINES
from tests.render.kits.compiled_shaders import (
    COMPILED,
    CompiledShaders,
    included_files,
    own_conditions,
    preprocess,
    shader_files,
)
from tests.render.kits.lenses import PLANAR

VALIDATOR = "glslangValidator"
# Least values that an implementation of OpenGL 4.5 may have (section 23, tables 23.53 to 23.66).
LEAST = {
    "MaxTextureImageUnits": 16,
    "MaxVertexTextureImageUnits": 16,
    "MaxComputeTextureImageUnits": 16,
    "MaxCombinedTextureImageUnits": 96,
    "MaxVertexAttribs": 16,
    "MaxDrawBuffers": 8,
    "MaxImageUnits": 8,
    "MaxComputeImageUniforms": 8,
    "MaxComputeWorkGroupSizeX": 1024,
    "MaxComputeWorkGroupSizeY": 1024,
    "MaxComputeWorkGroupSizeZ": 64,
    "MaxComputeUniformComponents": 512,
    "MaxVaryingComponents": 60,
}
GUARDS = {"#ifndef CARRIED"}  # against a second inclusion

_SURFACE: dict[str, int | float | str] = {
    "OPAQUE": 0.999,
    "MAX_HALF": 65000.0,
    "MAX_LIGHTS": 96,
    "MAX_SHADOW_MAPS": 36,
    "LEAST_OPACITY": 1e-6,
    "NORMAL_LOC": 1,
    "TEXCOORD_0_LOC": 2,
    "COLOR_0_LOC": 3,
    "INST_M_LOC": 4,
}
_MAPS: dict[str, int | float | str] = {f"HAS_{name.upper()}": 1 for name in INPUTS}
_MAPS |= {f"LOOKUP_{name.upper()}": number for number, name in enumerate(INPUTS)}
_MAPS |= {f"MAP_{name.upper()}": "sampler2D" for name in INPUTS}
_MAPS |= {f"PLACE_{name.upper()}": "uv" for name in INPUTS}
_FROM: dict[str, int | float | str] = {f"FROM_{name.upper()}": 3 for name in INPUTS}
_FROM |= {"VALUES_0_LOC": 5, "VALUES_1_LOC": 6, "INST_M_LOC": 7}
_TILED = _MAPS | {"TILED": 1} | {f"MAP_{name.upper()}": "sampler2DArray" for name in INPUTS}
_POINTS: dict[str, int | float | str] = {"POINTS_ACROSS": _POINTS_ACROSS}
_POLYNOMIAL = [
    {
        **_POINTS,
        "POLYNOMIAL_LENS": 1,
        **_ROW_DEFINES,
        "SLOPE_DEGREE": slope,
        "PUPIL_DEGREE": pupil,
        "ROW_VEC4": row_length(slope) // 4,
    }
    for slope in (5, 7, 13)
    for pupil in (3, 5)
]
_TRACED = ("EIGHT_LAYERS", "MAY_BE_TRANSLUCENT", "FOCAL_MAP", "SHAPED_IRIS", "CARRIED_CAMERA", "MOVERS")
OPTIONS: dict[str, list[tuple[dict[str, int | float | str], tuple[str, ...]]]] = {
    "layers/depth.frag": [
        (_SURFACE, ("PEEL", "FILL", "MAY_BE_TRANSPARENT")),
        (_SURFACE | {"PEEL": 1}, ("REACH", "MOTION", "FILL")),
        (_SURFACE | {"REST": 1, "MAY_BE_TRANSPARENT": 1}, ()),
        (_SURFACE | {"PEEL": 1, "REST": 1, "MAY_BE_TRANSPARENT": 1}, ("MOST_OPAQUE", "MOTION")),
        (_SURFACE | _MAPS | {"PEEL": 1, "MOTION": 1, "MOVES": 1, "MAY_BE_TRANSPARENT": 1}, ("REACH", "BENDS")),
    ],
    "layers/surface.frag": [
        *((_SURFACE | maps, ("UNLIT", "CLEARCOAT", "MOTION", "MAY_BE_TRANSPARENT", "LINKED")) for maps in ({}, _MAPS)),
        (_SURFACE | _TILED | {"MAY_BE_TRANSPARENT": 1}, ("UNLIT",)),
        (_SURFACE | _MAPS | _FROM | {f"PLACE_{name.upper()}": "value_pair(4)" for name in INPUTS}, ("UNLIT",)),
    ],
    "layers/surface.vert": [
        (_SURFACE, ()),
        (_SURFACE | {"MOVES": 1}, ("BENDS",)),
        (_SURFACE | _FROM, ("MOVES",)),
        (_SURFACE | {"CLIP_PLANES": 8}, ("MOVES", "INSTANCE_COLORS")),
    ],
    "layers/shade.comp": [
        (
            _SURFACE | {"LINK_SETS": 256, "MAX_FILTERS": 16, "RAMP_STEPS": 24},
            ("CLEARCOAT", "TUBES", "FOCUSED", "PROFILES", "FILTERED", "LINKED"),
        ),
        (_SURFACE | {"SOFT_SHADOWS": 1}, ("COLORED_SHADOWS", "TUBES")),
        (_SURFACE | {"GLOSS_LEVELS": 6}, ("CLEARCOAT",)),
    ],
    "layers/shade_list.comp": [({}, ("LINKED",))],
    "splats/opacity_bins.frag": [({"NUMBERED": 1}, ())],
    "splats/splat.frag": [({}, ("BETWEEN",)), ({"OWNERS": 1}, ("BETWEEN",))],
    "trace/accumulate.comp": [({}, ("SPLATS",)), ({"SPLATS": 1, "HELD_SPLATS": 1}, ())],
    "trace/trace.comp": [
        (_POINTS, ("BOUND_BY_RAYS", *_TRACED)),
        (_POINTS | {"SPLATS": 1}, ("EIGHT_LAYERS", "MAY_BE_TRANSLUCENT", "MOVERS", "CARRIED_CAMERA")),
        (_POINTS | {"SPLATS": 1, "MATTES": 1, "SLOTS": 16}, ("MAY_BE_TRANSLUCENT", "MOVERS", "DEEP", "HELD_SPLATS")),
        (_POINTS | {"BOUND_BY_RAYS": 1, "GRID_LENS": 1, "GRID_INSET": 0.9}, _TRACED),
        *((table, _TRACED) for table in _POLYNOMIAL),
        *((table | {"BOUND_BY_RAYS": 1}, ("SHAPED_IRIS", "CARRIED_CAMERA", "MOVERS")) for table in _POLYNOMIAL),
    ],
}
"""Options that are always set together with constants, and those that are set or not, of each program."""

pytestmark = pytest.mark.last


@pytest.fixture(scope="module")
def validator(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Command of the validator, with the least limits."""
    if shutil.which(VALIDATOR) is None:
        pytest.skip(f"{VALIDATOR} is missing (Debian: glslang-tools)")
    defaults = subprocess.run([VALIDATOR, "-c"], capture_output=True, text=True, check=True).stdout
    limits = dict(line.split() for line in defaults.splitlines() if len(line.split()) == 2)
    assert set(LEAST) <= set(limits)
    config = tmp_path_factory.mktemp("limits") / "opengl_4_5.conf"
    config.write_text("".join(f"{name} {LEAST.get(name, value)}\n" for name, value in limits.items()))
    return [VALIDATOR, str(config)]


def complaints(validator: list[str], files: list[Path], *options: str) -> list[str]:
    """Errors and warnings of the validator about files, one line each."""
    run = subprocess.run([*validator, *options, *map(str, files)], capture_output=True, text=True)
    found = [line for line in run.stdout.splitlines() if re.match(r"(ERROR|WARNING|INTERNAL)", line)]
    return found or ([f"exit status {run.returncode}: {run.stderr}"] if run.returncode else [])


@pytest.mark.gl
def test_each_compiled_variant_is_valid_glsl(renderer: FrameRenderer, validator: list[str], tmp_path: Path) -> None:
    """Each variant that a test of this run has compiled; alone, this test compiles some."""
    scene, camera = spheres_over_checkerboard()
    for engine in ("lens", "flag", "scatter", "linear", "gather"):
        renderer.render(scene, camera, FrameSettings(48, 32, rays=4, supersample=1, engine=engine))
    renderer.render(
        scene,
        replace(camera, lens=Lens(model="prescription", prescription=PLANAR.prescription)),
        FrameSettings(48, 32, rays=4, supersample=1),
    )
    files = []
    for stage, sources in COMPILED.sources.items():
        for number, source in enumerate(sorted(sources)):
            files.append(tmp_path / f"{number}.{stage}")
            files[-1].write_text(source.strip())
    assert len(files) > 20
    assert complaints(validator, files) == []


@pytest.mark.parametrize("name", sorted(OPTIONS))
def test_combinations_of_options_are_valid(name: str, validator: list[str], tmp_path: Path) -> None:
    """All combinations of the options of the largest programs, also those that no test draws with."""
    files = []
    for fixed, free in OPTIONS[name]:
        for chosen in itertools.product((False, True), repeat=len(free)):
            defines = fixed | {option: 1 for option, is_on in zip(free, chosen, strict=True) if is_on}
            files.append(tmp_path / f"{len(files)}.{name.rpartition('.')[2]}")
            files[-1].write_text(load_source(name, defines))
    assert complaints(validator, files) == []


@pytest.mark.gl
def test_stages_of_each_program_fit_together(validator: list[str], tmp_path: Path) -> None:
    def link(number: int, sources: tuple[str, str]) -> list[str]:
        files = [tmp_path / f"{number}.vert", tmp_path / f"{number}.frag"]
        for file, source in zip(files, sources, strict=True):
            file.write_text(source.strip())
        return complaints(validator, files, "-l")

    with ThreadPoolExecutor(os.cpu_count()) as pool:  # the validator links one program at a time
        found = pool.map(link, itertools.count(), sorted(COMPILED.pairs))
    assert [line for lines in found for line in lines] == []


def test_the_validator_keeps_to_the_least_limits(validator: list[str], tmp_path: Path) -> None:
    """Drivers have more texture units than they must, and compile this."""
    source = (
        "#version 450 core\nlayout(binding = {}) uniform sampler2D map;\nout vec4 color;\n"
        "void main() {{ color = texture(map, vec2(0.5)); }}\n"
    )
    file = tmp_path / "unit.frag"
    for unit, is_right in ((95, True), (96, False)):
        file.write_text(source.format(unit))
        assert (complaints(validator, [file]) == []) == is_right


def test_each_branch_of_each_shader_is_compiled(pytestconfig: pytest.Config) -> None:
    """Every condition of the preprocessor in every file holds in one compiled program and not in another."""
    options = pytestconfig.option
    is_narrowed = options.keyword or (options.markexpr and not options.compiled_shaders)
    if pytestconfig.args_source is not pytest.Config.ArgsSource.TESTPATHS or is_narrowed:
        pytest.skip("only a run of all tests compiles all variants")
    seen: dict[str, set[tuple[str, bool]]] = {}
    for program in shader_files():
        sources = COMPILED.of_file(program)
        branches = {branch for source in sources for branch in preprocess(source).branches}
        for file in included_files(program) if sources else ():
            conditions = own_conditions(file)
            seen.setdefault(file, set()).update(branch for branch in branches if branch[0] in conditions)
        assert sources, f"{program} is never compiled"
    missing = [
        f"{file}: {condition} is never {holds}"
        for file, branches in sorted(seen.items())
        for condition in sorted(own_conditions(file) - GUARDS)
        for holds in (False, True)
        if (condition, holds) not in branches
    ]
    assert missing == []


def test_programs_of_other_processes_count_too(tmp_path: Path) -> None:
    one, other, both = CompiledShaders(), CompiledShaders(), CompiledShaders()
    one.add_compute("a")
    other.add_compute("b")
    other.add_pair("c", "d")
    for number, compiled in enumerate((one, other)):
        compiled.write(tmp_path / f"{number}.json")
        both.read(tmp_path / f"{number}.json")
    assert both == CompiledShaders({"vert": {"c"}, "frag": {"d"}, "comp": {"a", "b"}}, {("c", "d")})
