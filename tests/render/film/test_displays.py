"""Our pictures are OpenColorIO's: the same chart, by the same display and view, in other tools gives the same numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import PyOpenColorIO
import pytest

from render.colour import to_working
from render.errors import InputError, SettingsError
from render.film import Cdl, Grade, develop, list_looks, project
from tests.render.kits.colours import LOOK_WITH_A_FILE, OWN_CONFIG, chart
from usd_schemas.settings import Asset, GradeData

ACES_2 = "ocio://cg-config-v4.0.0_aces-v2.0_ocio-v2.5"  # built into OpenImageIO's own OpenColorIO, too
ACES_1 = "ocio://studio-config-v2.1.0_aces-v1.3_ocio-v2.3"
DISPLAYS = [
    (ACES_2, "sRGB - Display", "ACES 2.0 - SDR 100 nits (Rec.709)"),
    (ACES_2, "Rec.1886 Rec.709 - Display", "ACES 2.0 - SDR 100 nits (Rec.709)"),
    (ACES_2, "P3-D65 - Display", "ACES 2.0 - SDR 100 nits (P3 D65)"),
    (ACES_2, "Rec.2100-PQ - Display", "ACES 2.0 - HDR 1000 nits (P3 D65)"),
    (ACES_2, "Display P3 - Display", "Un-tone-mapped"),
    (ACES_1, "sRGB - Display", "ACES 1.0 - SDR Video"),
]


@pytest.mark.parametrize(("config", "display", "view"), DISPLAYS)
def test_a_picture_is_what_openimageio_makes_of_the_chart(config: str, display: str, view: str) -> None:
    source = OpenImageIO.ImageBuf(chart())

    shown = OpenImageIO.ImageBufAlgo.ociodisplay(source, display, view, "ACEScg", colorconfig=config)

    assert not shown.has_error, shown.geterror()
    expected = np.clip(shown.get_pixels(OpenImageIO.FLOAT), 0, 1)
    np.testing.assert_allclose(develop(chart(), 1.0, Grade(config, display, view)), expected, atol=1e-5)


@pytest.mark.parametrize(("config", "display", "view"), DISPLAYS)
def test_a_graded_picture_is_that_of_ocios_viewing_pipeline(config: str, display: str, view: str) -> None:
    cdl = Cdl((1.1, 0.95, 0.9), (0.02, 0.0, -0.01), (1.0, 1.05, 1.1), 0.8)
    looks = list_looks(config)[0]

    graded = develop(chart(), 1.0, Grade(config, display, view, looks, cdl))

    np.testing.assert_allclose(graded, np.clip(viewed(config, display, view, looks, cdl), 0, 1), atol=1e-5)
    assert np.abs(graded - develop(chart(), 1.0, Grade(config, display, view))).max() > 0.05


def viewed(config: str, display: str, view: str, looks: str, cdl: Cdl) -> np.ndarray:
    """The chart by OpenColorIO's pipeline of ``ociodisplay`` and of viewers in compositing tools."""
    pipeline = PyOpenColorIO.LegacyViewingPipeline()
    pipeline.setDisplayViewTransform(PyOpenColorIO.DisplayViewTransform(src="scene_linear", display=display, view=view))
    pipeline.setColorTimingCC(PyOpenColorIO.CDLTransform(cdl.slope, cdl.offset, cdl.power, cdl.saturation))
    pipeline.setLooksOverrideEnabled(True)
    pipeline.setLooksOverride(looks)
    pixels = chart()
    read = PyOpenColorIO.Config.CreateFromFile(config)
    pipeline.getProcessor(read).getDefaultCPUProcessor().applyRGB(pixels)
    return pixels


def test_the_cdl_works_in_the_space_for_timing_colours() -> None:
    """One printer stop of ACEScct: an offset of 1/17.52 doubles what light there is (S-2016-001, section 4.4)."""
    doubled = Cdl(offset=(1 / 17.52,) * 3)
    light = chart()[:1, 18:30]

    np.testing.assert_allclose(develop(light, 1.0, Grade(cdl=doubled)), develop(light, 2.0, Grade()), atol=2e-5)


