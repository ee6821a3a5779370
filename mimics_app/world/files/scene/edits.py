"""Edits of a scene by a program, before it is played: they become part of its document and its hash."""

from __future__ import annotations

import msgspec

from mimics_app.contracts.errors import Issue, SceneError
from mimics_app.world.files.scene.file import scene_hash
from mimics_app.world.files.scene.scene import Scene, SceneEntity

__all__ = ["SceneEdits"]


class SceneEdits:
    """Finds what was changed in the components of a scene.

    Args:
        scene: The scene as it was read.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._before = {entity.id: dict(entity.components) for entity in scene.entities}

    def apply(self) -> None:
        """Make the edits part of the document and the hash.

        Raises:
            SceneError: A component has a value that its type does not take; every fault with its pointer.
        """
        changed = [(entity, name) for entity in self._scene.entities for name in self._changed(entity)]
        issues = [issue for entity, name in changed for issue in self._fault(entity, name)]
        if issues:
            raise SceneError(issues)
        if changed:
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
        plain = msgspec.to_builtins(component)
        try:
            msgspec.convert(plain, type(component))
        except msgspec.ValidationError as error:
            return [Issue(self._scene.file, f"{entity.pointer}/components/{name}", str(error).replace("`", '"'))]
        written[name] = plain
        return []
