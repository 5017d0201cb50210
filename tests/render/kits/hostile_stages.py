"""Stages of a few kilobytes that would take gigabytes or minutes to be opened."""

from __future__ import annotations

HEAD = "#usda 1.0\n"
LINK = 'def "p{}" {{\n def "a" ({}references = </p{}>) {{}}\n def "b" ({}references = </p{}>) {{}}\n}}\n'
STAGE_BOMBS = {
    "parentheses": f'{HEAD}def "W" {{\n custom float3 x = {"(" * 60_000}{")" * 60_000}\n}}',
    "parentheses_apart_by_comments": f'{HEAD}def "W" {{\n custom float3 x = {"( /*)*/ " * 9000}{")" * 9000}\n}}',
    "brackets": f'{HEAD}def "W" {{\n custom float[] x = {"[" * 60_000}{"]" * 60_000}\n}}',
    "dictionaries": f"{HEAD}(customLayerData = {{{'dictionary a = {' * 20_000}{'}' * 20_000}}})",
    "prims": HEAD + 'def "a" {\n' * 50_000 + "}\n" * 50_000,
    "references_doubled": HEAD
    + "".join(LINK.format(i, "", i + 1, "", i + 1) for i in range(17))
    + 'def Sphere "p17" {}',
    "payloads_doubled": HEAD
    + "".join(LINK.format(i, "", i + 1, "", i + 1) for i in range(17)).replace("references", "payload")
    + 'def Sphere "p17" {}',
    "inherits_doubled": HEAD
    + "".join(LINK.format(i, "", i + 1, "", i + 1) for i in range(17)).replace("references", "inherits")
    + 'def Sphere "p17" {}',
    "references_in_variants": HEAD
    + "".join(
        f'def "p{i}" (variantSets = ["v"]) {{\n variantSet "v" = {{\n "x" {{\n  def "a" (references = </p{i + 1}>) {{}}\n'
        f'  def "b" (references = </p{i + 1}>) {{}}\n }}\n }}\n}}\n'
        for i in range(17)
    )
    + 'def Sphere "p17" {}',
    "a_long_chain": HEAD + "".join(f'def "p{i}" (references = </p{i + 1}>) {{}}\n' for i in range(2000)),
    "value_clips": f'{HEAD}def "W" (clips = {{dictionary default = {{string templateAssetPath = "./c.###.usd"\n'
    "double templateStartTime = 0\ndouble templateEndTime = 1e7\ndouble templateStride = 0.01\n"
    'string primPath = "/W"}}) {}',
}
