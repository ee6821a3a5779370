"""SceneGraph: names, hierarchy and transforms of nodes, without their components."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import require_key
from mimics_app.maths import mat
from mimics_app.world.graph.entity_ids import EntityId, EntityStore
from mimics_app.world.graph.hierarchy import Hierarchy
from mimics_app.world.graph.transforms import TransformTable

__all__ = ["SceneGraph"]

_NONE = -1


class SceneGraph:
    """Nodes by entity index. `apply_edits` carries out structural edits at the frame's end.

    Attributes:
        store: Which entities are alive.
        hierarchy: Parent and child links, always up to date.
        transforms: Rows, parents first; in step with the hierarchy after `apply_edits`.
        root: Index of the root node.
    """

    def __init__(self) -> None:
        self.store = EntityStore()
        self.hierarchy = Hierarchy()
        self.transforms = TransformTable()
        self._names: dict[int, str] = {}
        self._by_name: dict[str, int] = {}
        self._unsorted = False
        self._removals: list[EntityId] = []
        self.root = self.create("", _NONE)
        # Invisible parent of detached nodes, so that every node keeps a row and every handle works.
        self._limbo = self.create("", self.root)
        self.transforms.set_visible(self._limbo, visible=False)

    def create(self, name: str, parent: int) -> int:
        """Create a node below `parent` and return its index; it can be moved at once.

        Raises:
            TypeError: the name is not a text.
            ValueError: another node has that name.
        """
        if not isinstance(name, str):
            raise TypeError(f"the name of a node is a text, not {name!r}")
        if name in self._by_name:
            raise ValueError(f'a node named "{name}" is in the world already')
        index = self.store.create().index
        self.hierarchy.reserve(self.store.capacity)
        if parent != _NONE:
            self.hierarchy.link(index, parent)
        self.transforms.append(index, parent)
        if name:
            self._names[index] = name
            self._by_name[name] = index
        return index

    def find(self, name: str) -> int:
        """Return the index of a node by name.

        Raises:
            KeyError: there is none; the message names the nearest.
        """
        require_key(name, self._by_name, "node")
        return self._by_name[name]

    def __contains__(self, name: str) -> bool:
        """True when a node has that name."""
        return name in self._by_name

    def name(self, index: int) -> str:
        """Name of a node, or ""."""
        return self._names.get(index, "")

    def parent(self, index: int) -> int:
        """Index of the parent; -1 for the root and for detached nodes."""
        parent = self.hierarchy.parent(index)
        return _NONE if parent == self._limbo else parent

    def is_detached(self, index: int) -> bool:
        """True when the node or one of its ancestors is detached."""
        return self.hierarchy.is_inside(index, self._limbo)

    def reparent(self, child: int, parent: int) -> None:
        """Move a node, with its subtree, to another parent; local transforms stay.

        Raises:
            ValueError: it is the root, or `parent` is the child itself or a descendant of it.
        """
        self._refuse_root(child)
        if self.hierarchy.is_inside(parent, child):
            raise ValueError(f'node "{self.name(child)}" cannot be moved below itself')
        self.hierarchy.unlink(child)
        self.hierarchy.link(child, parent)
        self._unsorted = True

    def detach(self, index: int) -> None:
        """Take a node off its parent; it and its subtree stay, invisible.

        Raises:
            ValueError: it is the root.
        """
        self.reparent(index, self._limbo)

    def queue_removal(self, index: int) -> None:
        """Remove a node and its subtree at the frame's end.

        Raises:
            ValueError: it is the root.
        """
        self._refuse_root(index)
        self._removals.append(self.store.id_of(index))

    def apply_edits(self) -> NDArray[np.int32]:
        """Carry out removals and sort the rows, parents first; return the indices removed, int32 [n]."""
        gone = self._remove_queued()
        if self._unsorted:
            order = self.hierarchy.subtree(self.root, self.store.capacity)
            self.transforms.sort(order, self.hierarchy.parents)
            self._unsorted = False
        return gone

    def world_matrix(self, index: int) -> NDArray[np.float64]:
        """T_world_from_node with everything set since the last update, a copy [4, 4]."""
        transforms = self.transforms
        if not self._unsorted and (not transforms.touched or transforms.is_current(index)):
            matrix: NDArray[np.float64] = transforms.world[transforms.row(index)].copy()
            return matrix
        product = self._local(index)
        while (index := self.hierarchy.parent(index)) != _NONE:
            product = self._local(index) @ product
        return product

    def _local(self, index: int) -> NDArray[np.float64]:
        transforms, local = self.transforms, np.empty((4, 4))
        mat.compose_trs(transforms.translation(index), transforms.rotation(index), transforms.scale(index), local)
        return local

    def _remove_queued(self) -> NDArray[np.int32]:
        parts = []
        for entity in self._removals:
            if not self.store.is_alive(entity):
                continue  # removed with an ancestor
            gone = self.hierarchy.subtree(entity.index, self.store.capacity)
            self.hierarchy.unlink(entity.index)
            for index in gone.tolist():
                self.store.destroy(index)
                self._by_name.pop(self._names.pop(index, ""), None)
            self.hierarchy.forget(gone)
            parts.append(gone)
            self._unsorted = True
        self._removals.clear()
        return np.concatenate(parts) if parts else np.empty(0, np.int32)

    def _refuse_root(self, index: int) -> None:
        if index in (self.root, self._limbo):
            raise ValueError("the root node cannot be moved to another node, detached or removed")
