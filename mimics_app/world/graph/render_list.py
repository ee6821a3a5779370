"""Render list: one row per SubEntity, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mimics_app.world.graph.entity_ids import grown

__all__ = ["RenderList", "SubEntityTable"]


@dataclass(frozen=True, eq=False)
class RenderList:
    """SubEntities of the world as of the last update. Each `World.update` rewrites `visible`.

    Attributes:
        row: Row of its node in `World.transforms.world`, int32 [n].
        mesh: Key in `World.meshes`, per SubEntity.
        material: Key in `World.materials`, per SubEntity.
        visible: 1 where it and its node are shown, uint8 [n].
        casts_shadow: 1 where it is drawn into shadow maps, uint8 [n].
        level: Level of detail, 0 the finest; uint8 [n].
        entity: Entity index of the node, int32 [n].
        revision: Changes when the list or a material or mesh name in it does; key of caches.
    """

    row: NDArray[np.int32]
    mesh: list[str]
    material: list[str]
    visible: NDArray[np.uint8]
    casts_shadow: NDArray[np.uint8]
    level: NDArray[np.uint8]
    entity: NDArray[np.int32]
    revision: int


@dataclass(eq=False)
class SubEntityTable:
    """One row per SubEntity; rows of one Entity are contiguous. `compact` closes the holes of removed ones."""

    mesh: list[str] = field(default_factory=list)
    material: list[str] = field(default_factory=list)
    owner: NDArray[np.int32] = field(default_factory=lambda: np.zeros(64, np.int32))
    visible: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(64, np.uint8))
    casts_shadow: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(64, np.uint8))
    level: NDArray[np.uint8] = field(default_factory=lambda: np.zeros(64, np.uint8))

    def __len__(self) -> int:
        """Rows in use, holes included."""
        return len(self.mesh)

    def append(self, owner: int, mesh: str, material: str, level: int = 0) -> int:
        """Append a visible, shadow-casting row of an entity index in a level of detail; return its number."""
        row = len(self.mesh)
        self.mesh.append(mesh)
        self.material.append(material)
        self.owner = grown(self.owner, row + 1)
        self.visible = grown(self.visible, row + 1)
        self.casts_shadow = grown(self.casts_shadow, row + 1)
        self.level = grown(self.level, row + 1)
        self.owner[row] = owner
        self.level[row] = level
        self.visible[row] = self.casts_shadow[row] = 1
        return row

    def compact(self) -> NDArray[np.int64]:
        """Close the holes (owner -1) and return the old numbers of the rows kept, in order, int64 [n]."""
        kept = np.flatnonzero(self.owner[: len(self.mesh)] >= 0)
        self.mesh = [self.mesh[row] for row in kept]
        self.material = [self.material[row] for row in kept]
        for array in (self.owner, self.visible, self.casts_shadow, self.level):
            array[: kept.size] = array[kept]
        return kept
