"""The manifests of Kubernetes: pods are confined, and names, ports, labels and settings fit together."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml

from service.http.configuration import read_configuration
from service.http.settings import Settings
from service.workers.sandbox import environment as sandbox_environment
from tests.docker.kits.commands import parse
from tests.docker.kits.files import (
    KUBERNETES,
    exec_form,
    inherited,
    last,
    pods,
    read_compose,
    read_resources,
    read_stages,
)

RESOURCES = read_resources()
PODS = dict(pods(RESOURCES))
NAMESPACE = "pullfocus"
BY_HAND = {"secret.example.yaml", "first_key.yaml"}
KUBERNETES_VERSION = "1.31"
KUSTOMIZATION: dict[str, Any] = yaml.safe_load((KUBERNETES / "kustomization.yaml").read_text())


def of_kind(kind: str) -> dict[str, dict[str, Any]]:
    """Return the resources of a kind by their names."""
    return {one["metadata"]["name"]: one for one in RESOURCES if one["kind"] == kind}


def container(name: str) -> dict[str, Any]:
    """Return the one container of a pod."""
    (only,) = PODS[name]["spec"]["containers"]
    return only


def settings() -> dict[str, Any]:
    return read_configuration(KUBERNETES / "serve.toml")


def command_of(name: str) -> list[str]:
    """Return the whole command line of a container."""
    entry = exec_form(last(inherited(read_stages(), "service"), "ENTRYPOINT"))
    return [*container(name).get("command", entry), *container(name)["args"]]


def is_selected(selector: dict[str, Any], labels: dict[str, str]) -> bool:
    """Whether a selector takes labels."""
    matches = selector.get("matchLabels", {}).items() <= labels.items()
    return matches and all(labels.get(one["key"]) in one["values"] for one in selector.get("matchExpressions", ()))


def selected(selector: dict[str, Any]) -> set[str]:
    """Return the pods that a selector takes."""
    return {name for name, pod in PODS.items() if is_selected(selector, pod["metadata"]["labels"])}


@pytest.mark.parametrize("resource", RESOURCES, ids=lambda one: f"{one['kind']}-{one['metadata']['name']}")
def test_the_schema_of_kubernetes_holds(resource) -> None:
    kubernetes_validate.validate(resource, KUBERNETES_VERSION, strict=True)


def test_each_file_is_applied_or_made_by_hand() -> None:
    files = {file.name for file in KUBERNETES.glob("*.yaml")} - {"kustomization.yaml"}
    assert set(KUSTOMIZATION["resources"]) == files - BY_HAND
    for resource in RESOURCES:
        named = resource["metadata"].get("namespace", resource["metadata"]["name"])
        assert named == NAMESPACE


@pytest.mark.parametrize("name", PODS)
def test_pods_keep_to_the_restricted_standard(name) -> None:
    """Pod Security Standards, profile `restricted`; the namespace enforces it."""
    pod = PODS[name]["spec"]
    assert pod["automountServiceAccountToken"] is False
    assert not {"hostNetwork", "hostPID", "hostIPC"} & set(pod)
    assert pod["securityContext"]["runAsNonRoot"] is True
    assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert container(name)["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    uid, gid = map(int, last(inherited(read_stages(), "service"), "USER").split(":"))
    context = pod["securityContext"]
    assert (context["runAsUser"], context["runAsGroup"], context["fsGroup"]) == (uid, gid, gid)
    labels = of_kind("Namespace")[NAMESPACE]["metadata"]["labels"]
    assert labels["pod-security.kubernetes.io/enforce"] == "restricted"


@pytest.mark.parametrize("name", PODS)
def test_pods_have_bounds_and_places_to_write(name) -> None:
    resources = container(name)["resources"]
    for amounts in (resources["requests"], resources["limits"]):
        assert {"cpu", "memory"} <= set(amounts)
    volumes = {volume["name"]: volume for volume in PODS[name]["spec"]["volumes"]}
    mounts = {mount["name"]: mount["mountPath"] for mount in container(name)["volumeMounts"]}
    assert set(mounts) == set(volumes)
    assert mounts["cache"] == "/cache"
    for volume in volumes.values():
        if "persistentVolumeClaim" in volume:
            assert volume["persistentVolumeClaim"]["claimName"] in of_kind("PersistentVolumeClaim")
            assert mounts[volume["name"]] == "/data"
        elif "configMap" in volume:
            (made,) = KUSTOMIZATION["configMapGenerator"]
            assert volume["configMap"]["name"] == made["name"]
            assert made["files"] == ["serve.toml"]
            assert str(parse(command_of(name))["config"]) == f"{mounts[volume['name']]}/serve.toml"
        else:
            assert volume["emptyDir"]["sizeLimit"]


@pytest.mark.parametrize("name", PODS)
def test_pods_run_the_images_that_compose_builds(name) -> None:
    built = {service["image"] for service in read_compose()["services"].values() if "build" in service}
    assert container(name)["image"] in built


@pytest.mark.parametrize("name", PODS)
def test_the_programs_take_their_command_lines(name) -> None:
    assert parse(command_of(name))


@pytest.mark.parametrize("name", PODS)
def test_variables_come_from_the_secret_or_are_known(name) -> None:
    secret = of_kind("Secret")["pullfocus"]["stringData"]
    for variable in container(name).get("env", ()):
        source = variable.get("valueFrom", {})
        if "secretKeyRef" in source:
            assert source["secretKeyRef"]["name"] == "pullfocus"
            assert source["secretKeyRef"]["key"] in secret
        else:
            assert not re.search("PASSWORD|SECRET|KEY", variable["name"])
            assert variable["name"] in sandbox_environment._ALLOWED | {"AWS_REGION"}


def test_the_example_of_the_secret_has_no_secret() -> None:
    values = of_kind("Secret")["pullfocus"]["stringData"].values()
    assert all(re.fullmatch("<.*>", value) for value in values)


def test_the_service_is_probed_by_what_it_answers() -> None:
    made = container("service")
    ports = {port["name"]: port["containerPort"] for port in made["ports"]}
    assert ports["http"] == settings()["port"]
    for probe, path in (("startupProbe", "/livez"), ("livenessProbe", "/livez"), ("readinessProbe", "/readyz")):
        assert made[probe]["httpGet"] == {"path": path, "port": "http"}
    grace = PODS["service"]["spec"]["terminationGracePeriodSeconds"]
    assert grace > settings().get("stop_grace_s", Settings.stop_grace_s)


def test_scheduler_and_workers_are_probed_where_they_are() -> None:
    scheduler = parse(command_of("scheduler"))
    ports = {port["name"]: port["containerPort"] for port in container("scheduler")["ports"]}
    assert ports == {"dask": int(scheduler["port"]), "health": int(scheduler["dashboard_address"].lstrip(":"))}
    assert container("scheduler")["livenessProbe"]["httpGet"] == {"path": "/health", "port": "health"}
    joined = exec_form(last(inherited(read_stages(), "worker"), "HEALTHCHECK"))
    for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
        assert container("worker")[probe]["exec"]["command"] == joined


def test_services_lead_to_pods() -> None:
    for name, service in of_kind("Service").items():
        assert selected({"matchLabels": service["spec"]["selector"]}) == {name}
        ports = {port["name"] for port in container(name)["ports"]}
        assert {port["targetPort"] for port in service["spec"]["ports"]} <= ports
    (port,) = of_kind("Service")["scheduler"]["spec"]["ports"]
    for name in ("service", "worker"):
        assert parse(command_of(name))["dask"] == f"tcp://scheduler:{port['port']}"


def test_selectors_take_their_own_pods() -> None:
    for kind in ("StatefulSet", "Deployment"):
        for name, one in of_kind(kind).items():
            assert selected(one["spec"]["selector"]) == {name}
    assert selected(of_kind("PodDisruptionBudget")["worker"]["spec"]["selector"]) == {"worker"}


def test_the_folder_of_shots_has_one_service() -> None:
    assert of_kind("StatefulSet")["service"]["spec"]["replicas"] == 1
    (claim,) = of_kind("PersistentVolumeClaim").values()
    assert claim["spec"]["accessModes"] == ["ReadWriteOnce"]


def test_the_ingress_leads_to_the_service_by_a_name_of_its() -> None:
    ingress = of_kind("Ingress")["service"]
    (rule,), (tls,) = ingress["spec"]["rules"], ingress["spec"]["tls"]
    assert tls["hosts"] == [rule["host"]]
    assert rule["host"] in settings()["allowed_hosts"]
    (path,) = rule["http"]["paths"]
    target = path["backend"]["service"]
    assert target["port"]["name"] in {port["name"] for port in of_kind("Service")[target["name"]]["spec"]["ports"]}
    notes = ingress["metadata"]["annotations"]
    size = notes["nginx.ingress.kubernetes.io/proxy-body-size"]
    assert int(size.removesuffix("m")) > settings().get("max_upload_mb", Settings.max_upload_mb)


def test_the_settings_are_those_of_a_service_behind_a_proxy() -> None:
    made = Settings(**settings())
    assert made.access == "keys"
    assert made.host == "0.0.0.0"
    assert made.trusted_proxies
    assert not re.search(r"//[^/@]*:[^/@]*@", made.database), "the password is in the Secret"


def test_traffic_that_no_rule_names_is_refused() -> None:
    policies = of_kind("NetworkPolicy")
    assert policies["nothing"]["spec"] == {"podSelector": {}, "policyTypes": ["Ingress", "Egress"]}
    for name in ("service", "scheduler", "worker"):
        assert selected(policies[name]["spec"]["podSelector"]) == {name}


def test_those_who_talk_are_let_out_and_in() -> None:
    allowed = {(one, other) for one in PODS for other in PODS if may_talk(one, other)}
    assert allowed == {
        ("service", "scheduler"),
        ("worker", "scheduler"),
        ("scheduler", "worker"),
    }
    (way,) = of_kind("NetworkPolicy")["service"]["spec"]["ingress"]
    assert [port["port"] for port in way["ports"]] == [settings()["port"]]


def may_talk(one: str, other: str) -> bool:
    """Whether a pod may connect to another one: both the way out and the way in have to be open."""
    policies = of_kind("NetworkPolicy").values()
    out = [
        rule.get("to", ())
        for policy in policies
        if one in selected_by(policy)
        for rule in policy["spec"].get("egress", ())
    ]
    into = [
        rule["from"]
        for policy in policies
        if other in selected_by(policy)
        for rule in policy["spec"].get("ingress", ())
    ]
    return names(out, other) and names(into, one)


def selected_by(policy: dict[str, Any]) -> set[str]:
    return selected(policy["spec"]["podSelector"])


def names(rules: list[list[dict[str, Any]]], pod: str) -> bool:
    """Whether peers of rules are a pod of this namespace."""
    peers = [peer for rule in rules for peer in rule if set(peer) == {"podSelector"}]
    return any(pod in selected(peer["podSelector"]) for peer in peers)


@pytest.mark.skipif(not shutil.which("kubectl"), reason="kubectl is not installed")
@pytest.mark.parametrize("graphics", ["mesa", "nvidia"])
def test_kustomize_renders_the_folder(graphics, tmp_path: Path) -> None:
    shutil.copytree(KUBERNETES, tmp_path / "base")
    lines = ["resources: [base]", *(["components: [base/nvidia]"] if graphics == "nvidia" else [])]
    (tmp_path / "kustomization.yaml").write_text("\n".join(lines))
    command = ["kubectl", "kustomize", tmp_path]
    rendered = list(yaml.safe_load_all(subprocess.run(command, capture_output=True, text=True, check=True).stdout))
    for resource in rendered:
        kubernetes_validate.validate(resource, KUBERNETES_VERSION, strict=True)
    (config,) = [one["metadata"]["name"] for one in rendered if one["kind"] == "ConfigMap"]
    made = dict(pods(rendered))
    mounted = [volume["configMap"]["name"] for volume in made["service"]["spec"]["volumes"] if "configMap" in volume]
    assert mounted == [config]
    for name in ("service", "worker"):
        (only,) = made[name]["spec"]["containers"]
        assert only["image"].endswith("-nvidia") == (graphics == "nvidia")
        assert ("nvidia.com/gpu" in only["resources"]["limits"]) == (graphics == "nvidia")
