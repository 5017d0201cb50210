"""Good focus curves and lens files, with places for numbers that no file should have."""

from __future__ import annotations

import json
import re
from typing import Any

CSV = (
    "frame,time_code,seconds,focus_distance_m,f_stop,tilt_deg,limited,source\r\n"
    "1,1,0.041666666666666664,3,2,0,false,camera\r\n"
    "2,2,0.08333333333333333,3.5,2,0,false,camera\r\n"
    "3,3,0.125,4,2,0,false,camera\r\n"
)
_HEAD = {
    "format": '"pullfocus.focusCurve"',
    "version": "2",
    "camera": '"/World/cam"',
    "lens": '"a lens"',
    "gateMm": "[36, 20.25]",
    "framesPerSecond": "24",
    "timeCodesPerSecond": "24",
}
_SAMPLE = {
    "focusDistanceM": "3",
    "fStop": "2",
    "focalLengthMm": "50",
    "nearM": "2",
    "farM": "4",
    "tiltDeg": "0",
    "cocLimitMm": "0.03",
    "source": '"camera"',
    "reason": '"none"',
}
_OF_ALL = {"width", "camera", "num", "denom"}
"""Values that all samples of OpenTrackIO get."""
PBRT, ZEMAX, CODE_V, BENCH, SHEET = "a.dat", "a.zmx", "a.seq", "a.txt", "a.lens"
_PLACE = re.compile(r"<(\w+):([^>]*)>")
_TEMPLATES = {
    PBRT: "# a lens\n<radius:30> <thickness:4> <index:1.5168> <diameter:20>\n0 1 0 16\n-60 2 1.6 20\n-200 40 1 20\n",
    ZEMAX: (
        'MODE SEQ\nNAME "a lens"\nUNIT MM X\nENPD <pupil:14>\nFNUM <fstop:3> 0\nSURF 0\n TYPE STANDARD\n CURV 0\n'
        " DISZ <object:INFINITY>\nSURF 1\n STOP\n TYPE EVENASPH\n CURV <curvature:0.03>\n PARM 2 <asphere:1e-6>\n"
        " CONI <conic:0>\n DISZ <thickness:4>\n GLAS ___BLANK 1 0 <index:1.6> <abbe:60>\n DIAM <diameter:9>\n"
        "SURF 2\n TYPE XOSPHERE\n CURV -0.01\n XDAT 1 <terms:4>\n XDAT 2 <norm:10>\n XDAT 4 <squared:0>\n XDAT 5 <odd:1e-3>\n"
        " DISZ 45\n DIAM 9\nSURF 3\n TYPE STANDARD\n CURV 0\n DISZ 0\nMNUM 1 1\n"
    ),
    CODE_V: (
        "RDM; LEN\nTITLE 'a lens'\nEPD <pupil:25>\nDIM M\nSO 0.0 <object:0.1e14>\n"
        "S <radius:61.47> <thickness:6.0> NBK7_SCHOTT\n STO; CIR <diameter:12>\n ASP; K <conic:0>; A <asphere:1e-9>\n"
        "S -44.64 2.5 NSF5\n SPS QCN <norm:12>; SCO QC4 <forbes:1e-3>\n"
        "S -129.94 95.9\n SPS QBF 12; SCO QB4 <slope:1e-3>\nSI 0.0 <shift:0.0>\nGO\n"
    ),
    BENCH: (
        "[descriptive data]\ntitle\ta lens\n[constants]\nAsphericalOddCount\t<odd:0>\n[variable distances]\n"
        "Focal Length\t<focal:50>\t50\nF-Number\t<fstop:2.8>\nMagnification\t0\t<magnification:-0.05>\n"
        "d0\tInfinity\t900\nd2\t<near:2>\t3\nd4\t3\t2\nBf\t40\t40\n[lens data]\n1\t60\t5\t<index:1.713>\t30\t<abbe:53.9>\n"
        "2\t400\td2\t\t30\n3\t<radius:45>\t4\t1.6\t<diameter:20>\n4\t-45\td4\t\t20\n5\tAS\tBf\t\t16\n"
        "[aspherical data]\n3\t45\t<conic:-0.5>\t<asphere:1.5E-06>\n"
    ),
    SHEET: (
        "name = a lens\nfocal length = <focal:50>\nf-stops = <wide:1.4> <closed:16>\nclose focus = <close:0.45>\n"
        "measured at = <fstop:1.4>\n\nheight_mm distortion_% light_% sagittal_blur_um tangential_blur_um\n"
        "0 0 100 8 8\n<height:21.6> <distortion:-1.5> <light:40> <blur:14> 21\n\nheight_mm coma_um axial_color_mm\n"
        "0 0 0.1\n20 <coma:3> <axial:0.1>\n"
    ),
}
LENSES = {file: _PLACE.sub(r"\2", text) for file, text in _TEMPLATES.items()}
"""A good lens of each format by its file name."""


