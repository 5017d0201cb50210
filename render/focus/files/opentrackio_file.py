"""Focus curves as OpenTrackIO samples, the camera tracking protocol of SMPTE's RIS group on on-set virtual production.

Written: a JSON array with one sample of version 1.0.1 for each frame; the protocol itself defines single samples only. Each has
``lens.focusDistance`` in metres, ``lens.fStop`` and ``lens.pinholeFocalLength`` in millimetres (a lens that does not breathe
has the pinhole its focal length says), ``lens.distortion`` where the lens distorts (OpenLensIO 1.0.1, section 4.1),
``timing.sampleRate``, ``timing.sequenceNumber`` and, for a whole frame that is not negative, ``timing.timecode``. The first one
has the ``static`` part. What the protocol has no place for stands under ``custom.pullfocus``, which is open to all: all of the
JSON sample of `render.focus.files.json_file`.

The protocol does not say yet how an infinite focus is written, and JSON cannot: it is 100 km here, and ``null`` under
``custom.pullfocus``. A pinhole has no ``fStop``, which must be above 0.
"""

from __future__ import annotations

import json
import uuid
from typing import Any

from render.focus.curve import FAR_AWAY_M, FocusCurve
from render.focus.files.json_file import sample_to_dict
from render.focus.files.timing import MAX_TIMECODE_RATE, Timecode, rate_as_fraction

PROTOCOL = {"name": "OpenTrackIO", "version": [1, 0, 1]}
NAMESPACE = "pullfocus"
_IDS = uuid.UUID("6f7c1d62-3a0f-5a0e-9a55-0d1f0c6f2b11")
"""Namespace of the identifiers: the same curve gets the same ones every time."""


def curve_to_opentrackio(curve: FocusCurve) -> str:
    """A focus curve as a JSON array of OpenTrackIO samples (see the head of this module).

    Args:
        curve: the curve.
    """
    samples = [_sample(curve, index) for index in range(len(curve.time_codes))]
    samples[0] = {"static": _static(curve), **samples[0]}
    return json.dumps(samples, indent=2, allow_nan=False) + "\n"


def _sample(curve: FocusCurve, index: int) -> dict[str, Any]:
    return {
        "timing": _timing(curve, index),
        "lens": _lens(curve, index),
        "protocol": PROTOCOL,
        "sampleId": _urn(f"{curve.camera} {curve.time_codes[index]}"),
        "sourceId": _urn(curve.camera),
        "sourceNumber": 1,
        "custom": {
            NAMESPACE: {
                "camera": curve.camera,
                "framesPerSecond": curve.frames_per_second,
                "timeCodesPerSecond": curve.time_codes_per_second,
                **sample_to_dict(curve, index),
            }
        },
    }


def _lens(curve: FocusCurve, index: int) -> dict[str, Any]:
    numbers = {
        "fStop": float(curve.f_stop[index]),
        "pinholeFocalLength": float(curve.focal_length_mm[index]),
        "focusDistance": min(float(curve.focus_distance_m[index]), FAR_AWAY_M),
    }
    lens: dict[str, Any] = {name: value for name, value in numbers.items() if value > 0}
    if curve.distortion and any(curve.distortion[index]):
        lens["distortion"] = [{"model": "Brown-Conrady D-U", "radial": list(curve.distortion[index])}]
    return lens


def _timing(curve: FocusCurve, index: int) -> dict[str, Any]:
    rate = rate_as_fraction(curve.frames_per_second)
    ratio = {"num": rate.numerator, "denom": rate.denominator}
    timing: dict[str, Any] = {"mode": "external", "sampleRate": ratio, "sequenceNumber": index}
    frame = float(curve.frames[index])
    if frame >= 0 and frame.is_integer() and rate <= MAX_TIMECODE_RATE:
        code = Timecode.from_frame(int(frame), rate)
        timing["timecode"] = {
            "hours": code.hours,
            "minutes": code.minutes,
            "seconds": code.seconds,
            "frames": code.frames,
            "frameRate": ratio,
            "dropFrame": code.drop_frame,
        }
    return timing


def _static(curve: FocusCurve) -> dict[str, Any]:
    rate = rate_as_fraction(curve.frames_per_second)
    duration = rate_as_fraction(float(curve.frames[-1] - curve.frames[0]) + 1) / rate
    camera: dict[str, Any] = {"captureFrameRate": {"num": rate.numerator, "denom": rate.denominator}}
    if curve.camera:
        camera["label"] = curve.camera
    if curve.gate_mm is not None:
        camera["activeSensorPhysicalDimensions"] = {"width": curve.gate_mm[0], "height": curve.gate_mm[1]}
    lens: dict[str, Any] = {"model": curve.lens_name} if curve.lens_name else {}
    focal_length = curve.focal_length_mm[0]
    if focal_length > 0 and (curve.focal_length_mm == focal_length).all():
        lens["nominalFocalLength"] = float(focal_length)
    return {"duration": {"num": duration.numerator, "denom": duration.denominator}, "camera": camera, "lens": lens}


def _urn(name: str) -> str:
    return f"urn:uuid:{uuid.uuid5(_IDS, name)}"
