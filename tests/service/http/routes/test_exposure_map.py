"""Exposure maps over HTTP: the scene-linear light of the command line, and the answers to odd requests."""

from __future__ import annotations

import json
import struct
import zlib

import numpy as np
import OpenImageIO
import pytest

from service.picture.exposure_maps import encode_exposure_map, stops_from_grey

SMALL = {"time": 12, "width": 96, "height": 54}
LUMINANCE = np.array([0.2722287, 0.6740818, 0.0536895])
"""Y of ACEScg's primaries (Academy S-2014-004)."""


def decode(content):
    """Decode an exposure map by the description of `getExposureMap`: its head, and ``(height, width)`` stops."""
    (size,) = struct.unpack_from(">I", content)
    head = json.loads(content[4 : 4 + size])
    planes = np.frombuffer(zlib.decompress(content[4 + size :]), np.uint8).reshape(2, head["height"], head["width"])
    steps = planes[0].astype(np.uint16) | (planes[1].astype(np.uint16) << 8)
    numbers = np.cumsum(steps, axis=-1, dtype=np.uint16).view(np.int16)
    return head, np.where(numbers == -32768, -np.inf, numbers / head["stepsPerStop"])


def exposure_map(client, shot, **parameters):
    """Ask for a small exposure map."""
    return client.get(f"/v1/shots/{shot}/exposure-map", params=SMALL | parameters)


def test_it_is_the_light_of_the_frame_in_stops(client, room, tmp_path):
    exr = tmp_path / "frame.exr"
    exr.write_bytes(client.get(f"/v1/shots/{room}/frame", params=SMALL | {"format": "exr"}).raise_for_status().content)
    light = OpenImageIO.ImageBuf(str(exr)).get_pixels(OpenImageIO.FLOAT)[..., :3] @ LUMINANCE
    answer = exposure_map(client, room)
    assert answer.status_code == 200, answer.text
    head, stops = decode(answer.content)
    assert (head["width"], head["height"]) == (96, 54)
    scale = client.get(f"/v1/shots/{room}/readout/exposure", params={"time": 12}).json()["exposureScale"]
    np.testing.assert_allclose(stops[light > 0], np.log2(scale * light[light > 0] / 0.18), atol=0.004)
    assert (stops[light <= 0] == -np.inf).all()
    assert np.ptp(stops[light > 0]) > 2


def test_a_stop_more_light_is_a_stop_more(client, room):
    before = exposure_map(client, room)
    tag = before.headers["etag"]
    unchanged = client.get(f"/v1/shots/{room}/exposure-map", params=SMALL, headers={"If-None-Match": tag})
    assert unchanged.status_code == 304
    client.patch(f"/v1/shots/{room}/camera/exposure", json={"compensationStops": 1}).raise_for_status()
    after = exposure_map(client, room)
    assert after.headers["etag"] != tag
    (_, dim), (_, bright) = decode(before.content), decode(after.content)
    lit = np.isfinite(dim)
    assert np.median(bright[lit] - dim[lit]) == 1
    np.testing.assert_allclose(bright[lit] - dim[lit], 1, atol=0.2)  # rays go where the exposed picture has noise


def test_grey_is_at_zero_and_no_light_at_the_least():
    light = np.array([[[0.18] * 3, [0.36] * 3, [0.09] * 3, [0] * 3, [1e30] * 3]], np.float32)
    _, stops = decode(encode_exposure_map(stops_from_grey(light)))
    np.testing.assert_array_equal(stops[0, :4], [0, 1, -1, -np.inf])
    random = np.exp2(np.random.default_rng(1).uniform(-20, 20, (7, 9, 1))).astype(np.float32) * np.ones(3, np.float32)
    _, stops = decode(encode_exposure_map(stops_from_grey(random)))
    np.testing.assert_allclose(stops, np.log2(random[..., 0] / 0.18), atol=0.002)


@pytest.mark.parametrize(
    "parameters", [{"width": 0}, {"width": 8192, "height": 8192}, {"time": "nan"}, {"camera": "/no/such"}]
)
def test_odd_requests_get_a_problem(client, room, parameters):
    answer = exposure_map(client, room, **parameters)
    assert answer.status_code == 422
    assert answer.json()["detail"]
