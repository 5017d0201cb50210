"""A wedge of greys is filmed: the densities that are read off the picture are those of the stock."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from render.film.stock import MIDDLE_GREY, Stock, camera_stock, print_stock
from render.frame import FrameRenderer, FrameSettings
from render.model.arrays import DoubleArray
from render.pictures.picture import make_picture
from render.shot import Shot
from tests.render.kits.cli_shots import CAMERA, write_shot

pytestmark = pytest.mark.gl

STEPS = 21
STOPS = np.linspace(-7, 7, STEPS)
BRIGHTEST_TO_GREY = 7.0
PIXELS = 8  # of a card
SETTINGS = FrameSettings(width=STEPS * PIXELS, height=PIXELS, engine="pinhole", rays=1, supersample=1, shading="unlit")


def wedge(path: Path, stock: str, process: str, push: float = 0.0) -> Shot:
    """Cards side by side, a stop and less apart, exposed so that the one in the middle is middle grey."""
    cards = "".join(card(i, 2.0 ** (stops - BRIGHTEST_TO_GREY)) for i, stops in enumerate(STOPS))
    exposure = math.log2(MIDDLE_GREY) + BRIGHTEST_TO_GREY
    says = f"""        token film:process = "{process}"
        string film:stock = "{stock}"
        double film:push = {push}
        string film:ocio:view = "Raw"
        float exposure = {exposure}
    }}
"""
    camera = CAMERA.replace('"main_cam"', '"main_cam" (prepend apiSchemas = ["FilmAPI"])').rstrip().removesuffix("}")
    camera = camera.replace("verticalAperture = 0.24", f"verticalAperture = {0.36 / STEPS}")
    return Shot.open(write_shot(path, cards, camera + says))


def card(index: int, level: float) -> str:
    """A card of the wedge, 5 m before a camera of 50 mm: the whole wedge is 3.6 m wide."""
    left, right = (3.6 * ((index + side) / STEPS - 0.5) for side in (0, 1))
    return f"""
    def Mesh "card_{index}"
    {{
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [({left}, -1, 0), ({right}, -1, 0), ({right}, 1, 0), ({left}, 1, 0)]
        color3f[] primvars:displayColor = [({level}, {level}, {level})] (interpolation = "constant")
    }}
"""


def densities(renderer: FrameRenderer, shot: Shot, shown: Stock) -> DoubleArray:
    """Density of what is shown, read off the middle of each card, ``(21, 3)``."""
    graded = make_picture(renderer, shot, None, 1, SETTINGS).graded.astype(np.float64)
    return np.array(shown.base) - np.log10(graded[PIXELS // 2, PIXELS // 2 :: PIXELS])


def on_curves(stock: Stock, above_grey: DoubleArray) -> DoubleArray:
    """Density of each record at exposures that many log10 above a metered grey's, by the cubic itself."""
    pairs = zip(stock.curves, stock.middle_log_exposure, strict=True)
    return np.stack([curve.density(middle + above_grey) for curve, middle in pairs], axis=-1)


@pytest.mark.parametrize("push", [0.0, 1.0])
@pytest.mark.parametrize("name", ["velvia_50", "kodachrome_64", "ektachrome_100d"])
def test_a_slide_has_the_densities_of_its_stock(
    renderer: FrameRenderer, tmp_path: Path, name: str, push: float
) -> None:
    stock = camera_stock(name)

    read = densities(renderer, wedge(tmp_path / "wedge.usda", name, "reversal", push), stock)

    assert np.abs(read - on_curves(stock, (STOPS + push) * math.log10(2))).max() < 0.01
    assert np.ptp(read) > 2


@pytest.mark.parametrize(
    ("name", "process", "printed_on"),
    [
        ("vision3_500t_5219", "negative", "vision_2383"),
        ("portra_400", "negative", "vision_2383"),
        ("double_x_5222", "monochrome", "print_2302"),
    ],
)
def test_a_print_has_the_densities_that_its_negative_lets_through(
    renderer: FrameRenderer, tmp_path: Path, name: str, process: str, printed_on: str
) -> None:
    negative, printed = camera_stock(name), print_stock(printed_on)
    held_back = on_curves(negative, STOPS * math.log10(2)) - np.array(negative.middle_density)
    wanted = np.stack(
        [
            curve.density(middle - held)
            for curve, middle, held in zip(printed.curves, printed.middle_log_exposure, held_back.T, strict=True)
        ],
        axis=-1,
    )

    read = densities(renderer, wedge(tmp_path / "wedge.usda", name, process), printed)

    assert np.abs(read - wanted).max() < 0.01
    grey = read[STEPS // 2] - np.array(printed.base)
    np.testing.assert_allclose(grey, 1.0, atol=0.01, err_msg="the laboratory's aim for a metered grey")