def fields_of(file: str) -> tuple[str, ...]:
    """Names of the numbers of a good lens file that can be replaced.

    Args:
        file: name of the file.
    """
    return tuple(match[1] for match in _PLACE.finditer(_TEMPLATES[file]))


def with_number(file: str, field: str, number: str) -> str:
    """Text of a good lens file with another number in one place.

    Args:
        file: name of the file.
        field: which number.
        number: as it shall stand there.
    """
    return _PLACE.sub(lambda place: number if place[1] == field else place[2], _TEMPLATES[file])


def bench_lens(rows: tuple[str, ...]) -> str:
    """Text of an Optical Bench file with two positions of focus, between which d1 grows and d2 shrinks.

    Args:
        rows: of the lens data, parted by tabs.
    """
    distances = "Focal Length\t50\t50\nMagnification\t0\t-0.1\nd1\t2\t3\nd2\t3\t2\nd3\t40\t40\nBf\t40\t40\n"
    return f"[variable distances]\n{distances}[lens data]\n" + "".join(f"{row}\n" for row in rows)


def curve_json(*, sample: dict[str, str] | None = None, samples: str = "", **head: str) -> str:
    """Text of a curve of three samples in JSON, with other values.

    Args:
        sample: JSON of values of the last sample.
        samples: JSON of all samples.
        **head: JSON of values of the curve.
    """
    ordinary = [_SAMPLE | {"timeCode": str(time)} for time in (1, 2, 3)]
    ordinary[-1] |= sample or {}
    values = _HEAD | {"samples": samples or f"[{', '.join(map(_object, ordinary))}]"} | head
    return _object(values)


def curve_otio(number: str) -> str:
    """Text of a timeline whose clip has a curve with a number, or another JSON value.

    Args:
        number: as it shall stand there.
    """
    curve = curve_json(sample={"focusDistanceM": number})
    clip = f'{{"OTIO_SCHEMA": "Clip.1", "metadata": {{"pullfocus": {{"focusCurve": {curve}}}}}}}'
    return f'{{"OTIO_SCHEMA": "Timeline.1", "global_start_time": {number}, "tracks": [{clip}]}}'


def trackio(**values: str) -> str:
    """Text of OpenTrackIO samples, as a tracker on a set writes them, with other values in the last one.

    Args:
        **values: JSON of values: num, denom, hours, frames, sequence, seconds, distance, width, camera.
    """
    made = []
    for number in (1, 2, 3):
        used = values if number == 3 or _OF_ALL & set(values) else {}
        timing: dict[str, Any] = {
            "sampleRate": {"num": "<num:24>", "denom": "<denom:1>"},
            "sequenceNumber": "<sequence:7>" if "sequence" in values else f"<none:{number}>",
        }
        if "seconds" in values:
            timing["sampleTimestamp"] = {"seconds": f"<seconds:{number}>", "nanoseconds": 0}
        elif "sequence" not in values:
            rate = {"num": "<num:24>", "denom": "<denom:1>"}
            code = {"hours": "<hours:1>", "minutes": 2, "seconds": 3, "frames": f"<frames:{number}>", "frameRate": rate}
            timing["timecode"] = code
        data = {
            "protocol": {"name": "OpenTrackIO", "version": [1, 0, 1]},
            "timing": timing,
            "lens": {"focusDistance": "<distance:3>", "fStop": 2},
            "static": {"camera": {"activeSensorPhysicalDimensions": {"width": "<width:36>", "height": 20}}},
        }
        if "camera" in values:
            data["custom"] = {"pullfocus": {"camera": "<camera:1>"}}
        text = re.sub(r'"(<\w+:[^>]*>)"', r"\1", json.dumps(data))
        made.append(_PLACE.sub(lambda place, used=used: used.get(place[1], place[2]), text))
    return f"[{', '.join(made)}]"


def _object(values: dict[str, str]) -> str:
    return "{" + ", ".join(f'"{name}": {value}' for name, value in values.items()) + "}"


CURVES = {
    "a.csv": CSV,
    "a.json": curve_json(),
    "a.otio": curve_otio("3"),
    "a.opentrackio.json": trackio(),
}
"""A good curve of each format by its file name."""
