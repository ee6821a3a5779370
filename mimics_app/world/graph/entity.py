"""Entity and SubEntity: a visible body on a scene node.

The word has two uses. In the tables (`store.py`) an *entity* is an identity: an index with a
generation, to which components belong. In OGRE's vocabulary, which the handles use, an *Entity* is a mesh on a
node. One identity has one Transform row (seen as `SceneNode`) and at most one component of each type; the component
"parts drawn here" is accessed by an `Entity` handle, as `Light` and `Camera` access theirs. So `node.id == entity.id`:
the node and its component are two views of one identity. For two Entities in one place make two child nodes.
"""

from __future__ import annotations

from mimics_app.world.graph.node import NodeComponent

__all__ = ["Entity", "SubEntity"]


class SubEntity:
    """One primitive of an Entity: one mesh with one material."""

    __slots__ = ("_number", "entity")

    def __init__(self, entity: Entity, number: int) -> None:
        self.entity = entity
        self._number = number

    @property
    def _row(self) -> int:
        return self.entity.first_row + self._number

    @property
    def mesh(self) -> str:
        """Key in `World.meshes`."""
        return self.entity.world.content.parts.mesh[self._row]

    @mesh.setter
    def mesh(self, name: str) -> None:
        self.entity.world.require_mesh(name)
        self.entity.world.content.parts.mesh[self._row] = name
        self.entity.world.content.touch()

    @property
    def material(self) -> str:
        """Key in `World.materials`."""
        return self.entity.world.content.parts.material[self._row]

    @material.setter
    def material(self, name: str) -> None:
        self.entity.world.require_material(name)
        self.entity.world.content.parts.material[self._row] = name
        self.entity.world.content.touch()

    @property
    def visible(self) -> bool:
        """True when it is drawn while its node is shown."""
        return bool(self.entity.world.content.parts.visible[self._row])

    @visible.setter
    def visible(self, visible: bool) -> None:
        self.entity.world.content.parts.visible[self._row] = visible

    @property
    def casts_shadow(self) -> bool:
        """True when it is drawn into shadow maps."""
        return bool(self.entity.world.content.parts.casts_shadow[self._row])

    @casts_shadow.setter
    def casts_shadow(self, casts_shadow: bool) -> None:
        self.entity.world.content.parts.casts_shadow[self._row] = casts_shadow
        self.entity.world.content.touch()


class Entity(NodeComponent):
    """A visible body: SubEntities that move with one node."""

    __slots__ = ()

    @property
    def first_row(self) -> int:
        """First of its rows in `World.content.parts`."""
        table = self.world.content.bodies
        return int(table.column("first")[table.row(self.index)])

    @property
    def subentities(self) -> list[SubEntity]:
        """SubEntities in order."""
        table = self.world.content.bodies
        return [SubEntity(self, number) for number in range(int(table.column("count")[table.row(self.index)]))]

    @property
    def visible(self) -> bool:
        """True when at least one part is visible; setting it sets all."""
        return any(part.visible for part in self.subentities)

    @visible.setter
    def visible(self, visible: bool) -> None:
        for part in self.subentities:
            part.visible = visible

    def set_material(self, name: str) -> None:
        """Give every part this material.

        Raises:
            KeyError: the world has no such material; the message names the nearest.
        """
        for part in self.subentities:
            part.material = name
