"""Calibrated distortion from files: OpenCV's, as JSON or YAML, and OpenTrackIO samples.

OpenCV's programs name the numbers in several ways; read are ``camera_matrix`` or ``fx, fy, cx, cy``,
``distortion_coefficients`` (or ``dist_coeffs``, ``distCoeffs``) or ``k1`` to ``k6`` with ``p1, p2``, and ``image_width``,
``image_height``. A matrix is a list, a list of lists, or an object with ``data``, as `cv::FileStorage` and ROS write it.
Thin-prism and tilted-sensor terms are refused.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.optics.measured.brown_conrady import MAX_COEFFICIENT, BrownConrady

MAX_BYTES = 2**20
_TOO_DEEP = re.compile(r"[\[{]{32}")
_MATRIX = "camera_matrix", "cameraMatrix", "K", "mtx"
_VECTOR = "distortion_coefficients", "dist_coeffs", "distCoeffs", "dist", "D"
_NAMED = "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"
_SIZES = ("image_width", "width"), ("image_height", "height")
_DIRECTIONS = {"Brown-Conrady D-U": False, "Brown-Conrady U-D": True}
_RADII, _ANGLES = 96, 24
_FARTHEST = 6.0  # slope that is looked at: 80° from the axis


@dataclass(frozen=True)
class Calibration:
    """Distortion of a lens with its camera.

    Attributes:
        name: of the file.
        model: the distortion.
        focal_px: focal lengths along x and y; 0 where they are not known.
        focal_length_mm: of the pinhole; 0 where it is not known.
        centre: of the optical axis in the picture, in pixels, or mm right and down of its middle where there are no pixels.
        size_px: of the picture; 0 where it is not known.
        gate_mm: of the picture; 0 where it is not known.
    """

    name: str
    model: BrownConrady
    focal_px: tuple[float, float] = (0.0, 0.0)
    focal_length_mm: float = 0.0
    centre: tuple[float, float] = (0.0, 0.0)
    size_px: tuple[float, float] = (0.0, 0.0)
    gate_mm: tuple[float, float] = (0.0, 0.0)

    def pinhole_mm(self, gate_mm: tuple[float, float]) -> float:
        """Focal length by the file, on a gate; 0 where it does not say it."""
        if self.focal_length_mm:
            return self.focal_length_mm
        return self.focal_px[0] / self.size_px[0] * gate_mm[0] if self.size_px[0] else 0.0

    def pairs_mm(self, focal_length_mm: float, corner_mm: float) -> tuple[DoubleArray, DoubleArray]:
        """Points in the picture and where an ideal lens shows the same, ``(n, 2)`` each, from the optical centre.

        Args:
            focal_length_mm: of the lens.
            corner_mm: image height to reach.

        Raises:
            InputError: the distortion folds the picture before that.
        """
        unit = self.model.unit_mm or focal_length_mm
        turn = 2 * np.pi * np.arange(_ANGLES) / _ANGLES
        outward = np.stack([np.cos(turn), np.sin(turn)], axis=1)
        if self.model.distorts:
            radii = np.linspace(0.0, _FARTHEST * focal_length_mm, 40 * _RADII) / unit
            reached = np.hypot(*np.moveaxis(self.model.apply(radii[:, None, None] * outward), -1, 0)).min(axis=1) * unit
            beyond = reached >= corner_mm
            folds = ~(np.diff(reached) > 0)
            last = int(np.argmax(beyond)) if beyond.any() else len(radii) - 1
            if not beyond.any() or folds[:last].any():
                first = float(reached[int(np.argmax(folds))]) if folds.any() else float(reached[-1])
                raise self._folds(first, corner_mm)
            radii = np.linspace(0.0, float(radii[last]), _RADII)
        else:
            radii = np.linspace(0.0, corner_mm, _RADII) / unit
        points = radii[:, None, None] * outward
        mapped = self.model.apply(points)
        reached = np.hypot(*np.moveaxis(mapped, -1, 0))
        rises = np.diff(reached, axis=0) > 0
        if not rises.all():
            raise self._folds(float(radii[int(np.argmin(rises.all(axis=1)))] * unit), corner_mm)
        both = points.reshape(-1, 2) * unit, mapped.reshape(-1, 2) * unit
        return (both[1], both[0]) if self.model.distorts else both

    def _folds(self, at_mm: float, corner_mm: float) -> InputError:
        return _bad(
            self.name,
            f"its distortion folds the picture {at_mm:.4g} mm from the axis, and the picture's corner is {corner_mm:.4g} mm away",
        )


def parse_calibration(data: bytes, name: str) -> Calibration:
    """The calibration of a file in memory: OpenCV's, or the first OpenTrackIO sample with a distortion.

    Args:
        data: all of the file.
        name: of the file, for messages.

    Raises:
        InputError: it has no calibration that is known; the message names what is missing.
    """
    if len(data) > MAX_BYTES:
        raise _bad(name, f"it is too long for a calibration: {len(data)} bytes, expected at most {MAX_BYTES}")
    content = _load(data, name)
    for sample in _samples(content):
        lens = sample.get("lens")
        if isinstance(lens, dict) and lens.get("distortion"):
            return _opentrackio(sample, lens, name)
    if isinstance(content, dict):
        return _opencv(content, name)
    raise _bad(name, "it has neither OpenCV's camera matrix and distortion nor an OpenTrackIO lens with a distortion")


class _Loader(yaml.SafeLoader):  # type: ignore[misc]
    """Reader of YAML that takes OpenCV's matrices for mappings."""


def _matrix(loader: yaml.SafeLoader, node: yaml.nodes.Node) -> Any:
    return loader.construct_mapping(node, deep=True) if isinstance(node, yaml.MappingNode) else None


_Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", _matrix)


def _load(data: bytes, name: str) -> Any:
    try:
        text = data.decode("utf-8-sig")
        if text.count("[") + text.count("{") > 100_000 or _TOO_DEEP.search(text) or "<<" in text:
            raise _bad(name, "it is nested too deep for a calibration")
        try:
            return json.loads(text)
        except ValueError:
            # OpenCV writes the version as %YAML:1.0, which no YAML has
            return yaml.load(re.sub(r"\A%YAML[: ]\S*\s*", "", text), _Loader)
    except (ValueError, yaml.YAMLError, RecursionError, OverflowError, TypeError, AttributeError, LookupError) as error:
        raise _bad(name, "it is neither JSON nor YAML") from error


def _samples(content: Any) -> Iterator[dict[str, Any]]:
    if isinstance(content, dict) and isinstance(content.get("samples"), list):
        content = content["samples"]
    for sample in content if isinstance(content, list) else [content]:
        if isinstance(sample, dict):
            yield sample


def _opencv(content: dict[str, Any], name: str) -> Calibration:
    nested = next((v for v in content.values() if isinstance(v, dict) and _first(v, _MATRIX) is not None), None)
    whole = content if nested is None else {**content, **nested}
    matrix, vector = _first(whole, _MATRIX), _first(whole, _VECTOR)
    if matrix is not None:
        numbers = _numbers(matrix, "camera matrix", name)
        if len(numbers) != 9:
            raise _bad(name, f"its camera matrix has {len(numbers)} numbers, expected 9")
        fx, fy, cx, cy = numbers[0], numbers[4], numbers[2], numbers[5]
    else:
        missing = [key for key in ("fx", "fy", "cx", "cy") if key not in whole]
        if missing:
            raise _bad(name, f"it has no camera_matrix and no {', '.join(missing)}")
        fx, fy, cx, cy = (_number(whole[key], key, name) for key in ("fx", "fy", "cx", "cy"))
    if vector is not None:
        terms = _numbers(vector, "distortion coefficients", name)
        if len(terms) not in (4, 5, 8, 12, 14):
            raise _bad(name, f"it has {len(terms)} distortion coefficients, expected 4, 5 or 8")
        if any(terms[8:]):
            raise _bad(name, "it has thin-prism or tilted-sensor terms, which are not read")
    else:
        terms = [_number(whole.get(key, 0.0), key, name) for key in _NAMED]
        if not any(key in whole for key in _NAMED):
            raise _bad(name, "it has no distortion_coefficients and no k1, k2, p1, p2")
    if not (fx > 0 and fy > 0):
        raise _bad(name, f"its focal lengths must be above 0, got {fx:g} and {fy:g}")
    width, height = (_number(_first(whole, keys) or 0.0, keys[0], name) for keys in _SIZES)
    if min(width, height) < 0 or max(width, height) > 1e6:
        raise _bad(name, f"its picture is {width:g} x {height:g} pixels, which no picture is")
    return Calibration(name, BrownConrady.from_opencv(terms[:8]), (fx, fy), centre=(cx, cy), size_px=(width, height))


