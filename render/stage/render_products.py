"""Products of a RenderSettings prim (UsdRender): the pictures and files that a stage asks for.

A product takes from the settings what it does not author itself, as UsdRenderProduct says. `UsdRender.ComputeSpec`, which does
the same, is not there in Python.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from pxr import Gf, UsdRender

from render.errors import SettingsError
from render.model.aovs import AOV_NAMES, PRIMVAR_PREFIX, Kind, check_aov
from render.model.framing import Framing, Window
from render.model.limits import check_picture_size
from render.model.mattes import MATTES
from render.stage.findings import FindingLog
from render.stage.own_settings import put_over, read_own_settings
from render.stage.render_settings import RenderSettings
from render.stage.values import format_value

_KINDS: dict[str, Kind] = {"half": "half", "float": "float", "double": "float", "int": "uint"}
_ENDING = re.compile(r"\.[A-Za-z]{2,4}$")
"""Ending that stands for a format, known or not; a version such as ``.v001`` does not."""
_MOST_ASPECT = 1e6  # of a pixel, as OpenEXR has it
_FLAT, _DEEP = "raster", "deepRaster"
"""Values of ``productType`` that are honoured."""
_COLORS = ("color", "Ci", "C.*", "rgba")
"""Names that renderers give to the colour of the picture."""


@dataclass(frozen=True)
class Var:
    """One of a product's ordered vars.

    Attributes:
        name: of the file's part: that of the RenderVar prim. Mattes keep their own, by which readers of Cryptomatte find them.
        aov: what it holds, a name that ``--aov`` takes.
        kind: type of samples that it asks for: ``half``, ``float`` or ``uint``; None for that of the AOV.
        channels: number of channels that its type has; None for all that the AOV has.
    """

    name: str
    aov: str
    kind: Kind | None
    channels: int | None


@dataclass(frozen=True)
class Product:
    """A picture that a stage asks for.

    Attributes:
        path: prim path.
        file: name of the file as it is authored, with the ending ``.exr`` where it has none.
        camera_path: prim path; None where neither product nor settings name one.
        width: pixels that are rendered.
        height: likewise.
        framing: how the camera's gate becomes these pixels.
        has_motion: whether moving things may be blurred.
        vars: parts of the file, in order; empty where no var is left, which stands for the colour.
        own: values of fields of `FrameSettings` that settings and product author.
        is_deep: whether it holds samples in depth, of the colour alone.
    """

    path: str
    file: str
    camera_path: str | None
    width: int
    height: int
    framing: Framing
    has_motion: bool
    vars: tuple[Var, ...]
    own: dict[str, Any]
    is_deep: bool = False


def read_products(settings: RenderSettings, log: FindingLog) -> list[Product]:
    """Products of a settings prim, in order.

    Args:
        settings: the settings.
        log: notes products that are not rendered, vars that are left out, and our own settings that are not known.

    Raises:
        SettingsError: there is no product that can be rendered, or one asks for a picture that is not possible.
    """
    stage = settings.prim.GetPrim().GetStage()
    shared = read_own_settings(settings.prim.GetPrim(), log)
    products = []
    for target in settings.prim.GetProductsRel().GetForwardedTargets():
        prim = stage.GetPrimAtPath(target)
        if not prim or not prim.IsA(UsdRender.Product):
            log.add("no_product", target, f"{settings.path} names the product {target}, which is no RenderProduct")
            continue
        kind = str(UsdRender.Product(prim).GetProductTypeAttr().Get())
        if kind not in (_FLAT, _DEEP):
            message = f"product {target} is not rendered: its productType is {kind}, not {_FLAT} or {_DEEP}"
            log.add("product_type", target, message)
            continue
        products.append(_Reader(UsdRender.Product(prim), settings, log).read(shared))
    if not products:
        raise SettingsError(
            f"{settings.path} has no products to render: its products relationship names RenderProduct prims"
        )
    return products


class _Reader:
    """Reads one product; attributes that it does not author are those of the settings."""

    def __init__(self, product: UsdRender.Product, settings: RenderSettings, log: FindingLog) -> None:
        self._product, self._settings, self._log = product, settings, log
        self._path = str(product.GetPath())

    def read(self, shared: dict[str, Any]) -> Product:
        width, height = self._pair("resolution")
        check_picture_size(width, height)
        box = self._window(width, height)
        pixel_aspect = self._number("pixelAspectRatio")
        if not 1 / _MOST_ASPECT <= pixel_aspect <= _MOST_ASPECT:
            raise self._fault("pixelAspectRatio", f"a positive number up to {_MOST_ASPECT:g}", pixel_aspect)
        window = None if box == (0, 0, width, height) else Window(box[0], box[1], width, height)
        is_deep = str(self._product.GetProductTypeAttr().Get()) == _DEEP
        still = self._flag("disableMotionBlur") or self._flag("instantaneousShutter")
        return Product(
            path=self._path,
            file=self._file(is_deep),
            camera_path=self._camera(),
            width=box[2],
            height=box[3],
            framing=Framing(
                conform=str(self._get("aspectRatioConformPolicy")),
                pixel_aspect=pixel_aspect,
                window=window,
                is_sharp=self._flag("disableDepthOfField"),
            ),
            has_motion=not still,
            vars=self._vars(is_deep),
            own=put_over(shared, read_own_settings(self._product.GetPrim(), self._log)),
            is_deep=is_deep,
        )

    def _get(self, name: str) -> object:
        own = self._product.GetPrim().GetAttribute(name)
        given = own if own.HasAuthoredValue() else self._settings.prim.GetPrim().GetAttribute(name)
        return given.Get()

    def _fault(self, name: str, expected: str, got: object) -> SettingsError:
        return SettingsError(f"{name} of product {self._path} must be {expected}, got {format_value(got)}")

    def _number(self, name: str) -> float:
        value = self._get(name)
        if not isinstance(value, int | float):
            raise self._fault(name, "a number", value)
        return float(value)

    def _flag(self, name: str) -> bool:
        value = self._get(name)
        if not isinstance(value, bool):
            raise self._fault(name, "true or false", value)
        return value

    def _pair(self, name: str) -> tuple[int, int]:
        value = self._get(name)
        if not isinstance(value, Gf.Vec2i):
            raise self._fault(name, "two whole numbers", value)
        return value[0], value[1]

    def _window(self, width: int, height: int) -> tuple[int, int, int, int]:
        """Column and row of the first pixel, and width and height, of the pixels whose centres ``dataWindowNDC`` holds."""
        value = self._get("dataWindowNDC")
        if not isinstance(value, Gf.Vec4f) or not all(map(math.isfinite, value)) or max(map(abs, value)) > 1e4:
            raise self._fault("dataWindowNDC", "four finite numbers", value)
        left, bottom, right, top = value
        columns = _centres(left, right, width)
        rows = _centres(1 - top, 1 - bottom, height)
        if columns[1] <= columns[0] or rows[1] <= rows[0]:
            raise self._fault("dataWindowNDC", "a window that holds the centre of a pixel", value)
        size = columns[1] - columns[0], rows[1] - rows[0]
        check_picture_size(*size)
        return columns[0], rows[0], *size

    def _file(self, is_deep: bool) -> str:
        name = str(self._product.GetProductNameAttr().Get() or self._product.GetPrim().GetName())
        if not name.rpartition("/")[2].strip("."):
            raise self._fault("productName", "the name of a file", name)
        name = name if _ENDING.search(name) else f"{name}.exr"
        if is_deep and not name.lower().endswith(".exr"):
            raise self._fault("productName", f"the name of an EXR, which a {_DEEP} product is", name)
        return name

    def _camera(self) -> str | None:
        targets = self._product.GetCameraRel().GetForwardedTargets()
        return str(targets[0]) if targets else self._settings.camera_path

    def _vars(self, is_deep: bool) -> tuple[Var, ...]:
        stage = self._product.GetPrim().GetStage()
        found: list[Var] = []
        for target in self._product.GetOrderedVarsRel().GetForwardedTargets():
            prim = stage.GetPrimAtPath(target)
            if not prim or not prim.IsA(UsdRender.Var):
                self._log.add("no_var", target, f"product {self._path} names the var {target}, which is no RenderVar")
                continue
            var = self._var(UsdRender.Var(prim))
            if var is None:
                continue
            if is_deep and (var.aov != "color" or found):
                message = (
                    f"var {target} is left out: the {_DEEP} product {self._path} has one colour and its depth alone"
                )
                self._log.add("deep_var", target, message)
                continue
            if var.name in (other.name for other in found):
                message = f"var {target} is left out: product {self._path} has a part {var.name} already"
                self._log.add("duplicate_var", target, message)
                continue
            found.append(var)
        return tuple(found)

    def _var(self, var: UsdRender.Var) -> Var | None:
        path, name = str(var.GetPath()), var.GetPrim().GetName()
        source, kind = str(var.GetSourceNameAttr().Get() or name), str(var.GetSourceTypeAttr().Get())
        if kind == "lpe":
            self._log.add("light_path", path, f"var {path} is left out: light path expressions are not honoured")
            return None
        aov = f"{PRIMVAR_PREFIX}{source.removeprefix(PRIMVAR_PREFIX)}" if kind == "primvar" else source
        aov = "color" if aov in _COLORS else aov
        try:
            check_aov(aov)
        except SettingsError:
            known = ", ".join(AOV_NAMES)
            self._log.add("unknown_var", path, f"var {path} is left out: its sourceName {source} is none of {known}")
            return None
        samples, channels = _data_type(str(var.GetDataTypeAttr().Get()))
        return Var(aov, aov, None, None) if aov in MATTES else Var(name, aov, samples, channels)


def _centres(first: float, last: float, size: int) -> tuple[int, int]:
    """First pixel, and the one after the last, whose centres lie from ``first`` to ``last``, shares of ``size`` pixels."""
    slack = 1e-6  # single precision of the shares
    return math.ceil(first * size - 0.5 - slack * size), math.floor(last * size - 0.5 + slack * size) + 1


def _data_type(name: str) -> tuple[Kind | None, int]:
    """Type of samples, and number of channels, of a value type such as ``color3f``."""
    base = name.removesuffix("[]")
    for word, kind in _KINDS.items():
        if base.rstrip("234") == word:
            return kind, int(base.removeprefix(word) or 1)
    letters: dict[str, Kind] = {"h": "half", "f": "float", "d": "float", "i": "uint"}
    if base[-1:] in letters and base[-2:-1] in ("2", "3", "4"):
        return letters[base[-1]], int(base[-2])
    return None, 3
