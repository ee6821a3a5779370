"""Handle: base of the thin references to one entity of a world."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, Protocol, Self, TypeVar, overload

from mimics_app.world.graph.entity_ids import EntityId
from mimics_app.world.graph.node_tables import Content
from mimics_app.world.graph.scene_graph import SceneGraph

__all__ = ["Column", "Handle", "NodeWorld", "WritableColumn"]

T = TypeVar("T")


class NodeWorld(Protocol):
    """What handles ask of the world they belong to.

    Attributes:
        graph: Structure, names and transforms.
        content: Tables of what nodes carry.
    """

    graph: SceneGraph
    content: Content

    def node(self, index: int) -> Handle:
        """Return a handle on the node that has this entity index now."""
        ...

    def require_mesh(self, name: str) -> None:
        """Raise a KeyError that names the nearest when the world has no such mesh."""
        ...

    def require_material(self, name: str) -> None:
        """Raise a KeyError that names the nearest when the world has no such material."""
        ...


class Handle:
    """A thin reference to one entity. Two handles of the same entity are equal; a removed one raises when used."""

    __slots__ = ("id", "world")

    def __init__(self, world: NodeWorld, entity: EntityId) -> None:
        self.world = world
        self.id = entity

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Handle) or type(other) is not type(self):
            return False
        return other.world is self.world and other.id == self.id

    def __hash__(self) -> int:
        return hash((type(self), self.id))

    def __repr__(self) -> str:
        name = repr(self.world.graph.name(self.id.index)) if self.is_alive else "removed"
        return f"<{type(self).__name__} {name}>"

    @property
    def is_alive(self) -> bool:
        """True until the entity is removed (at the end of the frame in which `remove` was called)."""
        return self.world.graph.store.is_alive(self.id)

    @property
    def index(self) -> int:
        """Entity index, the key of every table.

        Raises:
            StaleHandleError: the entity was removed.
        """
        return self.world.graph.store.index_of(self.id)


class Column(Generic[T]):
    """A read-only attribute of a handle that is a column of a component table, of the same name.

    Args:
        table: Name of the table in `World.content`.
        read: Conversion of a value of the column.
    """

    def __init__(self, table: str, read: Callable[[Any], T]) -> None:
        self._table, self._read, self._name = table, read, ""

    def __set_name__(self, owner: type[Handle], name: str) -> None:
        self._name = name

    @overload
    def __get__(self, handle: None, owner: type[Handle]) -> Self: ...
    @overload
    def __get__(self, handle: Handle, owner: type[Handle]) -> T: ...
    def __get__(self, handle: Handle | None, owner: type[Handle]) -> T | Self:
        if handle is None:
            return self
        table = getattr(handle.world.content, self._table)
        return self._read(table.column(self._name)[table.row(handle.index)])


class WritableColumn(Column[T]):
    """A column that may be changed while the scene runs."""

    def __set__(self, handle: Handle, value: T) -> None:
        getattr(handle.world.content, self._table).set(handle.index, self._name, value)
