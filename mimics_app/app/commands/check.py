"""`mimics check`: read scene and model files as `run` would, and report every error of all of them."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mimics_app.app.terminal.output import errors_of, issue_lines, one_line, with_line, write_object
from mimics_app.contracts.errors import DeviceError, Issue, MimicsError, SceneError, counted

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["add_arguments", "examine", "run"]

_MODELS = (".glb", ".gltf", ".vrm")
_NO_DEVICES = ("scripted", "pointer", "tape")
"""Kinds of trackers that nobody switches on."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="scene (.json), model (.glb, .gltf, .vrm)")


def run(args: argparse.Namespace) -> int:
    """Check the files; 0 when all are right, 3 when one is not, 4 when only a device is; one line for each error."""
    findings: list[dict[str, Any]] = []
    issues: list[Issue] = []
    code = 0
    if len(args.files) > 1:
        from mimics_app.world.files.scene.model_shelf import MODELS

        MODELS.keep()
    for file in args.files:
        try:
            findings.append(examine(file))
        except MimicsError as error:
            findings.append({"file": str(file), "ok": False})
            code = error.exit_code if code in (0, DeviceError.exit_code) else code
            issues += [issue if issue.file else Issue(str(file), "", issue.what, issue.fix) for issue in error.issues]
    if args.json:
        write_object("check", {"files": findings, **errors_of(issues)})
        return code
    for finding in findings:
        sys.stdout.writelines(f"{one_line(line)}\n" for line in _lines(finding))
    sys.stderr.writelines(issue_lines(issues))
    return code


def examine(file: Path) -> dict[str, Any]:
    """Return the contents of a file in numbers, if `mimics run` or `mimics view` accept it.

    Raises:
        MimicsError: The file is faulty; the error carries every issue.
    """
    if file.suffix.lower() in _MODELS:
        from mimics_app.world.files.gltf.file import load_gltf

        model = load_gltf(file)
        holds = {"nodes": len(model.nodes), "meshes": len(model.meshes), "materials": len(model.materials)}
        return {"file": str(file), "ok": True, "kind": "model", "holds": holds, "notes": model.notes}
    from mimics_app.app.scenes.scene_search import find_scene

    find_scene(file)
    from mimics_app.app.scenes.loading import load_checked_scene

    scene = load_checked_scene(file)
    _check_devices(scene)
    for device in scene.devices:  # with the entities that it has for others
        _check_devices(load_checked_scene(file, device=device))
    from mimics_app.app.scenes.hints import hints

    notes = [*scene.notes, *_notes_on_play(scene), *_notes_on_limits(scene), *map(with_line, hints(scene))]
    holds = {"entities": len(scene.entities), "materials": len(scene.materials), "assets": len(scene.assets)}
    found = {"file": str(file), "ok": True, "kind": "scene", "hash": scene.hash, "holds": holds, "notes": notes}
    return found | {"trackers": _trackers(scene)}


def _trackers(scene: Scene) -> list[str]:
    """Return the names of the devices that track the person; a simulated person is not one."""
    from mimics_app.world.components.trackers import TrackersSettings

    settings = scene.system(TrackersSettings) or TrackersSettings()
    return [each.name for each in settings.devices if each.kind not in _NO_DEVICES]


def _notes_on_play(scene: Scene) -> list[str]:
    """Return notes on a scene that `mimics run` would not play.

    Raises:
        SceneError: The scenario it names does not exist, or misses a part of the scene.
    """
    from mimics_app.app.scenes.scenario_choice import is_part, open_scenario
    from mimics_app.app.scenes.shipped import ONLY_LOOKED_AT
    from mimics_app.world.components.robot import Robot
    from mimics_app.world.files.scene.file import build_world

    if scene.scenario == ONLY_LOOKED_AT:
        return ["a scene to look at only: mimics view opens it"]
    if is_part(scene):
        return ["a part, without robot and task: include it in a scene"]
    try:
        open_scenario(scene, build_world(scene))
    except SceneError as error:
        if scene.has(Robot) or scene.scenario != scene.name:
            raise
        first = error.issues[0]
        if not scene.task:
            return ["a part, or a scene to look at with mimics view: mimics run needs a robot"]
        return [f"mimics run refuses it: {first.what}; {first.fix}"]
    return []


def _notes_on_limits(scene: Scene) -> list[str]:
    """Return a note on each limit that the scene sets beyond its usual value."""
    from mimics_app.app.touch.ceiling import hold_limits
    from mimics_app.app.touch.ceilings import read_ceiling
    from mimics_app.scenarios.parts.robot_scene import robot_block
    from mimics_app.world.components.robot import Robot

    if not scene.components(Robot):
        return []
    return list(hold_limits(robot_block(scene), read_ceiling()).notes)


def _check_devices(scene: Scene) -> None:
    """Raise a DeviceError where the device of a robot does not exist."""
    from mimics_app.rendering.haptic.devices.device_names import check_device_name
    from mimics_app.world.components.robot import Robot

    for _, robot, pointer in scene.components(Robot):
        try:
            check_device_name(robot.device)
        except DeviceError as error:
            issue = scene.issue(f"{pointer}/device", error.what, error.fix)
            raise DeviceError(issue.what, issue.fix, issue.file, issue.pointer) from error


def _lines(finding: dict[str, Any]) -> list[str]:
    if not finding["ok"]:
        return []
    holds = ", ".join(counted(number, what) for what, number in finding["holds"].items())
    return [f"{finding['file']}: ok ({holds})", *(f"  {note}" for note in finding["notes"])]
