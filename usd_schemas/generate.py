"""Writes the files that derive from the declarations in `usd_schemas.settings`: ``python -m usd_schemas.generate [--check]``.

schema.usda is written from the declarations; usdGenSchema, which is in the usd-core wheel, makes generatedSchema.usda and
plugInfo.json of it. Two things are put right after it: its placeholders in plugInfo.json become the places of a plugin that is
one folder, and the full documentation of every property goes back into generatedSchema.usda (usdGenSchema keeps the first
sentence alone), so that tools can show it.

The declarations are imported before USD, so ``python usd_schemas/generate.py`` also runs where the generated files are missing or
broken and the plugin cannot be registered.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pxr import Sdf

FOLDER = Path(__file__).resolve().parent
if not __package__:  # run as a script: the folder itself is on the path in place of its parent
    sys.path[0] = str(FOLDER.parent)
SOURCE = "schema.usda"
GENERATED = ("generatedSchema.usda", "plugInfo.json")


def _run_usdgenschema(folder: Path) -> None:
    """Run usdGenSchema in a folder that holds schema.usda.

    Raises:
        RuntimeError: it failed; the message is what it printed.
    """
    # Without our own plugin on the path: the schema is defined from its source alone.
    environment = {name: value for name, value in os.environ.items() if name != "PXR_PLUGINPATH_NAME"}
    command = [sys.executable, "-m", "pxr.Usd.usdGenSchema", "--quiet", "schema.usda", "."]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0 or not all((folder / name).is_file() for name in GENERATED):
        raise RuntimeError(f"usdGenSchema could not read schema.usda: {(done.stderr + done.stdout).strip()}")


def _plug_info(text: str) -> str:
    """Put the plugin's places where usdGenSchema leaves placeholders; ``text`` and the result are plugInfo.json."""
    info = json.loads("\n".join(line for line in text.splitlines() if not line.startswith("#")))
    for plugin in info["Plugins"]:
        plugin.update(Root=".", LibraryPath="", ResourcePath=".", Type="resource")
    head = "# Generated from schema.usda by `python -m usd_schemas.generate`: do not edit.\n"
    return head + json.dumps(info, indent=4, sort_keys=True) + "\n"


def _documented(source: Path, generated: Path) -> str:
    """Return the text of generatedSchema.usda with the full documentation of schema.usda put back."""
    from pxr import Sdf

    origin = Sdf.Layer.OpenAsAnonymous(str(source))
    result = Sdf.Layer.OpenAsAnonymous(str(generated))
    result.comment = "Generated from schema.usda by `python -m usd_schemas.generate`: do not edit."
    for original in origin.rootPrims:
        spec = result.GetPrimAtPath(original.path)
        if spec is None:  # the GLOBAL prim speaks to usdGenSchema alone
            continue
        _document(spec, original)
        prefix = original.customData.get("propertyNamespacePrefix")
        for attribute in original.properties:
            name = f"{prefix}:__INSTANCE_NAME__:{attribute.name}" if prefix else attribute.name
            _document(spec.properties[name], attribute)
    return str(result.ExportToString()).rstrip() + "\n"


def _document(spec: Sdf.Spec, original: Sdf.Spec) -> None:
    """Give a generated prim or property its full documentation, and its first sentence in one line."""
    spec.documentation = "\n".join(line.strip() for line in original.documentation.strip().splitlines())
    spec.customData["userDocBrief"] = " ".join(spec.customData["userDocBrief"].split())


def generate(source: str | None = None) -> dict[str, str]:
    """Return the text of each generated file by name.

    Args:
        source: the text of schema.usda; None for what the declarations give.

    Raises:
        RuntimeError: usdGenSchema refused the source.
    """
    from usd_schemas.schema_source import schema_source

    source = schema_source() if source is None else source
    with tempfile.TemporaryDirectory() as folder_name:
        folder = Path(folder_name)
        (folder / SOURCE).write_text(source, encoding="utf-8")
        _run_usdgenschema(folder)
        return {
            SOURCE: source,
            "generatedSchema.usda": _documented(folder / SOURCE, folder / "generatedSchema.usda"),
            "plugInfo.json": _plug_info((folder / "plugInfo.json").read_text(encoding="utf-8")),
        }


def stale_files(folder: Path = FOLDER, source: str | None = None) -> list[str]:
    """Names of the generated files in ``folder`` that are missing or not what the declarations, or ``source``, give."""
    return [
        name
        for name, text in generate(source).items()
        if not (folder / name).is_file() or (folder / name).read_text(encoding="utf-8") != text
    ]


def main(arguments: list[str] | None = None) -> int:
    """Write the generated files, or with ``--check`` say whether they are current; returns the exit status."""
    parser = argparse.ArgumentParser(prog="python -m usd_schemas.generate", description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a file is not current")
    options = parser.parse_args(arguments)
    try:
        if options.check:
            stale = stale_files()
            if stale:
                print(f"not current: {', '.join(stale)}; run `make schema`", file=sys.stderr)
            return 1 if stale else 0
        for name, text in generate().items():
            (FOLDER / name).write_text(text, encoding="utf-8")
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
