"""Shots whose materials are MaterialX documents that lead elsewhere, have no end, or are none.

The installed usd-core has no file format for ``.mtlx``: a reference to one stays empty, and ``render.stage.materials.mtlx``
reads the document by itself where a prim is bound to a material below that reference.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tests.hostile.absurd_numbers import COUNTS
from tests.service.conftest import ROOM

FILE = "a.mtlx"
MATERIAL = '<surfacematerial name="M"><input name="surfaceshader" nodename="S"/></surfacematerial>'
BODY = MATERIAL + '<standard_surface name="S" type="surfaceshader">{}</standard_surface>{}'
NUMBERS = (
    "nan",
    "inf",
    "e",
    "-",
    "--1",
    "1e999",
    "-1e300",
    "1e-320",
    "+.",
    "1,1,1",
    "0.5 0.5 0.5",
    "9" * 5000,
    "1.2.3",
    "",
)
INPUTS = ("base", "base_color", "metalness", "specular_roughness", "emission", "emission_color", "transmission")
NAMES = ("'", "S']", "']|//*[@name='S", "..", "*", "S' or '1'='1", "[", "{}", "\u202eS", "S" * 100_000)
ENCODINGS = (
    "utf-7",
    "utf-16",
    "utf-32",
    "idna",
    "punycode",
    "unicode_escape",
    "rot13",
    "bz2",
    "hex",
    "cp037",
    "no-such",
    "shift_jis",
)
TEXTURES = (
    "{canary}",
    "/etc/passwd",
    "../../../../../../etc/passwd",
    "/dev/zero",
    "file:///etc/passwd",
    "http://localhost/a.png",
    "a.png?RES=100000x100000",
    "x.null?RES=100000x100000",
    "%00",
    "a.usdz[b.png]",
    "room.usda",
    "a.mtlx",
    ".",
    "",
    "a" * 5_000,
    "&lt;UDIM&gt;.png",
    "&#xd7ff;.png",
)

SPHERE = (
    'def Sphere "s{0}" (prepend apiSchemas = ["MaterialBindingAPI"]) {{\n'
    "rel material:binding = <{1}/Materials/M{2}>\n}}\n"
)

Shot = dict[str, str | bytes]


def materialx_attacks(canary: Path) -> Iterator[tuple[str, Shot]]:
    """Name and files of each shot.

    Args:
        canary: file that nothing may be read from.
    """
    groups = (_includes(canary), _entities(canary), _inputs(canary), _graphs(), _definitions(canary), _sizes())
    for name, text in (attack for group in groups for attack in group):
        yield name, _shot(text)
    for encoding in ENCODINGS:
        declared = f'<?xml version="1.0" encoding="{encoding}"?>{document()}'
        yield f"encoding/{encoding}", _shot(declared)
    yield "binary", _shot(bytes(range(256)) * 400)
    yield "binary/nul", _shot(bytes(1_000_000))
    yield "binary/utf16", _shot(document().encode("utf-16"))
    yield "binary/latin", _shot(document("<!--").encode() + b"\xff\xfe-->")
    yield "empty", _shot(b"")
    yield from _references(canary)


def document(inputs: str = "", nodes: str = "") -> str:
    """MaterialX document with one material.

    Args:
        inputs: of its surface.
        nodes: beside it.
    """
    return f'<materialx version="1.38">{BODY.format(inputs, nodes)}</materialx>'


def room(target: str = f"@{FILE}@</MaterialX>", material: str = "M") -> str:
    """Stage whose near mesh is bound to a material below a reference.

    Args:
        target: of the reference.
        material: name of the material.
    """
    bound = f"rel material:binding = </World/Looks/Materials/{material}>\n"
    near = 'def Mesh "near" (prepend apiSchemas = ["MaterialBindingAPI"])'
    looks = f'def Scope "Looks" (references = {target}) {{\n}}\n'
    stage = ROOM.replace('def Mesh "near"', near).replace(COUNTS, COUNTS + bound, 1)
    return stage.replace('def DistantLight "sun"', looks + 'def DistantLight "sun"')


def _shot(content: str | bytes) -> Shot:
    return {"room.usda": room(), FILE: content}


Texts = Iterator[tuple[str, str]]


def _includes(canary: Path) -> Texts:
    targets = (canary, "/etc/passwd", "../../../../../../etc/passwd", FILE, "/dev/zero", "http://localhost/a.mtlx")
    for number, target in enumerate(targets):
        include = f'<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="{target}"'
        yield f"include/{number}", document(nodes=f"{include}/>")
        yield f"include/text-{number}", document(f'{include} parse="text"/>')
    style = f'<?xml version="1.0"?><?xml-stylesheet href="{canary}" type="text/xsl"?>'
    yield "include/style", style + document()
    yield (
        "include/schema",
        document().replace("<materialx", f'<materialx xmlns="file://{canary}" fileprefix="{canary.parent}/"', 1),
    )


def _entities(canary: Path) -> Texts:
    steps = "".join(f'<!ENTITY a{step} "{f"&a{step - 1};" * 10}">' for step in range(1, 10))
    use = document('<input name="base_color" value="&a9;"/>').replace("<materialx", "<materialx x='&a9;'", 1)
    yield "entity/laughs", f'<!DOCTYPE x [<!ENTITY a0 "0.5 ">{steps}]>{use}'
    blowup = document(f'<input name="base_color" value="{"&a;" * 40_000}"/>')
    yield "entity/quadratic", f'<!DOCTYPE x [<!ENTITY a "{"0.5 " * 10_000}">]>{blowup}'
    mild = document(f'<input name="base_color" value="{"&a;" * 70}"/>')
    yield "entity/below-the-limit", f'<!DOCTYPE x [<!ENTITY a "{"0.5 " * 25_000}">]>{mild}'
    yield "entity/loop", f'<!DOCTYPE x [<!ENTITY a "&b;"><!ENTITY b "&a;">]>{document("&a;")}'
    for number, target in enumerate((canary, "/etc/passwd", "/dev/zero", "http://localhost/a", f"file://{canary}")):
        external = f'<!DOCTYPE x [<!ENTITY a SYSTEM "{target}">]>'
        yield f"entity/external-{number}", external + document("<input name='base'>&a;</input>")
        yield f"entity/external-value-{number}", external + document('<input name="base" value="&a;"/>')
        parameter = f'<!DOCTYPE x [<!ENTITY % p SYSTEM "{target}"> %p;]>'
        yield f"entity/parameter-{number}", parameter + document()
        yield f"entity/subset-{number}", f'<!DOCTYPE x SYSTEM "{target}">' + document()


def _inputs(canary: Path) -> Texts:
    for number in NUMBERS:
        for name in INPUTS:
            yield f"number/{name}-{number[:12]}-{len(number)}", document(f'<input name="{name}" value="{number}"/>')
    for number, texture in enumerate(TEXTURES):
        for place, name in enumerate(("base_color", "normal", "metalness")):
            file = f'<input name="file" type="filename" value="{texture.format(canary=canary)}"/>'
            image = f'<image name="I" fileprefix="{canary.parent}/">{file}</image>'
            yield f"texture/{number}-{place}", document(f'<input name="{name}" nodename="I"/>', image)
    for number, space in enumerate(("", "no_such", "$PATH", "%PATH%", str(canary), "a" * 100_000, "sRGB\t")):
        file = f'<input name="file" value="room.usda" colorspace="{space}"/>'
        yield f"space/{number}", document('<input name="base_color" nodename="I"/>', f'<image name="I">{file}</image>')
    for number, name in enumerate(NAMES):
        yield f"name/surface-{number}", document().replace('nodename="S"', f'nodename="{name}"')
        yield f"name/node-{number}", document(f'<input name="base_color" nodename="{name}"/>')
        yield f"name/graph-{number}", document(f'<input name="base_color" nodegraph="{name}" output="o"/>')
        graph = f'<nodegraph name="G"><output name="o" nodename="{name}"/></nodegraph>'
        yield f"name/output-{number}", document(f'<input name="base_color" nodegraph="G" output="{name}"/>', graph)
    yield "name/none", document("<input/><input name='base_color'/>").replace(' nodename="S"', "")


def _graphs() -> Texts:
    turn = '<normalmap name="{0}"><input name="in" nodename="{1}"/></normalmap>'
    loop = turn.format("A", "B") + turn.format("B", "A")
    yield "loop/nodes", document('<input name="normal" nodename="A"/>', loop)
    yield "loop/itself", document('<input name="normal" nodename="A"/>', turn.format("A", "A"))
    graph = f'<nodegraph name="G"><output name="o" nodegraph="G" output="o" nodename="A"/>{loop}</nodegraph>'
    yield "loop/graph", document('<input name="normal" nodegraph="G" output="o"/>', graph)
    chain = "".join(turn.format(f"N{step}", f"N{step + 1}") for step in range(20_000))
    yield "loop/chain", document('<input name="normal" nodename="N0"/>', chain)
    lobes = BODY.replace("standard_surface", "surface").format
    link = '<input name="bsdf" type="BSDF" nodename="b"/>'
    both = '<input name="in1" type="BSDF" nodename="{0}"/><input name="in2" type="BSDF" nodename="{0}"/>'
    for number, inside in enumerate(
        (
            f'<layer name="b" type="BSDF">{both.format("b")}</layer>',
            f'<add name="b" type="BSDF">{both.format("n150")}</add><conductor_bsdf name="n0" type="BSDF"/>'
            + "".join(
                f'<mix name="n{n}" type="BSDF">{both.format(f"n{n - 1}").replace("in1", "fg").replace("in2", "bg")}'
                '<input name="mix" type="float" nodename="t"/></mix>'
                for n in range(1, 151)
            )
            + '<texcoord name="t" type="vector2"/>',
            '<dielectric_bsdf name="b" type="BSDF"><input name="ior" type="float" value="-1"/>'
            '<input name="roughness" type="vector2" value="nan"/><input name="tint" value="1e15,1e15,1e15"/>'
            '<input name="scatter_mode" value="{}"/></dielectric_bsdf>',
            '<multiply name="b" type="BSDF"><input name="in2" type="matrix44" value="1"/></multiply>',
            '<oren_nayar_diffuse_bsdf name="b" type="float"><input name="color" type="string" value="x"/>'
            '<input name="weight" type="float" nodename="b"/></oren_nayar_diffuse_bsdf>',
        )
    ):
        yield f"loop/lobes-{number}", f"<materialx>{lobes(link, inside)}</materialx>"
    add = '<add name="n{}" type="float">{}</add>'
    sums = "".join(add.format(n, both.format(f"n{n - 1}").replace("BSDF", "float")) for n in range(1, 100))
    for number, height in enumerate(
        ('nodename="n99"', 'nodename="D"', 'value="nan"', 'value="1e15"', 'nodename="I"', 'nodegraph="D" output="D"')
    ):
        file = '<image name="I" type="float"><input name="file" type="filename" value="/etc/passwd"/></image>'
        node = f'<displacement name="D"><input name="displacement" type="float" {height}/></displacement>'
        moved = BODY.replace("</surfacematerial>", '<input name="displacementshader" nodename="D"/></surfacematerial>')
        yield f"loop/displacement-{number}", f"<materialx>{moved.format('', sums + file + node)}</materialx>"
    surface = '<input name="surfaceshader" nodename="M"/>'
    yield "loop/material", f"<materialx><surfacematerial name='M'>{surface}</surfacematerial></materialx>"


DEFINITION = (
    '<nodedef name="ND_{0}" node="{0}"><output name="out" type="float"/></nodedef><nodegraph name="NG_{0}" nodedef="ND_{0}">{1}'
    '<output name="out" type="float" nodename="q"/></nodegraph>'
)


def _definitions(canary: Path) -> Texts:
    base, use = '<input name="base" type="float" nodename="x"/>', '<a0 name="x" type="float"/>'
    yield "definition/itself", document(base, DEFINITION.format("a0", '<a0 name="q" type="float"/>') + use)
    pair = DEFINITION.format("a0", '<a1 name="q" type="float"/>') + DEFINITION.format(
        "a1", '<a0 name="q" type="float"/>'
    )
    yield "definition/each-other", document(base, pair + use)
    double = (
        '<a{0} name="p" type="float"/><a{0} name="r" type="float"/><add name="q" type="float">'
        '<input name="in1" type="float" nodename="p"/><input name="in2" type="float" nodename="r"/></add>'
    )
    steps = "".join(DEFINITION.format(f"a{step}", double.format(step + 1)) for step in range(40))
    yield (
        "definition/doubled",
        document(base, steps + DEFINITION.format("a40", '<constant name="q" type="float"/>') + use),
    )
    wrong = '<texcoord name="s" type="vector2"/><sin name="q" type="float"><input name="in" type="float" nodename="s"/></sin>'
    yield "definition/types", document(base, DEFINITION.format("a0", wrong) + use)
    yield "definition/types-outside", document(base, '<texcoord name="x" type="vector2"/>')
    for number, word in enumerate(("float; } void evil() {", "gl_FragCoord", "main", "a b", "#undef")):
        link = f'<input name="in" type="float" nodename="{word}"/>'
        inside = f'<sin name="{word}" type="float"/><sin name="q" type="float">{link}</sin>'
        yield f"definition/words-{number}", document(base, DEFINITION.format("a0", inside) + use)
        primvar = f'<geompropvalue name="q" type="float"><input name="geomprop" type="string" value="{word}"/></geompropvalue>'
        yield f"definition/primvar-{number}", document(base, DEFINITION.format("a0", primvar) + use)
    yield (
        "definition/input-loop",
        document('<input name="base" interfacename="a"/>', '<input name="a" interfacename="a"/>'),
    )
    loop = (
        '<nodegraph name="G"><input name="a" nodegraph="G" output="o"/><output name="o" interfacename="a"/></nodegraph>'
    )
    yield "definition/output-loop", document('<input name="base" nodegraph="G" output="o"/>', loop)
    nested = '<input name="x">' * 3_000 + "</input>" * 3_000
    yield "definition/nested", document(base, DEFINITION.format("a0", nested) + use)
    for word in ("GRAPH", "focus", "Surface", "graph_texture", "mx_square", "vd"):
        renamed = DEFINITION.format("a0", f'<sin name="{word}" type="float"/>').replace('"NG_a0"', f'"{word}"')
        yield f"definition/name-{word}", document(base, renamed.replace('nodename="q"', f'nodename="{word}"') + use)
    code = '<implementation name="I" nodedef="ND_a0" function="main" target="genglsl" {}/>'
    for number, given in enumerate(
        (f'file="{canary}"', 'file="/dev/zero"', 'sourcecode="}} void main() {{ for (;;) ; }}"')
    ):
        yield f"definition/code-{number}", document(base, DEFINITION.format("a0", "") + code.format(given) + use)
    noise = "".join(f'<worleynoise3d name="n{number}" type="float"/>' for number in range(500))
    sums = "".join(
        f'<add name="s{number}" type="float"><input name="in1" type="float" nodename="n{number}"/>'
        f'<input name="in2" type="float" nodename="s{number - 1}"/></add>'
        for number in range(1, 150)
    )
    yield "definition/noise", document(base.replace('"x"', '"s149"'), noise + sums)


def _sizes() -> Texts:
    yield "deep/elements", document(nodes="<a>" * 100_000 + "</a>" * 100_000)
    yield "deep/graphs", document(nodes='<nodegraph name="G">' * 100_000 + "</nodegraph>" * 100_000)
    yield "deep/unclosed", document(nodes="<a>" * 1_000_000)
    yield "deep/model", "<!DOCTYPE x [<!ELEMENT x " + "(" * 50_000 + "a" + ")" * 50_000 + ">]>" + document()
    nodes = "".join(f'<image name="I{node}"><input name="file" value="a{node}.png"/></image>' for node in range(50_000))
    yield "many/nodes", document('<input name="base_color" nodename="I49999"/>', nodes)
    yield "many/inputs", document('<input name="base" value="1"/>' * 50_000)
    yield (
        "many/attributes",
        document().replace("<materialx", "<materialx " + " ".join(f'a{n}=""' for n in range(100_000)), 1),
    )
    yield (
        "many/spaces",
        document().replace("<materialx", "<materialx " + " ".join(f'xmlns:a{n}="b"' for n in range(50_000)), 1),
    )
    yield "many/values", document(f'<input name="base_color" value="{"0.5 " * 1_500_000}"/>')
    yield "many/token", "<" + "a" * 6_000_000


def _references(canary: Path) -> Iterator[tuple[str, Shot]]:
    """Shots whose reference itself is odd, or that have many of them."""
    for number, target in enumerate(
        (f"{canary}", "/etc/passwd.mtlx", "../../a.mtlx", "/dev/zero", "b/", "a.usdz[a.mtlx]")
    ):
        yield f"reference/{number}", {"room.usda": room(f"@{target}@</MaterialX>"), FILE: document()}
    yield (
        "reference/arguments",
        {"room.usda": room(f"@{FILE}:SDF_FORMAT_ARGS:root={canary}@</MaterialX>"), FILE: document()},
    )
    yield "reference/name-of-a-folder", {"room.usda": room(), f"{FILE}/b.txt": "b"}
    yield "reference/layer", {"room.usda": room(), FILE: ROOM}
    looks = "".join(f'def Scope "L{n}" (references = @{n}.mtlx@</MaterialX>) {{\n}}\n' for n in range(500))
    bound = "".join(SPHERE.format(n, f"/L{n}", "") for n in range(500))
    files: Shot = {f"{n}.mtlx": document('<input name="base_color" value="0.5 0.5 0.5"/>') for n in range(500)}
    yield "many/documents", {"room.usda": room() + looks + bound, FILE: document(), **files}
    bound = "".join(SPHERE.format(n, "/World/Looks", n) for n in range(2_000))
    nodes = "".join(MATERIAL.replace('"M"', f'"M{n}"') for n in reversed(range(50_000)))
    yield "many/materials", {"room.usda": room() + bound, FILE: document(nodes=nodes)}
