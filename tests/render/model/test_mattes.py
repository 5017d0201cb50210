"""Hashes and ranks of Cryptomatte, and sums over parts of a picture and moments."""

from __future__ import annotations

import numpy as np
import pytest

from render.model.mattes import MATERIAL, OBJECT, RANKS, MatteSum, id_bits, id_of, make_matte_sum, murmur3


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", 0),
        ("hello", 0x248BFA47),
        ("Hello, world!", 0xC0363E43),
        ("The quick brown fox jumps over the lazy dog", 0x2E4FF723),
    ],
)
def test_hashes_are_those_of_murmurhash3(text: str, expected: int) -> None:
    assert murmur3(text) == expected


def test_ids_are_those_of_other_renderers() -> None:
    """Ids in the headers of Arnold's and Unreal's files, and of the bunny of Psyop's sample."""
    assert [f"{id_bits(name):08x}"[:7] for name in ("crypto_object", "crypto_material", "uCryptoAsset")] == [
        "f834d0a",
        "bda530a",
        "d593dd7",
    ]
    assert float(id_of("bunny")) == pytest.approx(3.36000126251e-27, rel=1e-11)


def test_every_id_is_a_normal_float() -> None:
    names = [f"/World/prim{i}" for i in range(3000)]
    exponents = {name: murmur3(name) >> 23 & 0xFF for name in names}
    extreme = [name for name, exponent in exponents.items() if exponent in (0, 255)]
    assert {exponents[name] for name in extreme} == {0, 255}

    ids = np.array([id_of(name) for name in extreme])

    assert (np.isfinite(ids) & (np.abs(ids) >= np.finfo(np.float32).tiny)).all()
    for name in names:
        assert id_bits(name) == murmur3(name) or name in extreme


def put(mattes: MatteSum, column: int, row: int, *entries: tuple[int, float]) -> None:
    numbers, weights = (np.array(values)[:, None, None] for values in zip(*entries, strict=True))
    mattes.put((column, row, 1, 1), numbers.astype(np.uint32), weights[..., None].astype(np.float32))


def test_prims_and_materials_are_ranked_by_coverage() -> None:
    mattes = MatteSum(2, 1)
    tree, bush, rock = (mattes.number(*pair) for pair in (("/tree", "/leaf"), ("/bush", "/leaf"), ("/rock", "")))
    put(mattes, 0, 0, (rock, 0.375), (tree, 0.25), (bush, 0.25))
    put(mattes, 1, 0, (bush, 1.0))
    mattes.end_moment(1.0)

    objects, names = mattes.rank(OBJECT)
    assert names == ("/bush", "/rock", "/tree")
    assert objects.shape == (1, 2, 2 * RANKS)
    assert objects[0, 0, 0] == id_of("/rock")
    np.testing.assert_array_equal(objects[0, 0, 1:8:2], np.float32([0.375, 0.25, 0.25, 0]))
    assert set(objects[0, 0, 2:6:2]) == {id_of("/tree"), id_of("/bush")}
    assert (objects[0, 0, 6:] == 0).all()

    materials, names = mattes.rank(MATERIAL)
    assert names == ("/leaf", "default")
    np.testing.assert_array_equal(materials[0, 0, :4], [id_of("/leaf"), 0.5, id_of("default"), np.float32(0.375)])


def test_only_the_greatest_ranks_are_kept() -> None:
    mattes = MatteSum(1, 1)
    numbers = [mattes.number(f"/prim{i}", "") for i in range(9)]
    put(mattes, 0, 0, *((number, (i + 1) / 64) for i, number in enumerate(numbers)))
    mattes.end_moment(1.0)

    ranked, names = mattes.rank(OBJECT)

    np.testing.assert_array_equal(ranked[0, 0, 1::2], np.float32([9, 8, 7, 6, 5, 4]) / 64)
    assert names == tuple(f"/prim{i}" for i in range(3, 9))


def test_moments_are_weighed_where_the_shutter_is() -> None:
    mattes = MatteSum(1, 2)
    one, other = mattes.number("/one", ""), mattes.number("/other", "")
    for moment, number in enumerate((one, other)):
        for row in range(2):
            put(mattes, 0, row, (number, 1.0))
        mattes.end_moment(
            np.array([[[0.25]], [[0.75]]], np.float32) if moment == 0 else np.float32([[[0.75]], [[0.25]]])
        )

    ranked, _ = mattes.rank(OBJECT)

    np.testing.assert_array_equal(ranked[0, 0, :4], [id_of("/other"), 0.75, id_of("/one"), 0.25])
    np.testing.assert_array_equal(ranked[1, 0, :4], [id_of("/one"), 0.75, id_of("/other"), 0.25])


def test_an_empty_picture_has_no_ids() -> None:
    mattes = MatteSum(3, 2)
    mattes.number("/never_seen", "")
    mattes.end_moment(1.0)

    ranked, names = mattes.rank(OBJECT)

    assert not ranked.any()
    assert names == ()
    assert make_matte_sum(3, 2, ("color", "depth")) is None
