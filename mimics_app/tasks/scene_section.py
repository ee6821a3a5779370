"""Registration of the `task` block as a section of scene files, on import, with its checks."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from msgspec.structs import replace

from mimics_app.contracts.errors import Issue, SceneError, nearest
from mimics_app.tasks.cards import CARDS
from mimics_app.tasks.check import check_task, object_of_target
from mimics_app.tasks.kinds.registry import task_kinds
from mimics_app.tasks.kinds.tunnel.kind import has_tunnel
from mimics_app.tasks.task import DeviceTask, DurationGoal, SoundDeed, TaskSpec
from mimics_app.tasks.trial_file import resolve_trials
from mimics_app.world.components.registry import Component, register_check, register_section
from mimics_app.world.components.robot import Tunnel
from mimics_app.world.components.visible import Hud, Sound
from mimics_app.world.files.reading.json_text import escape

if TYPE_CHECKING:
    from mimics_app.world.files.scene.scene import Scene

__all__ = ["check_section", "section_of", "task_of"]

S = TypeVar("S", bound=Component)

_WITHOUT_A_TASK = TaskSpec(goals=[DurationGoal(seconds=60.0)], time_limit_s=120.0)
"""Task of a scene without a task and without a tunnel: one minute of free movement."""


def task_of(scene: Scene) -> TaskSpec:
    """Return the task of a scene with its device; by default to travel its tunnel, else one minute of free movement."""
    task = scene.section(TaskSpec) or (TaskSpec() if scene.components(Tunnel) else _WITHOUT_A_TASK)
    other = task.devices.get(scene.device, DeviceTask())
    instructions, score = other.instructions or task.instructions, other.score or task.score
    parameters = {**task.parameters, **other.parameters}
    return replace(task, devices={}, instructions=instructions, score=score, parameters=parameters)


def section_of(scene: Scene, section: type[S]) -> S:
    """Return the section of a kind of task in a scene's task.

    Raises:
        SceneError: It has none.
    """
    found = task_of(scene).find(section)
    if found is None:
        name = next(kind.name for kind in task_kinds() if kind.section is section)
        raise SceneError(scene.issue("/task", f"the scenario needs {name} in the task", f'write "{name}": {{...}}'))
    return found


def check_section(spec: TaskSpec, scene: Scene) -> list[Issue]:
    """Return the faults of a scene's task: its own, those of its trial file, and missing sounds or objects."""
    issues = [scene.issue(issue.pointer, issue.what, issue.fix) for issue in check_task(spec)]
    kinds = [issue for kind in task_kinds() for issue in kind.check_scene(spec, scene)]
    named = [*_check_sounds(spec, scene), *_check_names(spec, scene), *_check_fitting(spec, scene)]
    devices = {f"/task/devices/{escape(name)}": name for name in spec.devices}
    unknown = scene.check_names(devices, "the section devices has no", scene.devices)
    return [*issues, *kinds, *named, *unknown, *_check_trial_file(spec, scene)]


def _check_sounds(spec: TaskSpec, scene: Scene) -> list[Issue]:
    known = {entity for entity, _, _ in scene.components(Sound)}
    named = {
        f"/task/triggers/{i}/do/{j}/sound": deed.sound
        for i, trigger in enumerate(spec.triggers)
        for j, deed in enumerate(trigger.do)
        if isinstance(deed, SoundDeed)
    }
    return scene.check_names(named, "no sound is called", known, 'give an entity a "sound" component')


def _check_fitting(spec: TaskSpec, scene: Scene) -> list[Issue]:
    """Check that what is scaled exists and has a place of its own."""
    named = {
        f"/task/fitting/entities/{i}": name for i, name in enumerate(spec.fitting.entities if spec.fitting else ())
    }
    moved = [place for place, name in named.items() if name in scene.by_id and scene.by_id[name].parent is not None]
    held = [scene.issue(place, "it moves with its parent", "name the parent instead") for place in moved]
    return [*scene.check_names(named, "no entity", scene.by_id), *held]


def _check_names(spec: TaskSpec, scene: Scene) -> list[Issue]:
    """Check that the objects and tunnels whose parameters the task changes exist."""
    everything = {entity.id for entity in scene.entities}
    tunnels = {entity.id for entity in scene.entities if "tunnel" in entity.components}
    issues = []
    for pointer, parameter in spec.placed_parameters():
        for i, target in enumerate(parameter.maps):
            group, _, field = target.to.partition(".")
            place, who = f"{pointer}/maps/{i}/to", object_of_target(field)
            known, kind = (tunnels, "tunnel") if field.startswith("tunnels.") else (everything, "entity")
            if field.startswith("curves."):
                continue  # names a joint of the device
            if group == "haptic" and who is not None and who not in known:
                issues.append(scene.issue(place, f'no {kind} is called "{who}"', nearest(who, known)))
            elif group == "haptic" and field.startswith("tunnel.") and not has_tunnel(scene):
                issues.append(scene.issue(place, "the scene has no tunnel", "give an entity one, or leave this out"))
    return issues


def _check_trial_file(spec: TaskSpec, scene: Scene) -> list[Issue]:
    try:
        resolve_trials(spec, scene.path.parent, scene.root)
    except SceneError as error:
        return [
            issue if issue.file != spec.trials else scene.issue("/task/trials", issue.what, issue.fix)
            for issue in error.issues
        ]
    return []


def _check_board(hud: Hud, pointer: str, scene: Scene) -> list[Issue]:
    """Check that the cards that a scene shows exist."""
    known = [*CARDS, *(card for kind in task_kinds() for card in kind.cards)]
    return [
        scene.issue(f"{pointer}/show/{i}", f'"{name}" is not possible here', nearest(name, known))
        for i, name in enumerate(hud.show)
        if name not in known
    ]


register_section("task", TaskSpec, check_section)
register_check("hud", _check_board)
