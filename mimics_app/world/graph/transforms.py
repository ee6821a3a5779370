"""The Transform table: local and world transforms as arrays, rows sorted parent first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.arrays import F8
from mimics_app.world.graph.entity_ids import grown
from mimics_app.world.graph.propagation import are_rows, propagate, store_poses, store_scales

__all__ = ["TransformTable"]

_NONE = -1
_FIRST_CAPACITY = 256
_IDENTITY = np.eye(4)
_BY_ROW = (
    *("_entities", "_parent_rows", "_translations", "_rotations", "_scales"),
    *("_visible", "_dirty", "_world", "_shown", "_changed"),
)
"""Arrays of the table whose first axis is the row."""


class TransformTable:
    """Rows of translation [m], rotation (unit xyzw, w >= 0), scale, and the world matrices made of them.

    A new row is appended, so it comes after its parent; reparenting and removal sort the table again at the frame's
    end (`World.update`). Row numbers are valid until `revision` changes; call `rows` again then. The arrays are views:
    write them through the setters, which mark rows dirty.

    Attributes:
        revision: Changes when rows are reordered.
        updates: Number of updates, by which a reader of `changed` detects that it missed one.
    """

    def __init__(self) -> None:
        self._count = 0
        self._rows = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._entities = np.zeros(_FIRST_CAPACITY, np.int32)
        self._parent_rows = np.full(_FIRST_CAPACITY, _NONE, np.int32)
        self._translations = np.zeros((_FIRST_CAPACITY, 3))
        self._rotations = np.zeros((_FIRST_CAPACITY, 4))
        self._scales = np.zeros((_FIRST_CAPACITY, 3))
        self._visible = np.zeros(_FIRST_CAPACITY, np.uint8)
        self._dirty = np.zeros(_FIRST_CAPACITY, np.uint8)
        self._world = np.zeros((_FIRST_CAPACITY, 4, 4))
        self._shown = np.zeros(_FIRST_CAPACITY, np.uint8)
        self._changed = np.zeros(_FIRST_CAPACITY, np.uint8)
        self._touched = False
        self.revision = 0
        self.updates = 0

    def __len__(self) -> int:
        """Rows in use."""
        return self._count

    @property
    def entities(self) -> NDArray[np.int32]:
        """Entity index of each row, int32 [rows]."""
        return self._entities[: self._count]

    @property
    def parent_rows(self) -> NDArray[np.int32]:
        """Row of each row's parent, below the own row, -1: none; int32 [rows]."""
        return self._parent_rows[: self._count]

    @property
    def translations(self) -> F8:
        """Local translations [m], [rows, 3]; read only by convention."""
        return self._translations[: self._count]

    @property
    def rotations(self) -> F8:
        """Local rotations, unit xyzw, [rows, 4]; read only by convention."""
        return self._rotations[: self._count]

    @property
    def scales(self) -> F8:
        """Local scales, [rows, 3]; read only by convention."""
        return self._scales[: self._count]

    @property
    def visible(self) -> NDArray[np.uint8]:
        """Visibility flag of each row, uint8 [rows]; read only by convention."""
        return self._visible[: self._count]

    @property
    def world(self) -> F8:
        """T_world_from_node as of the last update, float64 [rows, 4, 4]."""
        return self._world[: self._count]

    @property
    def shown(self) -> NDArray[np.uint8]:
        """1 where the node and all its ancestors are visible, as of the last update; uint8 [rows]."""
        return self._shown[: self._count]

    @property
    def changed(self) -> NDArray[np.uint8]:
        """1 where the last update wrote; uint8 [rows]."""
        return self._changed[: self._count]

    @property
    def touched(self) -> bool:
        """True when a row was set since the last update, so that `world` is out of date."""
        return self._touched

    def is_current(self, index: int) -> bool:
        """Whether the world matrix of an entity is up to date: neither it nor an ancestor was set since the update."""
        row = self.row(index)
        while row != _NONE and not self._dirty[row]:
            row = int(self._parent_rows[row])
        return row == _NONE

    def rows(self, indices: NDArray[np.integer]) -> NDArray[np.int32]:
        """Rows of entity indices, for the bulk setters."""
        return self._rows[indices]

    def row(self, index: int) -> int:
        """Row of one entity index."""
        return int(self._rows[index])

    def set_translation(self, index: int, value: Sequence[float] | F8) -> None:
        """Set the local translation of one entity [m], [3].

        Raises:
            ValueError: a number is not finite, or there are not three.
        """
        self._set_one(self._translations, index, _finite("translation", value))

    def set_rotation(self, index: int, value: Sequence[float] | F8) -> None:
        """Set the local rotation of one entity, xyzw of any length, [4].

        Raises:
            ValueError: it is zero or not finite, or there are not four numbers.
        """
        x, y, z, w = map(float, value)
        length = math.hypot(x, y, z, w)
        if not 0.0 < length < math.inf:
            raise ValueError("a rotation needs a finite quaternion other than zero")
        length = length if w >= 0.0 else -length
        self._set_one(self._rotations, index, (x / length, y / length, z / length, w / length))

    def set_scale(self, index: int, value: Sequence[float] | F8) -> None:
        """Set the local scale of one entity, [3].

        Raises:
            ValueError: a number is not finite, or there are not three.
        """
        self._set_one(self._scales, index, _finite("scale", value))

    def set_poses(
        self, rows: NDArray[np.integer], translations: NDArray[np.floating], rotations: NDArray[np.floating]
    ) -> None:
        """Set local translations [m], [n, 3], and rotations, xyzw of any length, [n, 4], in one pass.

        For many nodes every frame: a pose that is set again is no change. Nothing is set when a number is invalid.

        Raises:
            ValueError: a number is not finite, a rotation is zero, or a shape does not fit.
        """
        shifts = np.asarray(translations, np.float64).reshape(-1, 3)
        turns = np.asarray(rotations, np.float64).reshape(-1, 4)
        if not len(rows) == len(shifts) == len(turns):
            raise ValueError(f"{len(rows)} rows, {len(shifts)} translations, {len(turns)} rotations")
        places = np.asarray(rows, np.int32)
        if not are_rows(places, self._count):
            raise ValueError(f"rows beyond the {self._count} in use")
        wrong = store_poses(places, shifts, turns, self._translations, self._rotations, self._dirty)
        if wrong >= 0:
            raise ValueError(f"pose {wrong} of {len(rows)} is not finite, or its rotation is zero")
        self._touched = True

    def set_scales(self, rows: NDArray[np.integer], scales: NDArray[np.floating]) -> None:
        """Set local scales, [n, 3], in one pass; nothing is set when a number is invalid.

        Raises:
            ValueError: a number is not finite, or a shape does not fit.
        """
        values = np.asarray(scales, np.float64).reshape(-1, 3)
        places = np.asarray(rows, np.int32)
        if len(rows) != len(values) or not are_rows(places, self._count):
            raise ValueError(f"{len(values)} scales for {len(rows)} rows of the {self._count} in use")
        if store_scales(places, values, self._scales, self._dirty) >= 0:
            raise ValueError("a scale is not finite")
        self._touched = True

    def set_visible(self, index: int, *, visible: bool) -> None:
        """Set the visibility flag of one node; False hides its subtree too."""
        self._set_one(self._visible, index, visible)

    def translation(self, index: int) -> F8:
        """Local translation of one entity [m], a copy, [3]."""
        return self._translations[self._rows[index]].copy()

    def rotation(self, index: int) -> F8:
        """Local rotation of one entity, a copy, [4]."""
        return self._rotations[self._rows[index]].copy()

    def scale(self, index: int) -> F8:
        """Local scale of one entity, a copy, [3]."""
        return self._scales[self._rows[index]].copy()

    def is_visible(self, index: int) -> bool:
        """Visibility flag of one entity itself."""
        return bool(self._visible[self._rows[index]])

    def append(self, index: int, parent: int) -> None:
        """Add a row for an entity: identity, visible; `parent` is an entity index that has a row, or -1."""
        row = self._count
        self._reserve(row + 1, index + 1)
        self._count = row + 1
        self._rows[index] = row
        self._entities[row] = index
        self._parent_rows[row] = self._rows[parent] if parent != _NONE else _NONE
        self._translations[row] = 0.0
        self._rotations[row] = (0.0, 0.0, 0.0, 1.0)
        self._scales[row] = 1.0
        self._visible[row] = self._dirty[row] = 1
        self._world[row] = _IDENTITY
        self._shown[row] = self._changed[row] = 0
        self._touched = True

    def sort(self, order: NDArray[np.int32], parents: NDArray[np.int32]) -> None:
        """Keep the rows of `order` (entity indices, parents first) in that order and drop all others.

        Args:
            order: Entity indices, [n].
            parents: Parent of each entity index, -1: none; [capacity].
        """
        old = self._rows[order]
        parent_rows = self._parent_rows[old]
        old_parents = np.where(parent_rows == _NONE, _NONE, self._entities[parent_rows])
        self._dirty[old[old_parents != parents[order]]] = 1
        for name in _BY_ROW:
            array = getattr(self, name)
            array[: order.size] = array[old]
        self._rows[:] = _NONE
        self._rows[order] = np.arange(order.size, dtype=np.int32)
        roots = parents[order] == _NONE
        self._parent_rows[: order.size] = np.where(roots, _NONE, self._rows[parents[order]])
        self._count = order.size
        self._touched = True
        self.revision += 1

    def update(self) -> int:
        """Bring `world`, `shown` and `changed` up to date in one pass; returns the rows computed."""
        n = self._count
        self.updates += 1
        if not self._touched:
            self._changed[:n] = 0
            return 0
        self._touched = False
        return propagate(
            self._parent_rows[:n],
            self._translations,
            self._rotations,
            self._scales,
            self._visible,
            self._dirty,
            self._world,
            self._shown,
            self._changed,
        )

    def _set_one(self, array: NDArray[Any], index: int, value: object) -> None:
        """Write one row from plain numbers: building an array would cost more than the write."""
        row = self._rows[index]
        array[row] = value
        self._dirty[row] = 1
        self._touched = True

    def _reserve(self, rows: int, capacity: int) -> None:
        self._rows = grown(self._rows, capacity, _NONE)
        if rows <= self._entities.shape[0]:
            return
        for name in _BY_ROW:
            setattr(self, name, grown(getattr(self, name), rows))


def _finite(what: str, value: Sequence[float] | F8) -> tuple[float, float, float]:
    x, y, z = map(float, value)
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise ValueError(f"the {what} is not finite")
    return x, y, z
