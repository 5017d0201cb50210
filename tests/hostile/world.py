"""A service among secrets that no upload may reach."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import numpy as np

from service.http.settings import Settings
from tests.hostile.asking import SMALL, answer_of
from tests.hostile.corpus import Canaries, graded_by_secret, secret_cube
from tests.hostile.runner import COLOUR_STEPS, picture_of
from tests.service.conftest import running


@dataclass(frozen=True)
class World:
    """A service that runs, and what is outside of every upload.

    Attributes:
        client: of the service.
        canaries: secrets.
        places: folders that no answer may name.
        template: returns the id of the process that forks the workers.
    """

    client: httpx.Client
    canaries: Canaries
    places: tuple[str, ...]
    template: Callable[[], int]


@contextmanager
def hostile_world(folder: Path) -> Iterator[World]:
    """Run a service whose environment and neighbouring folders hold canaries."""
    text, cube, variable = folder / "secret.txt", folder / "secret.cube", "PULLFOCUS_CANARY"
    values = ("canary-of-a-file-4711", "canary-of-the-environment-4711")
    text.write_text(f"{values[0]}\n")
    cube.write_text(f"# {values[0]}\n{secret_cube()}")
    os.environ[variable] = values[1]
    try:
        with running(Settings(data=folder / "data", demo=False)) as service:
            places = (str(folder / "data"), sys.prefix)
            yield World(
                service.client,
                Canaries(text, cube, variable, values, _secret_colour(service.client)),
                places,
                lambda: service.internal.pool.template.pid,
            )
    finally:
        del os.environ[variable]


def _secret_colour(client: httpx.Client) -> tuple[float, ...]:
    """Colour of a picture that the secret look-up table grades."""
    case = graded_by_secret()
    shot = f"/v1/shots/{client.post('/v1/shots', files={'file': (case.file, case.content)}).json()['id']}"
    pixels = picture_of(answer_of(client.get(f"{shot}/frame", params=SMALL)))
    client.delete(shot)
    assert pixels is not None
    colour = np.median(pixels, axis=(0, 1))
    assert np.abs(pixels - colour).max() <= COLOUR_STEPS, "it is one colour"
    return tuple(map(float, colour))
