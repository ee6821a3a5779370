"""Edits of a scene by a program, before it is played: they become part of its document and its hash."""

from __future__ import annotations

from typing import TypeVar

import msgspec
import numpy as np

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.files.scene.file import scene_hash
from mimics_app.world.files.scene.scene import Scene, SceneEntity

__all__ = ["SceneEdits"]

S = TypeVar("S", bound=msgspec.Struct)


class SceneEdits:
    """Finds what was changed in the components of a scene, and in its sections, as the task.

    Args:
        scene: The scene as it was read.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._before = {entity.id: dict(entity.components) for entity in scene.entities}
        self._sections = dict(scene.sections)

    def apply(self) -> None:
        """Make the edits part of the document and the hash.

        Raises:
            SceneError: A component or section has a value that its type does not take; every fault with its pointer.
        """
        changed = [(entity, name) for entity in self._scene.entities for name in self._changed(entity)]
        sections = [name for name, part in self._scene.sections.items() if part is not self._sections.get(name)]
        issues = [issue for entity, name in changed for issue in self._fault(entity, name)]
        issues += [issue for name in sections for issue in self._section_fault(name)]
        if issues:
            raise SceneError(issues)
        if changed or sections:
            self._scene.discard_derived()
            self._scene.hash = scene_hash(self._scene)

    def _changed(self, entity: SceneEntity) -> list[str]:
        before = self._before.get(entity.id, {})
        names = dict.fromkeys([*before, *entity.components])
        return [name for name in names if entity.components.get(name) is not before.get(name)]

    def _fault(self, entity: SceneEntity, name: str) -> list[Issue]:
        """Write a component into the document; return its fault, if it has one."""
        number = int(entity.pointer.split("/", 3)[2])
        written = self._scene.document["entities"][number].setdefault("components", {})
        component = entity.components.get(name)
        if component is None:
            written.pop(name, None)
            return []
        made = self._checked(component, f"{entity.pointer}/components/{name}")
        if isinstance(made, Issue):
            return [made]
        entity.components[name], written[name] = made, msgspec.to_builtins(made)
        return []

    def _section_fault(self, name: str) -> list[Issue]:
        """Write a section into the document; return its fault, if it has one."""
        scene = self._scene
        made = self._checked(scene.sections[name], f"/{name}")
        if isinstance(made, Issue):
            return [made]
        scene.sections[name], scene.document[name] = made, msgspec.to_builtins(made)
        if name == "task":
            scene.task = scene.document[name]
        return []

    def _checked(self, part: S, pointer: str) -> S | Issue:
        """Return a part with each value as its type has it, or its fault."""
        try:
            return msgspec.convert(msgspec.to_builtins(part, enc_hook=_as_file), type(part))
        except (msgspec.ValidationError, TypeError) as error:
            return Issue(self._scene.file, pointer, str(error).replace("`", '"'))


def _as_file(value: object) -> object:
    """Return a number or an array of NumPy as a scene file has it.

    Raises:
        TypeError: No file has such a value.
    """
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"a scene file has no {type(value).__name__}")
