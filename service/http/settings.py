"""Settings of a service: its data folder and its limits."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from service.http.logs import LogFormat
from service.models.curve import MAX_CURVE_FRAMES

MEBIBYTE = 1024 * 1024


def default_data_folder() -> Path:
    """Return the data folder used by default: ``$XDG_DATA_HOME/pullfocus``, else ``~/.local/share/pullfocus``."""
    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(base) / "pullfocus"


@dataclass(frozen=True)
class Settings:
    """Data folder of a service, and limits that keep one client from exhausting the machine.

    Attributes:
        host: address to listen on.
        port: port to listen on; 0 takes a free one.
        trusted_proxies: addresses of proxies whose `X-Forwarded-For` and `X-Forwarded-Proto` headers are believed.
        log_format: `text` for people or `json` for programs. The default is text on a terminal, and JSON elsewhere.
        data: folder of shots and their edits; created when missing.
        demo: whether the demo shot is written there at start.
        static: folder of the built page.
        allowed_hosts: names allowed in the `Host` header; empty allows every name. The default is loopback names only, so that
            no web page can reach the service by pointing its own name at 127.0.0.1.
        max_upload_mb: size of one upload, MiB.
        max_unpacked_mb: size that an archive may unpack to, MiB.
        max_archive_entries: files and folders in an archive.
        max_archive_ratio: size of an unpacked archive over its own.
        max_picture_px: width times height of one picture.
        max_curve_frames: frames of one focus curve.
        max_waiting: requests that may wait for each worker process; one more is answered 503.
        max_viewers: live connections at a time; one more is answered 503.
        frame_timeout_s: time for one call of the picture process, waiting not counted.
        stage_timeout_s: time for one call of the stage process, waiting not counted.
        frame_cache_mb: size of the cache of encoded pictures, MiB.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    trusted_proxies: tuple[str, ...] = ()
    log_format: LogFormat | None = None
    data: Path = field(default_factory=default_data_folder)
    demo: bool = True
    static: Path = Path(__file__).parents[1] / "static"
    allowed_hosts: tuple[str, ...] = ("127.0.0.1", "localhost", "[::1]")
    max_upload_mb: int = 512
    max_unpacked_mb: int = 2048
    max_archive_entries: int = 10_000
    max_archive_ratio: int = 200
    max_picture_px: int = 4096 * 2304
    max_curve_frames: int = MAX_CURVE_FRAMES
    max_waiting: int = 32
    max_viewers: int = 32
    frame_timeout_s: float = 300.0
    stage_timeout_s: float = 120.0
    frame_cache_mb: int = 256
