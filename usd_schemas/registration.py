"""Registers the schema plugin with USD and proves that it took, when this module is imported.

USD reads schema definitions once, at the first query, and ignores plugins that come later without a word; a plugin with
a wrong ``schemaKind`` or no ``bases`` it ignores as well. So registering is followed by asking for every schema.
"""

from __future__ import annotations

from pathlib import Path

from pxr import Plug, Usd

from usd_schemas.errors import SchemaError

PLUGIN = "pullfocus"
FOLDER = Path(__file__).resolve().parent
SINGLE_APPLY = ("LensAPI", "ApertureAPI", "TiltShiftAPI", "FilmAPI", "FocusAPI")
FOCUS_POINT = "FocusPointAPI"
LENS_CAMERA = "LensCamera"


def register() -> None:
    """Make the schemas known to USD in this process.

    Raises:
        SchemaError: the plugin's files are missing, another version of the plugin was registered first, or USD had
            already read its schema definitions.
    """
    missing = [name for name in ("plugInfo.json", "generatedSchema.usda") if not (FOLDER / name).is_file()]
    if missing:
        raise SchemaError(
            f"the USD plugin in {FOLDER} lacks {' and '.join(missing)}: expected the files that "
            "`python usd_schemas/generate.py` makes"
        )
    Plug.Registry().RegisterPlugins(str(FOLDER))
    plugin = Plug.Registry().GetPluginWithName(PLUGIN)
    if plugin is None:
        raise SchemaError(f"USD found no plugin named {PLUGIN} in {FOLDER / 'plugInfo.json'}")
    _refuse_other_version(Path(plugin.resourcePath))
    absent = _absent_schemas()
    if absent:
        raise SchemaError(
            f"USD does not know {', '.join(absent)} though the plugin {PLUGIN} is registered: expected usd_schemas to be "
            "imported before any stage is opened in this process (or PXR_PLUGINPATH_NAME to name its folder), got a USD "
            "whose schema definitions had been read already"
        )


def _refuse_other_version(registered: Path) -> None:
    """Raise if the plugin that USD took, say from PXR_PLUGINPATH_NAME, is not the one beside this file."""
    if registered.resolve() == FOLDER:
        return
    name = "generatedSchema.usda"
    if not (registered / name).is_file() or (registered / name).read_bytes() != (FOLDER / name).read_bytes():
        raise SchemaError(
            f"two versions of the USD plugin {PLUGIN}: this Python belongs to {FOLDER}, but USD took {registered}; "
            "correct PXR_PLUGINPATH_NAME"
        )


def _absent_schemas() -> list[str]:
    """The schemas that USD's registry does not define."""
    registry = Usd.SchemaRegistry()
    applied = [name for name in (*SINGLE_APPLY, FOCUS_POINT) if registry.FindAppliedAPIPrimDefinition(name) is None]
    return applied + ([] if registry.FindConcretePrimDefinition(LENS_CAMERA) else [LENS_CAMERA])


register()
