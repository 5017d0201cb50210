"""An absurd picture: as costly as the service admits."""

from __future__ import annotations

from service.bench.requests import Abandoned, frame_path

WIDTH, MOST_RAYS = 1920, 4096
LESS = 0.8
"""Rays of the next attempt over those that were refused."""
REFUSED_WITHIN_S = 10.0
LEAVES_AFTER_S = 1.0
"""Time after which the client of an absurd picture has left, s."""


def absurd_path(shot: str, rays: int, seed: int) -> str:
    """Return the path of a picture with very many rays.

    Args:
        shot: its id.
        rays: for each pixel.
        seed: two pictures with different ones share no cache.
    """
    return frame_path(shot, width=WIDTH, rays=rays, time=1, seed=seed)


def admitted_rays(port: int, client: int, shot: str) -> tuple[int, int | None]:
    """Find an absurd picture just below the limit of the service, and leave it again.

    Args:
        port: of the service.
        client: number of the client.
        shot: its id.

    Returns:
        The most rays that are admitted, of the numbers that are tried; and the least that are refused with 422, or None.
    """
    rays, refused = MOST_RAYS, None
    while rays > 1:
        request = Abandoned(port, client, absurd_path(shot, rays, seed=1))
        status = request.status_within(REFUSED_WITHIN_S)
        request.leave()
        if status != 422:
            break
        rays, refused = int(rays * LESS), rays
    return rays, refused
