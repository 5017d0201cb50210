"""Bucket of S3-compatible storage, against a real server of it."""

from __future__ import annotations

import hashlib

import pytest

from render.errors import SettingsError
from service.storage.bucket import PART_BYTES, Bucket
from service.storage.errors import UnavailableError


@pytest.fixture
def opened(bucket) -> Bucket:
    return Bucket(bucket["bucket"], bucket["bucket_endpoint"])


def hash_of(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@pytest.mark.parametrize(
    ("setting", "endpoint", "message"),
    [
        ("renders", "", "the setting bucket is s3://BUCKET"),
        ("s3://Renders", "", "the setting bucket is"),
        ("s3://renders/../others", "", "the setting bucket is"),
        ("gs://renders", "", "the setting bucket is"),
        ("s3://renders", "minio:9000", "bucket_endpoint is http"),
        ("s3://renders", "http://user:password@minio:9000", "bucket_endpoint is http"),
    ],
)
def test_settings_that_are_no_bucket_are_refused(setting, endpoint, message):
    with pytest.raises(SettingsError, match=message) as raised:
        Bucket(setting, endpoint)
    assert "password" not in str(raised.value)


def test_objects_are_stored_listed_and_deleted(opened, tmp_path):
    (tmp_path / "file").write_bytes(b"from a file")
    opened.put("a/one", b"1")
    opened.put("a/b/two", tmp_path / "file")
    opened.put("ab/three", b"")
    assert (opened.read("a/one"), opened.read("a/b/two"), opened.read("ab/three")) == (b"1", b"from a file", b"")
    assert opened.read("a/none") is None
    assert opened.sizes("a") == {"one": 1, "b/two": 11}
    assert opened.folders("a") == ["b"]
    assert 0 <= opened.age_s("a/one") < 600
    opened.delete(["a/one", "a/never"])
    opened.delete([])
    assert (opened.sizes("a"), opened.age_s("a/one")) == ({"b/two": 11}, None)


def test_a_prefix_is_a_bucket_of_its_own(bucket, opened):
    opened.put("a/one", b"1")
    other = Bucket(bucket["bucket"].replace("studio", "other"), bucket["bucket_endpoint"])
    assert (other.sizes("a"), other.read("a/one")) == ({}, None)


def test_large_objects_come_in_parts(opened, tmp_path):
    content = bytes(range(256)) * (2 * PART_BYTES // 256) + b"end"
    opened.put("large", content)
    assert b"".join(opened.parts("large")) == content
    assert opened.fetch("large", hash_of(content), tmp_path / "copy")
    assert (tmp_path / "copy").read_bytes() == content


def test_a_damaged_object_leaves_no_copy(opened, tmp_path):
    opened.put("frame", b"other bytes")
    assert not opened.fetch("frame", hash_of(b"bytes"), tmp_path / "copy")
    assert not opened.fetch("none", hash_of(b"bytes"), tmp_path / "copy")
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_reached_is_named_without_its_address(bucket, tmp_path):
    gone = Bucket(bucket["bucket"], "http://127.0.0.1:1")
    missing = Bucket("s3://there-is-none", bucket["bucket_endpoint"])
    for ask in (
        gone.check,
        missing.check,
        lambda: gone.put("a", b"1"),
        lambda: gone.delete(["a"]),
        lambda: gone.age_s("a"),
    ):
        with pytest.raises(UnavailableError, match="the bucket of renders cannot be used now") as raised:
            ask()
        assert raised.value.code == "bucket_unusable"
        assert "127.0.0.1" not in str(raised.value)
