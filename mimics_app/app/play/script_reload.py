"""Live reload of a scenario plug-in: a saved script replaces the running one between trials; a broken one does not."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.session.session import Session
from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.contracts.errors import MimicsError
from mimics_app.contracts.ports.plugins import raised
from mimics_app.contracts.ports.scenario_port import PLUGINS
from mimics_app.contracts.system.regular_file import read_regular
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.watcher import SceneWatcher

__all__ = ["ScriptReload"]

_MOST_BYTES = 1 << 24


class ScriptReload:
    """Watches the module of the session's scenario, where that is a plug-in; other modules of its package stay.

    Args:
        session: The session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._name = _module_of(session.scene.scenario)
        self._file = Path(sys.modules[self._name].__file__ or "") if self._name else None
        self._watcher = SceneWatcher([self._file] if self._file is not None else [])
        self._saved = False

    def check(self, *, between: bool) -> str:
        """Take a saved script; return what is to be said, "" for nothing.

        Args:
            between: Whether no trial is under way; until then a saved script waits.
        """
        self._saved |= self._watcher.changed()
        if not (self._saved and between) or self._file is None:
            return ""
        self._saved = False
        journal = self._session.recorder.journal
        try:
            self._take(self._file)
        except BaseException as error:  # a script may raise anything, or call sys.exit()
            if isinstance(error, KeyboardInterrupt):
                raise
            where = _place_of(error)
            journal("reload", {"taken": False, "script": self._file.name, "issues": [where]})
            return f"the script stays as it was: {where}"
        journal("reload", {"taken": True, "script": self._file.name})
        return f"script reloaded: {self._file.name}"

    def _take(self, file: Path) -> None:
        """Run the file as a module in place of the present one, and make the scenario anew; a fault changes nothing."""
        session, before = self._session, sys.modules[self._name]
        try:
            sys.modules[self._name] = module = _empty_module(self._name, file)
            # Not by its loader: that takes stored code where a save is within a second and of the same size.
            exec(compile(read_regular(file, _MOST_BYTES), str(file), "exec"), vars(module))  # what import does
            # In a separate world, so that its faults leave this one intact.
            open_scenario(session.scene, build_world(session.scene))
            scenario = open_scenario(session.scene, session.world)
        except BaseException:
            sys.modules[self._name] = before
            raise
        session.scenario = scenario
        side = HapticSceneData(session.scene)
        session.parameter_store.replace(*side.parameters(scenario.scene_block()))


def _module_of(scenario: str) -> str:
    """Return the name of the module of a scenario plug-in that is loaded; "" for one that is built in."""
    point = next((each for each in PLUGINS.points() if each.name == scenario), None)
    return point.module if point is not None and point.module in sys.modules else ""


def _empty_module(name: str, file: Path) -> ModuleType:
    spec = spec_from_file_location(name, file)
    assert spec is not None
    return module_from_spec(spec)


def _place_of(error: BaseException) -> str:
    """Return what is wrong and where, in one line."""
    if isinstance(error, SyntaxError):
        return f"{Path(error.filename or '').name}, line {error.lineno}: {error.msg}"
    if isinstance(error, MimicsError):
        return str(error)
    return raised(error) if isinstance(error, Exception) else f"it raised {type(error).__name__}"
