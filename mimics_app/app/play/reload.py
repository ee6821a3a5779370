"""Live reload: saved files of a scene, and its script, replace the running ones; broken ones change nothing."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

from mimics_app.app.planner.plan import apply_plan
from mimics_app.app.play.script_reload import ScriptReload
from mimics_app.app.scenes.loading import load_checked_scene
from mimics_app.app.scenes.scenario_choice import open_scenario
from mimics_app.app.session.session import Session
from mimics_app.app.terminal.output import issue_lines, say, with_line
from mimics_app.app.touch.device_fit import device_values
from mimics_app.app.touch.haptic_scene_data import HapticSceneData
from mimics_app.contracts.errors import DeviceError, Issue, SceneError
from mimics_app.world.files.scene.file import build_world
from mimics_app.world.files.scene.reload import apply_scene
from mimics_app.world.files.scene.scene import Scene
from mimics_app.world.files.scene.watcher import SceneWatcher

if TYPE_CHECKING:
    from mimics_app.app.picture.picture import Picture

__all__ = ["SceneReload"]

_POLL_NS = 500_000_000
"""Period of the checks of the files [ns]; each check costs a `stat` per file."""
_SHOW_NS = 6_000_000_000
"""Time for which a message is shown [ns]."""
_NEW_TABLES = "models, paths or force fields changed, or there are more objects than there is room for"


class SceneReload:
    """Watches the files of the running scene.

    Attributes:
        message: Message over the picture; "" for none.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._watcher = SceneWatcher(session.scene.files)
        self._script = ScriptReload(session)
        self._next_ns = 0
        self._shown_until_ns = 0
        self.message = ""

    def check(self, *, between: bool) -> None:
        """Reload changed files, twice a second.

        Args:
            between: Whether no trial is under way: a script is not exchanged within one.
        """
        now_ns = self._session.clock.now_ns()
        if now_ns > self._shown_until_ns:
            self.message = ""
        if now_ns < self._next_ns:
            return
        self._next_ns = now_ns + _POLL_NS
        if self._session.picture is not None:
            self._take_shaders(self._session.picture, now_ns)
        if self._watcher.changed():
            self._take(now_ns)
        if said := self._script.check(between=between):
            self._say(now_ns, said)
            say(said)

    def _take_shaders(self, picture: Picture, now_ns: int) -> None:
        """Reload changed shaders; a faulty one keeps its old version, and the line of the fault is reported."""
        issues = picture.renderer.reload_shaders()
        if issues:
            self._say(now_ns, str(issues[0]))
        for issue in issues:
            say(str(issue))

    def _take(self, now_ns: int) -> None:
        session = self._session
        try:
            before = session.scene
            scene = load_checked_scene(before.path, before=before, device=before.device, edit=before.edit)
            open_scenario(scene, build_world(scene))  # in a separate world, so that its faults leave this one intact
            side = HapticSceneData(scene)
            if not side.fits(session.side, session.memory):
                raise SceneError(Issue(scene.file, "", _NEW_TABLES, "end the run and start it again"))
            changes = apply_scene(session.world, session.scene, scene)
        except SceneError as error:
            self._say(now_ns, with_line(error.issues[0]))
            sys.stderr.writelines(issue_lines(error.issues))
            session.recorder.journal("reload", {"taken": False, "issues": [str(issue) for issue in error.issues]})
            return
        scene.read |= session.scene.read
        apply_plan(scene, session.settings.profile)
        session.scene, session.scenario = scene, open_scenario(scene, session.world)
        if session.picture is not None:
            session.picture.show(scene, session.world)
        other_limits = session.parameter_store.replace(*side.parameters(session.scenario.scene_block()))
        self._watcher.watch(scene.files)
        later = changes.sections | changes.systems | ({"limits"} if other_limits else set())
        later |= {"controller"} if _leads_otherwise(session, before, scene) else set()
        self._say(now_ns, "scene reloaded" + (f"; {', '.join(sorted(later))} at the next start" if later else ""))
        session.recorder.journal("reload", {"taken": True, "hash": scene.hash})

    def _say(self, now_ns: int, text: str) -> None:
        self.message, self._shown_until_ns = text, now_ns + _SHOW_NS


def _leads_otherwise(session: Session, before: Scene, scene: Scene) -> bool:
    """Whether a reloaded scene has another controller or other parameters of it: a running loop keeps its own."""
    plugin, block = session.haptics.plugin, session.parameter_store.block
    try:
        one, other = (device_values(plugin, each, block) for each in (before, scene))
    except DeviceError:  # of a controller that this device does not take
        return True
    names = ("controller_names", "controller_parameters")
    return not all(np.array_equal(one.get(name), other.get(name)) for name in names)  # type: ignore[arg-type]
