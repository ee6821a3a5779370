"""Identity of entities: an index that is reused, and a generation that counts its uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["EntityId", "EntityStore", "StaleHandleError", "grown"]

_FIRST_CAPACITY = 256


@dataclass(frozen=True, slots=True)
class EntityId:
    """Identity of an entity: `index` is its key in every table (int32), `generation` counts the uses of that index."""

    index: int
    generation: int


class StaleHandleError(ReferenceError):
    """A handle of an entity that was removed; its index may belong to another entity by now."""


class EntityStore:
    """Allocator of entity indices, last freed first."""

    def __init__(self) -> None:
        self._generation = np.zeros(_FIRST_CAPACITY, np.int32)
        self._alive = np.zeros(_FIRST_CAPACITY, np.uint8)
        self._free: list[int] = []
        self._used = 0

    def __len__(self) -> int:
        """Entities alive."""
        return self._used - len(self._free)

    @property
    def capacity(self) -> int:
        """Highest index ever used, plus one."""
        return self._used

    def create(self) -> EntityId:
        """Allocate an entity."""
        if self._free:
            index = self._free.pop()
        else:
            index = self._used
            self._used += 1
            self._generation = grown(self._generation, self._used)
            self._alive = grown(self._alive, self._used)
        self._alive[index] = 1
        return EntityId(index, int(self._generation[index]))

    def destroy(self, index: int) -> None:
        """Free an index; every handle of it is stale from now on."""
        self._alive[index] = 0
        self._generation[index] += 1
        self._free.append(index)

    def id_of(self, index: int) -> EntityId:
        """Return the identity that this index has now."""
        return EntityId(index, int(self._generation[index]))

    def is_alive(self, entity: EntityId) -> bool:
        """True while the entity has not been removed."""
        return bool(self._alive[entity.index]) and int(self._generation[entity.index]) == entity.generation

    def index_of(self, entity: EntityId) -> int:
        """Return the index of an entity that is alive.

        Raises:
            StaleHandleError: it was removed.
        """
        if not self.is_alive(entity):
            raise StaleHandleError(f"entity {entity.index} (generation {entity.generation}) was removed")
        return entity.index


def grown(array: NDArray[Any], size: int, fill: int = 0) -> NDArray[Any]:
    """The array itself when its first axis holds `size`, else a copy of at least double length, filled with `fill`."""
    if array.shape[0] >= size:
        return array
    larger = np.full((max(size, 2 * array.shape[0]), *array.shape[1:]), fill, array.dtype)
    larger[: array.shape[0]] = array
    return larger
