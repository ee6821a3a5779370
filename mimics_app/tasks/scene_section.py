"""Makes the `task` block part of every scene file: imported once by whoever loads scenes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mimics_app.contracts.errors import Issue, nearest
from mimics_app.tasks.check import check_task
from mimics_app.tasks.task import SoundDeed, TaskSpec
from mimics_app.world.components import Sound
from mimics_app.world.registry import register_section

if TYPE_CHECKING:
    from mimics_app.world.scene import Scene

__all__ = ["check_section"]


def check_section(spec: TaskSpec, scene: Scene) -> list[Issue]:
    """Faults of a scene's task, those against the rest of the scene included."""
    issues = [scene.issue(issue.pointer, issue.what, issue.fix) for issue in check_task(spec)]
    sounds = {entity for entity, _, _ in scene.components(Sound)}
    for i, trigger in enumerate(spec.triggers):
        for j, deed in enumerate(trigger.do):
            if isinstance(deed, SoundDeed) and deed.sound not in sounds:
                hint = nearest(deed.sound, sounds) if sounds else 'the scene has no entity with a "sound"'
                issues.append(
                    scene.issue(f"/task/triggers/{i}/do/{j}/sound", f'no sound is called "{deed.sound}"', hint)
                )
    return issues


register_section("task", TaskSpec, check_section)