def test_without_a_space_for_timing_the_cdl_works_on_light_itself(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    light = np.full((1, 1, 3), 0.25, np.float32)

    graded = develop(light, 1.0, Grade(str(file), cdl=Cdl((2, 1, 1), (0, 0.25, 0), (1, 1, 2))))

    np.testing.assert_allclose(graded, [[[0.5, 0.5, 0.0625]]], rtol=5e-5)  # OpenColorIO's quick powers


def test_saturation_zero_leaves_luma_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    monkeypatch.setenv("OCIO", str(file))
    light = np.array([[[0.5, 0.25, 0.125]]], np.float32)

    grey = develop(light, 1.0, Grade(cdl=Cdl(saturation=0)))

    np.testing.assert_allclose(grey, 0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722 * 0.125, atol=1e-6)


def srgb(light: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def test_a_print_is_shown_as_it_measures() -> None:
    """Full light is the display's white, and sRGB's curve is all that lies between light and code value."""
    wedge = np.repeat(np.linspace(0, 1, 21, dtype=np.float32), 3).reshape(1, 21, 3)

    np.testing.assert_allclose(project(wedge, Grade(), "lin_rec709"), srgb(wedge), atol=2e-5)


@pytest.mark.parametrize(
    ("display", "view", "white"),
    [
        ("sRGB - Display", None, 1.0),
        ("Gamma 2.6 P3-D65 - Display", None, 1.0),
        ("Rec.2100-PQ - Display", None, 0.508078),  # 100 cd/m² in SMPTE ST 2084
    ],
)
def test_a_prints_white_is_that_of_each_display(display: str, view: str | None, white: float) -> None:
    clear = np.ones((1, 1, 3), np.float32)

    np.testing.assert_allclose(project(clear, Grade(display=display, view=view), "ACEScg"), white, atol=1e-4)


def test_a_prints_colours_are_the_same_light_on_every_display() -> None:
    """A green that Rec. 709 holds is code (0, 1, 0) on a Rec. 709 display, and a mix on a wider one."""
    green = np.array([[[0, 1, 0]]], np.float32)

    on_srgb, on_p3 = (
        project(green, Grade(display=f"{name} - Display"), "lin_rec709")[0, 0] for name in ("sRGB", "Display P3")
    )

    np.testing.assert_allclose(on_srgb, [0, 1, 0], atol=2e-3)
    np.testing.assert_allclose(on_p3, [0.458, 0.985, 0.298], atol=2e-3)  # Rec. 709's green in Display P3


def test_a_print_is_graded_where_its_light_stands_for_a_scene() -> None:
    doubled = Grade(cdl=Cdl(offset=(1 / 17.52,) * 3))
    dim = np.full((1, 1, 3), 0.2, np.float32)

    np.testing.assert_allclose(project(dim, doubled, "lin_rec709"), project(2 * dim, Grade(), "lin_rec709"), atol=2e-5)


def test_a_print_on_an_old_configurations_display_converts_colour(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    light = np.array([[[0.1, 0.4, 0.7]]], np.float32)

    np.testing.assert_allclose(project(light, Grade(str(file)), "lin_rec709_scene"), light, atol=2e-5)


def test_a_print_as_data_is_left_alone() -> None:
    light = np.array([[[0.1, 0.4, 0.7]]], np.float32)

    np.testing.assert_array_equal(project(light, Grade(view="Raw"), "ACEScg"), light)


def test_a_print_in_an_unknown_space_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"of a print in 'technicolor' cannot be made: .*technicolor"):
        project(np.ones((1, 1, 3), np.float32), Grade(), "technicolor")


def test_light_keeps_its_space_whichever_configuration_grades_it(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    texel = np.array([[[0.2, 0.4, 0.6]]], np.float32)

    grade = Grade(str(file))

    assert grade.working_space == "ACEScg"
    np.testing.assert_allclose(develop(to_working(texel, "lin_rec709"), 1.0, grade), texel, atol=5e-5)


def test_with_ocio_set_everything_is_in_its_working_space(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    monkeypatch.setenv("OCIO", str(file))
    texel = np.array([[[0.2, 0.4, 0.6]]], np.float32)

    grade = Grade()

    assert grade.working_space == "Studio Linear"
    np.testing.assert_array_equal(develop(texel, 1.0, grade), texel)
    np.testing.assert_allclose(
        project(texel, Grade(ACES_2, view="Un-tone-mapped"), "Studio Linear"), srgb(texel), atol=5e-5
    )


def test_a_configuration_that_has_nothing_in_common_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG.replace("aces_interchange: AP0, ", ""))

    with pytest.raises(SettingsError, match=r"own\.ocio lacks the role aces_interchange, .* add it to the roles"):
        Grade(str(file))


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"display": "sRGB"}, "unknown display 'sRGB': did you mean 'sRGB - Display'?"),
        (
            {"view": "ACES 2.0 SDR 100 nits (Rec.709)"},
            "unknown view 'ACES 2.0 SDR 100 nits (Rec.709)' of display 'sRGB - Display': "
            "did you mean 'ACES 2.0 - SDR 100 nits (Rec.709)'?",
        ),
        (
            {"view": "untonemapped"},
            "unknown view 'untonemapped' of display 'sRGB - Display': did you mean 'Un-tone-mapped'",
        ),
        (
            {"look": "gamut compression"},
            "unknown look 'gamut compression': did you mean 'ACES 1.3 Reference Gamut Compression'?",
        ),
    ],
)
def test_an_unknown_name_is_answered_with_the_near_ones(setting: dict[str, str], message: str) -> None:
    with pytest.raises(SettingsError) as caught:
        Grade(**setting)  # type: ignore[arg-type]

    assert str(caught.value).startswith(message)


