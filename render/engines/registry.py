"""Registry of the engines, by name.

Every module of `render.engines` but this one and `base` holds an engine and is found by listing the package: a new engine is
a new file. An engine defined elsewhere, as in a test, is added by `register`.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING, TypeGuard

from render.engines.base import Engine
from render.errors import SettingsError
from render.model.frame_settings import FrameSettings
from render.model.mattes import MATTES

if TYPE_CHECKING:
    from render.model.scene import Scene

_NOT_ENGINES = ("base", "registry")
_engines: dict[str, type[Engine]] = {}


def register(engine: type[Engine]) -> None:
    """Add an engine.

    Raises:
        ValueError: another engine has its name, or it lacks a name or a summary.
    """
    for attribute in ("name", "summary"):
        value = getattr(engine, attribute, None)
        if not isinstance(value, str) or not value:
            raise ValueError(f"engine {engine.__name__} needs a {attribute}, got {value!r}")
    if _engines.setdefault(engine.name, engine) is not engine:
        raise ValueError(f"there are two engines of the name {engine.name}")


def unregister(engine: type[Engine]) -> None:
    """Remove an engine."""
    del _engines[engine.name]


def all_engines() -> tuple[type[Engine], ...]:
    """Return the engines in the order of help texts."""
    return tuple(sorted(_engines.values(), key=lambda engine: (engine.rank, engine.name)))


def engine_names() -> tuple[str, ...]:
    """Return the engines' names in the order of help texts."""
    return tuple(engine.name for engine in all_engines())


def engine_class(settings: FrameSettings) -> type[Engine]:
    """Return the engine class that settings name.

    Raises:
        SettingsError: there is none of that name.
    """
    engine = _engines.get(settings.engine)
    if engine is None:
        raise SettingsError(f"engine must be one of {', '.join(engine_names())}, got {settings.engine!r}")
    return engine


def check_settings(settings: FrameSettings) -> None:
    """Check that an engine exists that can draw these settings. Loads no OpenGL: call it before anything slow.

    Raises:
        SettingsError: no engine has that name, it does not draw motion from velocities, it has no mattes or deep pictures,
            or both are asked for at once.
    """
    engine = engine_class(settings)
    if settings.motion > 1 and settings.motion_by == "velocities" and not engine.takes_velocities:
        raise SettingsError(f"the {engine.name} engine draws every moment by itself: ask for motion by moments")
    mattes = [name for name in settings.aovs if name in MATTES]
    if settings.deep and mattes:
        raise SettingsError(f"a deep picture has no {' and '.join(mattes)}: make them in a picture of their own")
    if settings.deep:
        mattes = ["deep pictures"]
    if mattes and not engine.draws_mattes:
        able = ", ".join(other.name for other in all_engines() if other.draws_mattes)
        raise SettingsError(f"the {engine.name} engine has no {' and '.join(mattes)}: take one of {able}")


def check_scene(settings: FrameSettings, scene: Scene) -> None:
    """Check that the engine shows all of a scene.

    Raises:
        SettingsError: the scene has Gaussian splats, and the engine, or a deep picture, shows surfaces alone.
    """
    engine = engine_class(settings)
    if scene.splats and not engine.draws_splats:
        able = ", ".join(other.name for other in all_engines() if other.draws_splats)
        raise SettingsError(
            f"the {engine.name} engine shows no Gaussian splats, and the shot has some: take one of {able}"
        )
    if scene.splats and settings.deep:
        raise SettingsError(
            "a deep picture holds surfaces alone, and the shot has Gaussian splats: make one that is not deep"
        )


def sharp_engine() -> str:
    """Return the name of the engine that renders everything sharp, for metering light and finding highlights."""
    return next(engine.name for engine in all_engines() if engine.is_sharp)


def discover(path: list[str]) -> None:
    """Register the engines of a package's modules.

    Args:
        path: folders of the package, ``__path__``.

    Raises:
        ImportError: a module cannot be loaded, or holds no engine.
    """
    for module in iter_modules(path):
        if not module.ispkg and module.name not in _NOT_ENGINES:
            _register_module(f"render.engines.{module.name}")


def _register_module(name: str) -> None:
    """Register the engines of a module. Raises `ImportError`: it cannot be loaded, or holds no engine."""
    try:
        module = import_module(name)
        engines = [value for value in vars(module).values() if _is_defined_in(name, value)]
        for engine in engines:
            register(engine)
    except Exception as error:
        raise ImportError(f"engine module {name} cannot be used: {type(error).__name__}: {error}") from error
    if not engines:
        raise ImportError(f"engine module {name} cannot be used: it defines no subclass of Engine")


def _is_defined_in(name: str, value: object) -> TypeGuard[type[Engine]]:
    return isinstance(value, type) and issubclass(value, Engine) and value.__module__ == name
