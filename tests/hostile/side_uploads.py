"""Hostile files beside a shot: focus curves and lens files that somebody could send to a shot of their own."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator

from tests.hostile.corpus import mutated
from tests.hostile.side_bases import (
    BENCH,
    CODE_V,
    CSV,
    CURVES,
    LENSES,
    PBRT,
    SHEET,
    ZEMAX,
    bench_lens,
    curve_json,
    curve_otio,
    fields_of,
    trackio,
    with_number,
)

SEED = 4711
DAMAGED = 10
RAW_NUMBERS = (
    "NaN",
    "Infinity",
    "-Infinity",
    "1e308",
    "-1e308",
    "1e-320",
    "-0.0",
    "1e999",
    "1" + "0" * 4000,
    "1" + "0" * 5000,
    '"1"',
    "true",
    "null",
    "[]",
    "{}",
)
CSV_NUMBERS = ("nan", "inf", "-inf", "1e308", "-1e308", "1e-320", "-0", "1" + "0" * 4000, "0x10", "1_0", "١", "")
LENS_NUMBERS = ("nan", "inf", "0", "-0", "-1", "1e308", "-1e308", "1e-308", "1e5", "1e-3", "9" * 41, "0x1p3", "١", "")
FORMULAS = ("=cmd|' /C calc'!A0", "+1+1", "@SUM(A1)", '=HYPERLINK("http://localhost")', "-2+3", "\t=1")
GLASSES = ("NOGLASS", "../../etc/passwd", "999999", "001001", "9999999.9999999", "'", "A" * 100_000, "_", "-")
COMMANDS = (
    "IN /etc/passwd",
    "IN @lens.seq",
    "S9999; K 1",
    "RDY S9999 1",
    "CIR OBS 1",
    "PRV\nPWL 1 1\n'a' 2 2",
    "&" * 9_000,
)
CODE_V_OF_GLASS = LENSES[CODE_V].replace("NBK7_SCHOTT", "<glass>")
MANY = 60_000
"""Rows or samples of a file, more than the frames that one curve may have."""
NAMED = 6_000
"""Samples, each with a focus point of its own."""
SAME_HASH = 2**61 - 1
"""Whole numbers that differ by multiples of it have one hash in CPython."""

Upload = tuple[str, str, str, bytes]


def side_uploads() -> Iterator[Upload]:
    """Name, kind (``curve`` or ``lens``), file name and content of each file."""
    for name, file, text in (*_curve_numbers(), *_curve_shapes(), *_large_curves()):
        yield f"curve/{name}", "curve", file, text.encode("utf-8", "surrogatepass")
    for name, file, text in (*_lens_numbers(), *_lens_shapes()):
        yield f"lens/{name}", "lens", file, text.encode()
    for kind, files in (("curve", CURVES), ("lens", LENSES)):
        for file, text in files.items():
            yield from _bytes_of(kind, file, text.encode())
            mutate = random.Random(f"{SEED}/{kind}/{file}")
            for number in range(DAMAGED):
                how, content = mutated(text.encode(), mutate)
                yield f"{kind}/{file}-{number}-{how}", kind, file, content


Texts = Iterator[tuple[str, str, str]]


def _bytes_of(kind: str, file: str, good: bytes) -> Iterator[Upload]:
    """A good file in other encodings, and with bytes that no text has."""
    text = good.decode()
    for encoding in ("utf-16", "utf-16-be", "utf-32", "utf-7", "cp037"):
        yield f"{kind}/{file}-{encoding}", kind, file, text.encode(encoding)
    yield f"{kind}/{file}-bom", kind, file, b"\xef\xbb\xbf" * 2 + good
    yield f"{kind}/{file}-nul", kind, file, good.replace(b"\n", b"\0\n", 3)
    yield f"{kind}/{file}-latin", kind, file, good + b"\xff\xfe\x80"
    yield f"{kind}/{file}-empty", kind, file, b""
    yield f"{kind}/{file}-twice", kind, file, good + good


def _curve_numbers() -> Texts:
    for number in RAW_NUMBERS:
        shown = f"{number[:9]}-{len(number)}"
        for field in ("framesPerSecond", "timeCodesPerSecond", "gateMm", "version"):
            yield f"json-{field}-{shown}", "a.json", curve_json(**{field: number})
        for field in ("timeCode", "focusDistanceM", "fStop", "focalLengthMm", "tiltDeg", "cocLimitMm", "points"):
            yield f"json-sample-{field}-{shown}", "a.json", curve_json(sample={field: number})
        for field in ("camera", "num", "denom", "hours", "frames", "sequence", "seconds", "distance", "width"):
            yield f"trackio-{field}-{shown}", "a.json", trackio(**{field: number})
        yield f"otio-{shown}", "a.otio", curve_otio(number)
    for number in CSV_NUMBERS:
        for place in range(6):
            rows = [line.split(",") for line in CSV.strip().split("\r\n")]
            rows[-1][place] = number
            yield f"csv-{place}-{number[:9]}-{len(number)}", "a.csv", "\r\n".join(",".join(row) for row in rows)
    for first, last in (("-1e308", "1e308"), ("0", "1e-320"), ("0", "1e308")):
        times = "frame,time_code,seconds,focus_distance_m\n"
        for place in range(3):
            rows = [
                [first if at == place else "1" for at in range(3)],
                [last if at == place else "2" for at in range(3)],
            ]
            yield f"csv-rates-{place}-{first}-{last}", "a.csv", times + "".join(",".join([*row, "3\n"]) for row in rows)
    rates = {"framesPerSecond": "1e308", "timeCodesPerSecond": "1e-308"}
    yield "json-rates", "a.json", curve_json(**rates)
    yield "json-rates-turned", "a.json", curve_json(framesPerSecond="1e-308", timeCodesPerSecond="1e308")
    yield "json-rates-far-apart", "a.json", curve_json(framesPerSecond="1e-200", timeCodesPerSecond="1e200")


def _curve_shapes() -> Texts:
    """Files of an odd shape: nested, with names twice, and with words that other programs take for commands."""
    for depth in (900, 100_000):
        deep = "[" * depth + "]" * depth
        maps = '{"a":' * depth + "1" + "}" * depth
        for name, nested in (("lists", deep), ("objects", maps)):
            yield f"deep/{name}-{depth}", "a.json", nested
            for field in ("camera", "lens", "version", "samples", "gateMm"):
                yield f"deep/{field}-{name}-{depth}", "a.json", curve_json(**{field: nested})
            for field in ("source", "reason", "points", "fStop"):
                yield f"deep/sample-{field}-{name}-{depth}", "a.json", curve_json(sample={field: nested})
            yield f"deep/trackio-{name}-{depth}", "a.json", trackio(camera=nested)
            yield f"deep/otio-{name}-{depth}", "a.otio", curve_otio(nested)
    yield "twice/keys", "a.json", curve_json().replace('"version"', '"version": 1, "version": [], "version"')
    yield "twice/header", "a.csv", CSV.replace("f_stop", "focus_distance_m")
    yield "surrogate", "a.json", curve_json(camera='"\\ud800"', sample={"reason": '"\\udfff"'})
    yield "surrogate/points", "a.json", curve_json(sample={"points": '[{"name": "\\ud800", "state": "used"}]'})
    yield "nul/camera", "a.json", curve_json(camera='"/World\\u0000/cam"', lens='"\\u0000"')
    for number, formula in enumerate(FORMULAS):
        words = json.dumps(formula)
        yield f"formula/json-{number}", "a.json", curve_json(lens=words, sample={"reason": words})
        yield f"formula/csv-{number}", "a.csv", CSV.replace("camera", formula).replace("limited", formula, 1)
    yield "csv/quote", "a.csv", CSV + '"' + "a" * 200_000
    yield "csv/no-end", "a.csv", "frame,focus_distance_m\n" + "1,1\r" * 1000
    yield "csv/unit", "a.csv", f"frame,focus_distance_{'x' * 100_000}\n1,1\n"
    yield "otio/not-a-clip", "a.otio", '{"OTIO_SCHEMA": {"a": []}, "x": {"OTIO_SCHEMA": "Clip.1", "metadata": []}}'
    yield "otio/loop", "a.otio", '{"OTIO_SCHEMA": "SerializableObjectRef.1", "id": "Timeline-1"}'


def _large_curves() -> Texts:
    """Files of a few megabytes: many rows, columns, points and rates."""
    head = "frame,focus_distance_m\n"
    yield "large/rows", "a.csv", head + "".join(f"{row},3\n" for row in range(400_000))
    yield "large/bad-rows", "a.csv", head + "x,y\n" * 1_000_000
    yield "large/blank-rows", "a.csv", head + "1,3\n" + ",\n" * 1_000_000
    yield "large/gap", "a.csv", head + "0,3\n1e-9,3\n1e9,3\n"
    yield "large/columns", "a.csv", "frame,focus_distance_m" + ",a" * 1_500_000 + "\n1,3\n"
    yield "large/columns-of-units", "a.csv", "frame,focus_distance_m" + ",near_m" * 600_000 + "\n1,3\n"
    yield "large/line", "a.csv", "frame,focus_distance_m," + "a" * 5_000_000 + "\n1,3,\n"
    yield "large/spaces", "a.json", " " * 5_000_000 + "{"
    yield "large/brackets", "a.csv", "frame,focus_distance_m,(" + "_ " * 2_000_000 + "\n1,3,\n"
    parts = ("state", "depth_m", "weight", "share", "coc_mm")
    names = ",".join(f"p{point}.{part}" for point in range(3_000) for part in parts)
    row = "used,1,1,1,1," * 3_000
    body = "".join(f"{number},3,{row[:-1]}\n" for number in range(100))
    yield "large/points", "a.csv", f"frame,focus_distance_m,{names}\n{body}"
    samples = [
        {"timeCode": n, "focusDistanceM": 3, "points": [{"name": f"p{n}", "state": "used"}]} for n in range(NAMED)
    ]
    yield "large/points-of-their-own", "a.json", curve_json(samples=json.dumps(samples))
    many = [{"name": f"p{n}", "state": "used"} for n in range(100_000)]
    yield "large/points-at-once", "a.json", curve_json(sample={"points": json.dumps(many)})
    yield "large/samples", "a.json", curve_json(samples="[" + "{}," * MANY + "{}]")
    yield "large/lists", "a.json", "[" + "[]," * 2_000_000 + "[]]"
    rates = [{"timing": {"sampleRate": {"num": 1 + n * SAME_HASH, "denom": 1}}} for n in range(MANY // 4)]
    yield "large/rates-of-one-hash", "a.json", json.dumps([{"protocol": {"name": "OpenTrackIO"}}, *rates])
    yield "large/samples-of-trackio", "a.json", json.dumps([{"protocol": {"name": "OpenTrackIO"}}] + [{}] * MANY)
    yield "large/lines-of-trackio", "a.json", '{"protocol": {"name": "OpenTrackIO"}}\n' * 30_000
    clips = '{"OTIO_SCHEMA": "Clip.1", "metadata": {"pullfocus": {"focusCurve": {}}}},' * 50_000
    yield "large/clips", "a.otio", f'{{"OTIO_SCHEMA": "Track.1", "children": [{clips}{{}}]}}'


def _lens_numbers() -> Texts:
    """One number of a good lens file after the other replaced."""
    for file in LENSES:
        for field in fields_of(file):
            for number in LENS_NUMBERS:
                yield f"{file}-{field}-{number[:6]}-{len(number)}", file, with_number(file, field, number)


def _lens_shapes() -> Texts:
    """Lenses of too many surfaces, of glass that is none, and with commands that lead elsewhere."""
    for count in (200, 201, 10_000):
        rows = "".join(f"{40 if row % 2 else -40} 0.1 {1.5 if row % 2 else 1} 20\n" for row in range(1, count))
        yield f"surfaces-{count}", PBRT, f"{rows}0 4 0 5\n"
        yield f"planes-{count}", PBRT, "0 0.1 1 20\n" * count + "30 4 1.5 20\n-30 4 1 20\n"
    for glass in GLASSES:
        yield f"seq-glass-{glass[:9]}", CODE_V, CODE_V_OF_GLASS.replace("<glass>", glass)
    for terms in (1, 40):
        aspheres = f"{CODE_V_OF_GLASS.replace('<glass>', 'NBK7')}".replace("STO", "STO; ASP; K -1e5; A 1e5; J 1e30")
        yield f"seq-aspheres-{terms}", CODE_V, aspheres.replace("J 1e30", "; ".join(["J 1e30"] * terms))
    for number, command in enumerate(COMMANDS):
        yield f"seq-command-{number}", CODE_V, CODE_V_OF_GLASS.replace("<glass>", "NBK7").replace("GO", command)
    wavelengths = "PRV\nPWL " + " ".join(map(str, range(100, 2000))) + "\n'a' " + " ".join(["1.5"] * 1900) + "\nEND\n"
    yield "seq-wavelengths", CODE_V, wavelengths + CODE_V_OF_GLASS.replace("<glass>", "a")
    yield "zmx-label", ZEMAX, "SURF " + "9" * 500_000 + "\nCURV x\n"
    yield "zmx-surfaces", ZEMAX, "SURF 1\n" * 100_000
    yield (
        "bench-focus-group-of-planes",
        BENCH,
        bench_lens(("1\t\td1", "2\t\td2", "3\t50\t4\t1.5\t20", "4\t-50\td3\t\t20")),
    )
    yield "bench-focus-group-behind", BENCH, bench_lens(("3\t50\t4\t1.5\t20", "4\t-50\td1\t\t20", "5\t\td2", "6\t\td3"))
    yield "bench-labels", BENCH, bench_lens(("1\t50\t4\t1.5\t20",) * 3 + ("1\t-50\td3\t\t20",))
    yield "bench-loop", BENCH, bench_lens(("1\t50\td1\t1.5\t20", "2\t-50\td1\t\tBf"))
    yield "sheet-rows", SHEET, "focal length = 50\nheight_mm light_%\n" + "0 100\n" * 1_001
    falling = "".join(f"{999 - row} 100\n" for row in range(999))
    yield "sheet-falling", SHEET, "focal length = 50\nheight_mm light_%\n" + falling
    yield "sheet-tables", SHEET, "focal length = 50\n" + "height_mm light_%\n0 100\n9 50\n\n" * 3_000
    yield (
        "sheet-sources",
        SHEET,
        "focal length = 50\n" + "source = =cmd()\n" * 60_000 + "height_mm light_%\n0 100\n9 50\n",
    )
    yield "sheet-name", SHEET, f"name = {'a' * 900_000}\nfocal length = 50\nheight_mm light_%\n0 100\n9 50\n"
    yield "line", PBRT, "1 " * 500_000
    yield "lines", "a.txt", "- " * 500_000
    yield "too-long", PBRT, "#" * (2**20 + 1)
