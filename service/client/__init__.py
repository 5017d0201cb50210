"""Client of a Pullfocus service: push shots, send renders, watch them and fetch their frames. It needs httpx alone.

    from pullfocus_client import Client

    with Client("http://render.example:8000", key="...") as client:
        shot = client.push("night_street.usdz")
        render = client.render(shot, frames="1-96:2", width=960, rays=64)
        client.download(render, "frames", follow=True, on_progress=print)

`AsyncClient` is the same for asyncio. Inside the application the package is `service.client`; the wheel
``pullfocus-client`` has it as ``pullfocus_client``.
"""

from .async_client import AsyncClient
from .errors import (
    AnswerError,
    ClientError,
    ConnectionFailedError,
    FileError,
    Finding,
    RefusedError,
    SettingError,
    WaitTimeoutError,
)
from .models import (
    Attempt,
    CameraChoice,
    FrameRange,
    Render,
    RenderPlan,
    RenderSettings,
    RenderTask,
    Shot,
    ShotSummary,
)
from .operations import ENDED
from .steps import Retries
from .sync_client import Client

__all__ = [
    "ENDED",
    "AnswerError",
    "AsyncClient",
    "Attempt",
    "CameraChoice",
    "Client",
    "ClientError",
    "ConnectionFailedError",
    "FileError",
    "Finding",
    "FrameRange",
    "RefusedError",
    "Render",
    "RenderPlan",
    "RenderSettings",
    "RenderTask",
    "Retries",
    "SettingError",
    "Shot",
    "ShotSummary",
    "WaitTimeoutError",
]
