"""Settings of a service: its data folder and its limits."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from service.http.logs import LogFormat
from service.models.curve import MAX_CURVE_FRAMES
from service.workers.folders import default_cache_folder

MEBIBYTE = 1024 * 1024
Access = Literal["open", "insecure", "keys"]


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
        otlp_endpoint: address of an OpenTelemetry collector that traces of requests are sent to over HTTP, such as
            `http://localhost:4318`; it needs `pullfocus[tracing]`. The default is that of `OTEL_EXPORTER_OTLP_ENDPOINT`, if any.
        data: folder of shots and their edits; created when missing.
        database: address of a PostgreSQL database for the renders, such as `postgresql://pullfocus@db.studio.example/renders`; it
            needs `pullfocus[postgresql]`. The default is SQLite in the data folder.
        bucket: bucket of S3-compatible storage for the frames of renders and for their shots, as `s3://BUCKET/PREFIX`, so that
            several services share them; it needs `pullfocus[s3]`. The default is the data folder.
        bucket_endpoint: address of the server of the bucket, such as `http://minio:9000`; empty for that of `AWS_ENDPOINT_URL`,
            or Amazon's.
        fetched_mb: size of the shots that are kept of those which were fetched from the bucket, MiB.
        demo: whether the demo shot is written there at start.
        static: folder of the built page.
        allowed_hosts: names allowed in the `Host` header, beside the address that a connection came to. The default is loopback
            names only, so that no web page can reach the service by pointing its own name at 127.0.0.1.
        access: who may use the service without a key. `open`: anyone, where this machine alone reaches it; elsewhere nobody.
            `keys`: nobody. `insecure`: anyone who reaches it.
        oidc_issuer: address of an OpenID Connect issuer whose tokens are accepted beside keys; empty for none.
        oidc_audience: audience that its tokens must be for.
        oidc_claim: claim of a token that says what its holder may do; `realm_access.roles` is the claim `roles` within
            `realm_access`.
        oidc_roles: what the values of that claim stand for, each as `VALUE = ROLE @ PROJECT`. The first that a holder has decides
            the project.
        requests_per_s: requests that one sender may go on sending, 0 for any number; an `open` service does not limit them.
        quota_shots: shots that a project may have, those in the trash too; 0 for any number.
        quota_stored_mb: size of the shots of a project with their edits, those in the trash too, MiB; 0 for any size. A shot that
            would exceed it is refused; edits are not.
        quota_cpu_s_per_day: processor time that the work for one sender may take in 24 hours, s; 0 for any time.
        event_days: days for which events are kept, so that a reader who was away can go on where it was.
        webhook_private: whether webhooks may reach this machine and private networks, as for receivers in a studio's own network.
            The default is true on a service that is open, because this machine alone reaches it, and false elsewhere.
        trash_days: days for which a deleted shot can be restored; 0 removes it at once.
        max_upload_mb: size of one upload, MiB.
        max_unpacked_mb: size that an archive may unpack to, MiB.
        max_archive_entries: files and folders in an archive.
        max_archive_ratio: size of an unpacked archive over its own.
        max_picture_px: width times height of one picture.
        max_picture_s: estimated processor time of one picture, s; one that is expected to take longer is refused.
        max_curve_frames: frames of one focus curve.
        max_waiting: requests that may wait in each lane; one more is answered 503.
        max_waiting_each: requests of one client that may wait in each lane; one more is answered 503.
        max_viewers: live connections at a time. Where all are open, a client with at least two fewer than whoever has the most
            takes one of those; otherwise one more is answered 503. As many may follow events.
        frame_timeout_s: time for one picture, waiting not counted.
        stage_timeout_s: time for one reading or edit of a stage, waiting not counted.
        check_memory_mb: memory of a process that opens an upload for the first time, MiB.
        stage_memory_mb: memory of a process that reads and edits a shot, MiB.
        picture_memory_mb: memory of a process that draws pictures of a shot, MiB.
        worker_disk_mb: space on the disk for the compiled shaders, tables and temporary files of one worker process, MiB.
        kept_memory_mb: memory of all shots that are kept open between requests, MiB.
        pictures_at_a_time: pictures that are drawn at a time; 0 takes one for each GPU, or for every four cores (of live
            previews, for every core and a half).
        gpus: GPUs that shots are spread over; 0 leaves the choice to the driver.
        worker_read: files and folders beside a shot's own that worker processes may read, such as libraries of assets.
        max_blames: times that a shot may end a worker process before it is quarantined.
        cache: folder of the workers' compiled shaders, tables and temporary files; created when missing.
        frame_cache_mb: size of the cache of encoded pictures, MiB.
        min_free_mb: free space on the disk of the data folder, MiB; with less, the service is not ready.
        dask: where the frames of renders are drawn: empty for the workers of the service, `local:N` for N more processes of this
            machine, or the address of a Dask scheduler such as `tcp://farm:8786`; both need `pullfocus[dask]`.
        max_lane_age_s: time that a request may wait in a lane, s; while one has waited longer, the service is not ready.
        stop_grace_s: time that requests in progress have to end when the service is stopped, s.
    """

    host: str = "127.0.0.1"
    port: int = 8000
    trusted_proxies: tuple[str, ...] = ()
    log_format: LogFormat | None = None
    otlp_endpoint: str = ""
    data: Path = field(default_factory=default_data_folder)
    database: str = field(default="", repr=False)  # it may have a password
    bucket: str = ""
    bucket_endpoint: str = ""
    fetched_mb: int = 20_480
    demo: bool = True
    static: Path = Path(__file__).parents[1] / "static"
    allowed_hosts: tuple[str, ...] = ("127.0.0.1", "localhost", "[::1]")
    access: Access = "open"
    oidc_issuer: str = ""
    oidc_audience: str = "pullfocus"
    oidc_claim: str = "roles"
    oidc_roles: tuple[str, ...] = ()
    requests_per_s: float = 50.0
    quota_shots: int = 0
    quota_stored_mb: int = 0
    quota_cpu_s_per_day: float = 0.0
    event_days: float = 7.0
    webhook_private: bool | None = None
    trash_days: int = 30
    max_upload_mb: int = 512
    max_unpacked_mb: int = 2048
    max_archive_entries: int = 10_000
    max_archive_ratio: int = 200
    max_picture_px: int = 4096 * 2304
    max_picture_s: float = 600.0
    max_curve_frames: int = MAX_CURVE_FRAMES
    max_waiting: int = 128
    max_waiting_each: int = 64
    max_viewers: int = 64
    frame_timeout_s: float = 300.0
    stage_timeout_s: float = 120.0
    check_memory_mb: int = 3072
    stage_memory_mb: int = 6144
    picture_memory_mb: int = 8192
    worker_disk_mb: int = 2048
    kept_memory_mb: int = 4096
    pictures_at_a_time: int = 0
    gpus: int = 0
    worker_read: tuple[Path, ...] = ()
    max_blames: int = 3
    cache: Path = field(default_factory=default_cache_folder)
    frame_cache_mb: int = 256
    min_free_mb: int = 256
    dask: str = ""
    max_lane_age_s: float = 60.0
    stop_grace_s: float = 30.0
