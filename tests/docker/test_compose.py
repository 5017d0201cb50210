"""The Compose files: what each container may do, and that their names, ports and settings fit together."""

from __future__ import annotations

import ipaddress
import json
import re
import subprocess
import sys
from typing import Any
from urllib.parse import urlsplit

import pytest
from sqlalchemy import make_url

from service.http.configuration import read_configuration
from service.http.settings import Settings
from service.workers.sandbox import environment as sandbox_environment
from tests.docker.kits.commands import parse
from tests.docker.kits.files import (
    DOCKER,
    ROOT,
    VERSION,
    exec_form,
    image_environment,
    inherited,
    last,
    read_compose,
    read_stages,
)

COMPOSE = read_compose()
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OURS = ("service", "worker", "scheduler")
ROOT_IMAGES = {"proxy", "minio", "bucket"}
"""Containers of others whose images have no user that could write to a volume: root, without any capability."""
OF_LIBRARIES = {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY", "AWS_REGION", "PGPASSWORD"}
"""Variables that the libraries for the bucket and for PostgreSQL read."""
SECRET = re.compile(r"PASSWORD|SECRET|KEY|MC_HOST|ROOT_USER")
OUTSIDE = re.compile(r"\$\{(\w+):\?[^}]*\}")
"""A value of docker/.env, without which Compose refuses to start."""


def settings() -> dict[str, Any]:
    return read_configuration(DOCKER / "serve.toml")


def command_of(name: str) -> list[str]:
    """Return the whole command line of a container of ours."""
    service = SERVICES[name]
    made = inherited(read_stages(), service["image"].removeprefix("pullfocus-").partition(":")[0])
    entry = service.get("entrypoint") or exec_form(last(made, "ENTRYPOINT"))
    return [*entry, *service.get("command", exec_form(last(made, "CMD")))]


@pytest.mark.parametrize("name", SERVICES)
def test_a_container_may_do_as_little_as_it_needs(name) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service.get("cap_add", []) == (["NET_BIND_SERVICE"] if name == "proxy" else [])
    assert set(service["deploy"]["resources"]["limits"]) == {"cpus", "memory", "pids"}
    assert not {"privileged", "devices", "pid", "ipc", "network_mode", "userns_mode"} & set(service)
    assert any(mount.startswith("/tmp") for mount in service["tmpfs"])


@pytest.mark.parametrize("name", SERVICES)
def test_no_container_is_root_but_those_that_have_to_be(name) -> None:
    user = SERVICES[name].get("user", last(inherited(read_stages(), "service"), "USER") if name in OURS else "0")
    assert (user.partition(":")[0] == "0") == (name in ROOT_IMAGES)


def test_only_the_proxy_can_be_reached_from_outside() -> None:
    outside = {name for name, network in COMPOSE["networks"].items() if not (network or {}).get("internal")}
    assert [name for name, service in SERVICES.items() if "ports" in service] == ["proxy"]
    assert [name for name, service in SERVICES.items() if outside & set(service["networks"])] == ["proxy"]


def test_networks_and_volumes_are_declared_and_used() -> None:
    assert {network for service in SERVICES.values() for network in service["networks"]} == set(COMPOSE["networks"])
    mounts = [mount.split(":")[0] for service in SERVICES.values() for mount in service.get("volumes", ())]
    assert {mount for mount in mounts if mount[0] not in "./"} == set(COMPOSE["volumes"])
    files = [mount for mount in mounts if mount.startswith("./")]
    assert files
    assert all((DOCKER / file).is_file() for file in files)


def test_containers_talk_to_those_in_their_networks() -> None:
    for one, other in (
        ("proxy", "service"),
        ("service", "postgres"),
        ("service", "minio"),
        ("service", "scheduler"),
        ("worker", "scheduler"),
        ("bucket", "minio"),
    ):
        assert set(SERVICES[one]["networks"]) & set(SERVICES[other]["networks"]), (one, other)
    for one, other in (("worker", "postgres"), ("worker", "minio"), ("proxy", "scheduler"), ("postgres", "scheduler")):
        assert not set(SERVICES[one]["networks"]) & set(SERVICES[other]["networks"]), (one, other)


@pytest.mark.parametrize("name", SERVICES)
def test_what_is_waited_for_can_come(name) -> None:
    stages = read_stages()
    for other, wait in SERVICES[name].get("depends_on", {}).items():
        if wait["condition"] == "service_healthy":
            assert "healthcheck" in SERVICES[other] or last(inherited(stages, other), "HEALTHCHECK")
        else:
            assert wait["condition"] == "service_completed_successfully"
            assert SERVICES[other]["restart"] == "on-failure"  # it ends


@pytest.mark.parametrize("name", SERVICES)
def test_images_have_exact_versions_and_no_registry(name) -> None:
    image, _, tag = SERVICES[name]["image"].partition(":")
    assert re.fullmatch(r"[a-z-]+(/[a-z-]+)?", image)
    assert re.search(r"\d+\.\d+|\d{4}-\d\d-\d\d", tag)
    if name in OURS:
        assert tag == VERSION
        assert image.removeprefix("pullfocus-") in ("service", "worker")


def test_each_image_of_ours_is_built_from_its_target() -> None:
    built = {service["image"]: service["build"] for service in SERVICES.values() if "build" in service}
    assert set(built) == {SERVICES[name]["image"] for name in OURS}
    for image, build in built.items():
        assert f"pullfocus-{build['target']}:" in image
        assert build["target"] in read_stages()
        assert (DOCKER / build["context"]).resolve() == ROOT
        assert (ROOT / build["dockerfile"]).is_file()


@pytest.mark.parametrize("name", OURS)
def test_the_programs_take_their_command_lines(name) -> None:
    assert parse(command_of(name))


def test_a_wrong_command_line_would_be_refused(capsys) -> None:
    with pytest.raises(SystemExit):
        parse([*command_of("worker"), "--memory", "8192"])
    with pytest.raises(Exception, match=r"[Nn]o such option|unexpected"):
        parse([*command_of("scheduler"), "--dashbord"])


def test_worker_and_service_join_the_scheduler() -> None:
    scheduler = parse(command_of("scheduler"))
    address = f"tcp://scheduler:{scheduler['port']}"
    assert parse(command_of("service"))["dask"] == address
    assert parse(command_of("worker"))["dask"] == address
    worker = exec_form(last(inherited(read_stages(), "worker"), "HEALTHCHECK"))
    assert worker[-2:] == ["joined", scheduler["port"]]
    *_, port, path = SERVICES["scheduler"]["healthcheck"]["test"]
    assert (f":{port}", path) == (scheduler["dashboard_address"], "/health")


def test_the_settings_are_settings_of_the_service() -> None:
    typed = parse(command_of("service"))
    mounted = {
        inside: outside for outside, inside, *_ in (mount.split(":") for mount in SERVICES["service"]["volumes"])
    }
    assert mounted[str(typed["config"])] == "./serve.toml"
    made = Settings(**settings())
    assert made.host == "0.0.0.0"
    assert made.access == "keys"


def test_addresses_of_the_settings_are_those_of_containers() -> None:
    given = settings()
    database = make_url(given["database"])
    postgres = SERVICES["postgres"]["environment"]
    assert (database.host, database.username, database.database, database.password) == (
        "postgres",
        postgres["POSTGRES_USER"],
        postgres["POSTGRES_DB"],
        None,
    )
    endpoint = urlsplit(given["bucket_endpoint"])
    assert endpoint.hostname == "minio"
    assert f":{endpoint.port}" in SERVICES["minio"]["command"]
    bucket = urlsplit(given["bucket"]).netloc
    assert f"mc mb --ignore-existing root/{bucket}\n" in SERVICES["bucket"]["command"][0]
    policy = json.loads((DOCKER / "bucket_policy.json").read_text())
    resources = {resource for statement in policy["Statement"] for resource in statement["Resource"]}
    assert resources == {f"arn:aws:s3:::{bucket}", f"arn:aws:s3:::{bucket}/*"}


def test_the_proxy_passes_on_to_the_service_which_trusts_it() -> None:
    caddy = (DOCKER / "Caddyfile").read_text()
    port = last(inherited(read_stages(), "service"), "EXPOSE")
    assert re.findall(r"reverse_proxy (\S+)", caddy) == [f"service:{port}"]
    assert settings()["port"] == int(port)
    assert "tls internal" in caddy
    inside = {published.split(":")[1] for published in SERVICES["proxy"]["ports"]}
    assert inside == set(re.findall(r"^\thttps?_port (\d+)", caddy, re.MULTILINE))
    address = SERVICES["proxy"]["networks"]["front"]["ipv4_address"]
    (network,) = COMPOSE["networks"]["front"]["ipam"]["config"]
    assert ipaddress.ip_address(address) in ipaddress.ip_network(network["subnet"])
    assert settings()["trusted_proxies"] == (address,)
    assert parse(command_of("service"))["allowed_hosts"] == [SERVICES["proxy"]["environment"]["PULLFOCUS_HOST"]]
    check = urlsplit(SERVICES["proxy"]["healthcheck"]["test"][-1])
    assert f"http://:{check.port} {{" in caddy


@pytest.mark.parametrize("name", OURS)
def test_variables_of_the_environment_are_read(name) -> None:
    """Those of the workers' drivers are in the sandbox's list; of the others there are few."""
    given = set(SERVICES[name].get("environment", ()))
    assert given <= sandbox_environment._ALLOWED | OF_LIBRARIES
    if name != "service":
        assert not given & OF_LIBRARIES
    assert not set(image_environment(inherited(read_stages(), "service"))) & OF_LIBRARIES


def test_workers_have_as_many_threads_as_processors() -> None:
    for name in ("service", "worker"):
        assert (
            SERVICES[name]["environment"]["LP_NUM_THREADS"] == SERVICES[name]["deploy"]["resources"]["limits"]["cpus"]
        )


def test_a_container_has_time_and_memory_for_its_program() -> None:
    assert int(SERVICES["service"]["stop_grace_period"].rstrip("s")) > Settings.stop_grace_s
    limit = int(SERVICES["worker"]["deploy"]["resources"]["limits"]["memory"].rstrip("G")) * 1024
    assert limit > parse(command_of("worker"))["memory_mb"]


def test_secrets_come_from_outside_and_have_to() -> None:
    used = set()
    for name, service in SERVICES.items():
        for variable, value in service.get("environment", {}).items():
            if SECRET.search(variable):
                names = re.findall(OUTSIDE, value)
                given = urlsplit(re.sub(OUTSIDE, "", value)).netloc.rpartition("@")[0] if "//" in value else value
                assert names, f"{name}: {variable} has a value, or may be empty"
                assert not re.sub(OUTSIDE, "", given).strip(":"), f"{name}: {variable} has a part that is no reference"
                used |= set(names)
    example = dict(re.findall(r"^(\w+)=(.*)$", (DOCKER / ".env.example").read_text(), re.MULTILINE))
    assert used == set(example) - {"PULLFOCUS_HOST"}
    assert not any(example[name] for name in used)
    assert "/docker/.env" in (ROOT / ".gitignore").read_text().splitlines()


def test_the_service_does_not_have_the_administrators_secret() -> None:
    assert not re.search("MINIO_ROOT", str(SERVICES["service"]))


def test_the_nvidia_file_changes_service_and_workers() -> None:
    nvidia = read_compose("compose.nvidia.yaml")["services"]
    assert set(nvidia) == set(OURS)
    for name, change in nvidia.items():
        assert change["image"] == f"{SERVICES[name]['image']}-nvidia"
        if "build" in SERVICES[name]:
            assert change["build"]["args"] == {"GRAPHICS": "nvidia"}
            (device,) = change["deploy"]["resources"]["reservations"]["devices"]
            assert {"gpu", "graphics"} <= set(device["capabilities"])


@pytest.mark.parametrize("file", ["compose.yaml", "compose.nvidia.yaml"])
def test_the_schema_of_compose_files_holds(file) -> None:
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.compose-spec", DOCKER / file]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout
