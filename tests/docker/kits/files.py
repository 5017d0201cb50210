"""The files of docker/, parsed."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[3]
DOCKER = ROOT / "docker"
KUBERNETES = DOCKER / "kubernetes"
VERSION: str = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


@dataclass
class Stage:
    """A stage of the Dockerfile.

    Attributes:
        name: of the stage.
        base: image or stage that it begins with.
        instructions: the others, in their order, each with its argument on one line.
    """

    name: str
    base: str
    instructions: list[tuple[str, str]] = field(default_factory=list)


def read_stages() -> dict[str, Stage]:
    """Read the stages of the Dockerfile by their names."""
    text = re.sub(r"^\s*#.*\n", "", (DOCKER / "Dockerfile").read_text(), flags=re.MULTILINE)
    stages: dict[str, Stage] = {}
    for line in filter(None, re.sub(r"\\\n\s*", "", text).splitlines()):
        word, argument = line.split(maxsplit=1)
        if word == "FROM":
            base, name = re.fullmatch(r"(\S+) AS (\S+)", argument).groups()
            stages[name] = stage = Stage(name, base)
        else:
            stage.instructions.append((word, argument))
    return stages


def inherited(stages: dict[str, Stage], name: str) -> list[tuple[str, str]]:
    """Return the instructions that make an image: those of its stage, after those of all that it begins with."""
    stage = stages[name]
    return [*(inherited(stages, stage.base) if stage.base in stages else ()), *stage.instructions]


def last(instructions: list[tuple[str, str]], word: str) -> str:
    """Return the argument of the last instruction of a kind, which holds for the image."""
    return [argument for found, argument in instructions if found == word][-1]


def exec_form(argument: str) -> list[str]:
    """Return the words of an instruction's exec form. A shell form is no JSON, and fails."""
    words = json.loads(argument[argument.index("[") :])
    assert all(isinstance(word, str) for word in words)
    return words


def image_environment(instructions: list[tuple[str, str]]) -> dict[str, str]:
    """Return the environment of an image."""
    settings = " ".join(argument for word, argument in instructions if word == "ENV")
    return dict(re.findall(r"(\w+)=(\S+)", settings))


def read_compose(name: str = "compose.yaml") -> dict[str, Any]:
    """Read a Compose file."""
    return yaml.safe_load((DOCKER / name).read_text())


def read_resources() -> list[dict[str, Any]]:
    """Read the resources of Kubernetes, those that are applied by hand among them."""
    files = [file for file in sorted(KUBERNETES.glob("*.yaml")) if file.name != "kustomization.yaml"]
    return [resource for file in files for resource in yaml.safe_load_all(file.read_text())]


def pods(resources: list[dict[str, Any]]) -> Iterator[tuple[str, dict[str, Any]]]:
    """Find the templates of pods, with the names of their resources."""
    for resource in resources:
        template = resource.get("spec", {}).get("template")
        if template is not None:
            yield resource["metadata"]["name"], template
