"""Hierarchy of nodes: linked lists of children as arrays by entity index."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.graph.entity_ids import grown
from mimics_app.world.graph.propagation import preorder

__all__ = ["Hierarchy"]

_NONE = -1
_FIRST_CAPACITY = 256
_LINKS = ("_parent", "_first", "_last", "_next", "_previous")
"""Arrays of links, by entity index."""


class Hierarchy:
    """Parent, child and sibling links, independent of the row order of the Transform table."""

    def __init__(self) -> None:
        self._parent = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._first = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._last = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._next = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._previous = np.full(_FIRST_CAPACITY, _NONE, np.int32)

    def reserve(self, capacity: int) -> None:
        """Make room for indices below `capacity`."""
        if capacity <= self._parent.shape[0]:
            return
        for name in _LINKS:
            setattr(self, name, grown(getattr(self, name), capacity, _NONE))

    @property
    def parents(self) -> NDArray[np.int32]:
        """Parent of each entity index, -1: none; int32 [capacity]."""
        return self._parent

    def parent(self, index: int) -> int:
        """Index of the parent, or -1."""
        return int(self._parent[index])

    def children(self, index: int) -> Iterator[int]:
        """Indices of the children, in the order they were attached."""
        child = int(self._first[index])
        while child != _NONE:
            following = int(self._next[child])
            yield child
            child = following

    def is_inside(self, index: int, ancestor: int) -> bool:
        """True when `index` is `ancestor` or one of its descendants."""
        while index not in (_NONE, ancestor):
            index = int(self._parent[index])
        return index == ancestor

    def link(self, child: int, parent: int) -> None:
        """Append a node without parent to the children of `parent`."""
        last = int(self._last[parent])
        self._parent[child] = parent
        self._previous[child] = last
        if last == _NONE:
            self._first[parent] = child
        else:
            self._next[last] = child
        self._last[parent] = child

    def unlink(self, child: int) -> None:
        """Take a node off its parent; it keeps its children."""
        parent, before, after = int(self._parent[child]), int(self._previous[child]), int(self._next[child])
        if parent == _NONE:
            return
        if before == _NONE:
            self._first[parent] = after
        else:
            self._next[before] = after
        if after == _NONE:
            self._last[parent] = before
        else:
            self._previous[after] = before
        self._parent[child] = self._previous[child] = self._next[child] = _NONE

    def subtree(self, index: int, capacity: int) -> NDArray[np.int32]:
        """Return the indices of a subtree, parents first, int32 [n]; n is at most `capacity`."""
        order = np.empty(capacity, np.int32)
        return order[: preorder(index, self._parent, self._first, self._next, order)]

    def forget(self, indices: NDArray[np.int32]) -> None:
        """Clear all links of removed nodes."""
        for name in _LINKS:
            getattr(self, name)[indices] = _NONE
