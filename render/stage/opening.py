"""Opening of stages. Damage and references outside the folder are errors; files that a layer refers to in vain are findings."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pxr import Ar, Pcp, Sdf, Tf, Usd, UsdUtils

from render.errors import StageError
from render.stage.confinement import check_confined
from render.stage.faults import shorten, text_of
from render.stage.findings import FindingLog
from render.stage.options import Resolver
from render.stage.population import EVERYTHING, Population, compose
from usd_schemas import SchemaError
from usd_schemas.units import metres_per_unit

# In the session layer's customLayerData: the folder that nothing may leave. The session layer is ours, so a file cannot say it.
_CONFINED_TO = "pullfocus:confinedTo"
# Metadata of a session layer that is its own and not the stage's.
_NOT_OF_STAGE = ("subLayers", "subLayerOffsets", "customLayerData", "comment", "documentation")
_TF_REASON = re.compile(r" : '(.*?)'(?:\n|$)", re.DOTALL)
_SESSION = re.compile(r",?@anon:0x[0-9a-f]+:session\.usda@(?:<[^>]*>)?")
_ASSET = re.compile(r"@(.+?)@")
_SUBLAYER_OF = re.compile(r" of layer @(.+?)@")
_WHY_UNREADABLE = re.compile(r" -- (.*?)[ .]*(?:; skipping)?$")


@dataclass(frozen=True)
class LostFile:
    """File that a stage refers to and that cannot be opened.

    Attributes:
        name: its path from the stage's folder.
        reason: empty where the file does not exist, else why it cannot be read.
        users: the prims and layers that refer to it, such as ``prim /World/Chair`` and ``layer shot.usda``.
    """

    name: str
    reason: str
    users: tuple[str, ...]

    @property
    def message(self) -> str:
        """One sentence with the file and its first user."""
        what = f"cannot be read ({self.reason})" if self.reason else "is missing"
        others = len(self.users) - 1
        refer = f"and {others} more refer to it and are" if others else "refers to it and is"
        return f"{self.name} {what}: {self.users[0]} {refer} read without it"


def open_stage(
    path: str | Path,
    *,
    edit_layer: Sdf.Layer | None = None,
    session_layer: Path | None = None,
    resolver: Resolver = "root",
    population: Population = EVERYTHING,
    confined_to: Path | None = None,
) -> Usd.Stage:
    """Open a stage. Where a referenced file is lost, the rest is opened: see `lost_files`.

    Args:
        path: a .usd, .usda, .usdc or .usdz file.
        edit_layer: goes strongest into the session layer and becomes the edit target, so that files are never written.
        session_layer: layer that goes into the session layer, below the edits.
        resolver: ``root`` finds assets from the folder of the root layer, ``inherit`` from the environment alone.
        population: prims that are composed.
        confined_to: the folder that everything the stage refers to must lie in, after links and ``..`` are followed.

    Raises:
        StageError: code ``stage_missing``, ``stage_unreadable`` (not USD, or damaged), ``outside_reference``, ``bad_unit`` or
            ``bad_time``.
    """
    file = Path(path)
    # Uploaders know their files by name alone.
    name = str(file) if confined_to is None else file.name
    session = Sdf.Layer.CreateAnonymous("session.usda")
    with quiet_diagnostics():
        root = _read_layer(file, name, confined_to)
        if edit_layer is not None:
            session.subLayerPaths.append(edit_layer.identifier)
        if session_layer is not None:
            _add_session(session, _read_layer(session_layer, str(session_layer), confined_to))
        if confined_to is not None:
            session.customLayerData = {_CONFINED_TO: str(Path(confined_to).resolve())}
        stage = _compose(root, name, session, resolver, population)
    _check_unit(stage, name)
    _check_times(stage, name)
    if edit_layer is not None:
        stage.SetEditTarget(Usd.EditTarget(edit_layer))
    return stage


def confinement(stage: Usd.Stage) -> Path | None:
    """The folder that a stage was confined to when it was opened, or None."""
    folder = stage.GetSessionLayer().customLayerData.get(_CONFINED_TO) if stage.GetSessionLayer() else None
    return Path(folder) if folder else None


def composition_findings(stage: Usd.Stage, log: FindingLog) -> None:
    """Note lost files, each once, and other composition errors that leave the rest of the stage usable."""
    for lost in lost_files(stage):
        log.add("unreadable_reference" if lost.reason else "missing_reference", lost.name, lost.message)
    for error in stage.GetCompositionErrors():
        text = _one_line(text_of(error))
        if _lost_file(error) is None and not _is_materialx(text):
            text = _relative(text, _folder(stage))
            log.add("composition", str(error.rootSite.path), f"the stage does not compose cleanly: {text}")


def lost_files(stage: Usd.Stage) -> list[LostFile]:
    """List the references, payloads and sublayers that cannot be opened, by name."""
    users: dict[str, set[str]] = {}
    reasons: dict[str, str] = {}
    for error in stage.GetCompositionErrors():
        file = _lost_file(error)
        text = _one_line(text_of(error))
        if file is None or _is_materialx(text):
            continue
        name = _relative(file, _folder(stage))
        layer = _SUBLAYER_OF.search(text)
        users.setdefault(name, set()).add(
            f"layer {Path(layer.group(1)).name}" if layer else f"prim {error.rootSite.path}"
        )
        why = _WHY_UNREADABLE.search(text)
        if why:
            reasons[name] = _relative(why.group(1), _folder(stage))
        elif Path(file).exists():
            reasons.setdefault(name, "it is damaged")
    return [LostFile(name, reasons.get(name, ""), tuple(sorted(users[name]))) for name in sorted(users)]


@contextlib.contextmanager
def quiet_diagnostics() -> Iterator[None]:
    """Keep USD's own warnings off the terminal; what matters of them comes back as errors and findings."""
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    finally:
        delegate.TakeUncoalescedDiagnostics()