def test_a_look_without_its_file_is_refused_before_rendering(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", "dusk.cube"))

    with pytest.raises(SettingsError, match=r"cannot be made: .*dusk\.cube") as caught:
        Grade(str(file), look="Dusk")

    assert "\n" not in str(caught.value)


class TestFromFilmData:
    """A grade that travels in the USD."""

    def test_a_shot_that_says_nothing_takes_what_the_environment_says(self) -> None:
        assert Grade.from_film_data(GradeData()) == Grade()

    def test_names_and_numbers(self) -> None:
        data = GradeData(
            ocio_config=Asset(ACES_2),
            display="P3-D65 - Display",
            view="Un-tone-mapped",
            look="ACES 1.3 Reference Gamut Compression",
            cdl_slope=(1.2, 1.0, 0.9),
            cdl_saturation=0.5,
        )

        assert Grade.from_film_data(data) == Grade(
            ACES_2,
            "P3-D65 - Display",
            "Un-tone-mapped",
            "ACES 1.3 Reference Gamut Compression",
            Cdl((1.2, 1.0, 0.9), saturation=0.5),
        )

    def test_a_cdl_file_takes_the_place_of_the_numbers(self, tmp_path: Path) -> None:
        file = tmp_path / "shot.cc"
        file.write_text('<ColorCorrection id="a"><SatNode><Saturation>0.25</Saturation></SatNode></ColorCorrection>')
        data = GradeData(cdl_file=Asset("shot.cc", str(file)), cdl_slope=(3, 3, 3))

        assert Grade.from_film_data(data).cdl == Cdl(saturation=0.25)

    @pytest.mark.parametrize("field", ["ocio_config", "cdl_file"])
    def test_a_file_that_is_missing_is_named_with_what_names_it(self, field: str) -> None:
        with pytest.raises(InputError, match=r"film:(ocio:config|cdl:file) names grades/a\.x, which is not there"):
            Grade.from_film_data(GradeData(**{field: Asset("grades/a.x")}))  # type: ignore[arg-type]

    @pytest.mark.parametrize("field", ["ocio_config", "cdl_file"])
    def test_a_confined_shot_reads_nothing_outside_of_its_folder(self, field: str, tmp_path: Path) -> None:
        (tmp_path / "shot").mkdir()
        outside = tmp_path / "own.ocio"
        outside.write_text(OWN_CONFIG)

        with pytest.raises(InputError, match="which is outside of the shot's folder") as caught:
            Grade.from_film_data(GradeData(**{field: Asset("a", str(outside))}), tmp_path / "shot")  # type: ignore[arg-type]

        assert caught.value.code == "outside_reference"

    @pytest.mark.parametrize("src", ["/etc/passwd", "../secret.cube", "luts/../../secret.cube"])
    def test_nor_does_a_configuration_that_it_brings(self, src: str, tmp_path: Path) -> None:
        (tmp_path / "shot").mkdir()
        own = tmp_path / "shot" / "own.ocio"
        own.write_text(OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", src))
        data = GradeData(ocio_config=Asset("own.ocio", str(own)))

        with pytest.raises(InputError, match=r"own\.ocio names .*, which is outside of the shot's folder"):
            Grade.from_film_data(data, tmp_path / "shot")
        assert Grade.from_film_data(data).config == str(own), "a user's own shot reads what it likes"

    def test_a_configuration_with_its_files_beside_it_is_read(self, tmp_path: Path) -> None:
        own = tmp_path / "own.ocio"
        own.write_text(OWN_CONFIG + LOOK_WITH_A_FILE.replace("FILE", "half.cube"))
        (tmp_path / "half.cube").write_text("LUT_1D_SIZE 2\n0 0 0\n0.5 0.5 0.5\n")
        data = GradeData(ocio_config=Asset("own.ocio", str(own)), look="Dusk")

        grade = Grade.from_film_data(data, tmp_path)

        np.testing.assert_allclose(develop(np.full((1, 1, 3), 0.5, np.float32), 1.0, grade), 0.25, atol=1e-5)


def test_textures_and_pictures_meet_in_the_same_working_space() -> None:
    """A texture of sRGB colours, lit by 1 and shown without tone mapping, is the texture again."""
    texels = np.random.default_rng(3).uniform(0, 1, (8, 8, 3)).astype(np.float32)

    np.testing.assert_allclose(
        develop(to_working(texels, "sRGB"), 1.0, Grade(view="Un-tone-mapped")), texels, atol=2e-4
    )