def _opentrackio(sample: dict[str, Any], lens: dict[str, Any], name: str) -> Calibration:
    entries = lens["distortion"] if isinstance(lens["distortion"], list) else [lens["distortion"]]
    entry = next(
        (e for e in entries if isinstance(e, dict) and e.get("model", "Brown-Conrady D-U") in _DIRECTIONS), None
    )
    if entry is None:
        raise _bad(name, f"its lens has no distortion of the models {' and '.join(_DIRECTIONS)}")
    radial = _numbers(entry.get("radial"), "lens.distortion.radial", name)
    tangential = _numbers(entry.get("tangential") or [], "lens.distortion.tangential", name)
    if not 1 <= len(radial) <= 6 or len(tangential) > 2:
        raise _bad(name, "its distortion has more than six radial or two tangential coefficients")
    focal = _number(lens.get("pinholeFocalLength") or lens.get("focalLength") or 0.0, "lens.pinholeFocalLength", name)
    if not focal >= 0:
        raise _bad(name, f"its lens.pinholeFocalLength must be above 0, got {focal:g}")
    offsets = [lens.get(key) or {} for key in ("distortionOffset", "projectionOffset")]
    centre = [
        sum(_number(o.get(axis, 0.0), f"offset {axis}", name) for o in offsets if isinstance(o, dict)) for axis in "xy"
    ]
    static = sample.get("static")
    camera = static.get("camera") if isinstance(static, dict) else None
    sensor = camera.get("activeSensorPhysicalDimensions") if isinstance(camera, dict) else None
    gate = (
        tuple(_number(sensor.get(side, 0.0), side, name) for side in ("width", "height"))
        if isinstance(sensor, dict)
        else (0.0, 0.0)
    )
    distorts = _DIRECTIONS[entry.get("model", "Brown-Conrady D-U")]
    model = BrownConrady.from_opentrackio(radial, tangential, distorts=distorts)
    return Calibration(name, model, focal_length_mm=focal, centre=(centre[0], centre[1]), gate_mm=(gate[0], gate[1]))


def _first(content: dict[str, Any], names: tuple[str, ...]) -> Any:
    return next((content[name] for name in names if content.get(name) is not None), None)


def _numbers(value: Any, what: str, name: str, depth: int = 0) -> list[float]:
    if isinstance(value, dict):
        value = value.get("data")
    if not isinstance(value, list) or depth > 3:
        raise _bad(name, f"its {what} must be a list of numbers")
    found: list[float] = []
    for item in value[:64]:
        found += _numbers(item, what, name, depth + 1) if isinstance(item, list) else [_number(item, what, name)]
    return found


def _number(value: Any, what: str, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= MAX_COEFFICIENT:
        got = "a number that is too large" if isinstance(value, int) else repr(str(value)[:40])
        raise _bad(name, f"its {what} must be a number, got {got}")
    number = float(value)
    if not math.isfinite(number):
        raise _bad(name, f"its {what} must be a number, got {number}")
    return number


def _bad(name: str, what: str) -> InputError:
    return InputError(f"{name}: {what}", code="bad_calibration", path=name)