@contextlib.contextmanager
def read_quietly(stage: Usd.Stage) -> Iterator[None]:
    """Context that reads values without diagnostics; damage that shows only then (usdc is read lazily) becomes a StageError."""
    try:
        with quiet_diagnostics():
            yield
    except Tf.ErrorException as error:
        name = stage.GetRootLayer().GetDisplayName()
        reason = _relative(_reason(error), _folder(stage))
        raise StageError(f"a file of {name} is damaged: {reason}", code="stage_unreadable", path=name) from error


def _reason(error: Tf.ErrorException) -> str:
    reasons = _TF_REASON.findall(text_of(error))
    if reasons and "bad_alloc" in reasons[0]:
        return "it takes more memory than there is"
    return shorten(_one_line(reasons[0])) if reasons else "it cannot be read"


def _read_layer(file: Path, name: str, confined_to: Path | None) -> Sdf.Layer:
    if not file.is_file():
        raise StageError(f"{name} is not a file that can be opened", code="stage_missing", path=name)
    if confined_to is not None:
        check_confined(file, confined_to)
    with _unreadable(name, file.parent):
        layer = Sdf.Layer.FindOrOpen(str(file))
    if not layer:
        message = f"{name} is not a USD file: expected .usd, .usda, .usdc or .usdz content"
        raise StageError(message, code="stage_unreadable", path=name)
    return layer


def _add_session(session: Sdf.Layer, layer: Sdf.Layer) -> None:
    """Add a session layer of the caller's below what is there, with its metadata: USD reads a stage's from the session itself."""
    session.subLayerPaths.append(layer.identifier)
    for field in layer.pseudoRoot.ListInfoKeys():
        if field not in _NOT_OF_STAGE:
            session.pseudoRoot.SetInfo(field, layer.pseudoRoot.GetInfo(field))


def _compose(root: Sdf.Layer, name: str, session: Sdf.Layer, resolver: Resolver, population: Population) -> Usd.Stage:
    context = Ar.GetResolver().CreateDefaultContext()
    if resolver == "root":
        context = Ar.GetResolver().CreateDefaultContextForAsset(root.identifier)
    with _unreadable(name, Path(root.realPath).parent):
        return compose(root, session, context, population)


@contextlib.contextmanager
def _unreadable(name: str, folder: Path) -> Iterator[None]:
    try:
        yield
    except Tf.ErrorException as error:
        message = f"{name} is not a readable USD file: {_relative(_reason(error), folder)}"
        raise StageError(message, code="stage_unreadable", path=name) from error


def _lost_file(error: Pcp.ErrorBase) -> str | None:
    """File that could not be opened; None for an error of another kind."""
    asset = _ASSET.search(text_of(error))
    lost = (Pcp.ErrorInvalidAssetPathBase, Pcp.ErrorInvalidSublayerPath)
    return asset.group(1) if asset and isinstance(error, lost) else None


def _check_unit(stage: Usd.Stage, name: str) -> None:
    try:
        metres_per_unit(stage)
    except SchemaError as error:
        raise StageError(_relative(str(error), _folder(stage)), code="bad_unit", path=name) from error


def _check_times(stage: Usd.Stage, name: str) -> None:
    """Raise StageError for rates and ranges that no shot can have."""
    rates = {"timeCodesPerSecond": stage.GetTimeCodesPerSecond(), "framesPerSecond": stage.GetFramesPerSecond()}
    for field, value in rates.items():
        if not (math.isfinite(value) and value > 0):
            message = f"{field} of {name} must be a positive number, got {value:g}"
            raise StageError(message, code="bad_time", path=name)
    ends = {"startTimeCode": stage.GetStartTimeCode(), "endTimeCode": stage.GetEndTimeCode()}
    for field, value in ends.items():
        if not math.isfinite(value):
            message = f"{field} of {name} must be a finite number, got {value:g}"
            raise StageError(message, code="bad_time", path=name)


def _folder(stage: Usd.Stage) -> Path:
    """Folder that messages name files from: the one that confines the stage, else the stage's own."""
    return confinement(stage) or Path(stage.GetRootLayer().realPath).parent


def _relative(text: str, folder: Path) -> str:
    """A message with its files named from a folder: shorter, and without the server's own paths for those who upload.

    USD names files by their whole path, however the folder was given; our own session layer means nothing to anyone.
    """
    text = _SESSION.sub("", text)
    return text.replace(f"{folder.resolve()}/", "").replace(f"{folder.absolute()}/", "")


def _is_materialx(text: str) -> bool:
    """Whether an error is only about a MaterialX file that is there, which usd-core has no reader for."""
    match = _ASSET.search(text)
    file = match.group(1).split(":SDF_FORMAT_ARGS:")[0] if match else ""
    return file.endswith(".mtlx") and Path(file).is_file()


def _one_line(text: str) -> str:
    return " ".join(text.split()).rstrip(".")
