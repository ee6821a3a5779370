"""The haptic parameters as the frame changes them: dotted names in, whole parameter blocks out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.haptic import LIMIT_NAMES, SCENE
from mimics_app.contracts.object_rows import Rows

__all__ = ["ParameterStore"]

_PREFIX = "haptic."

_DERIVED = frozenset(Rows._fields) - {"tunnels"}
"""Tables from which the loop caches results until their revision changes."""

Receiver = Callable[[NDArray[Any], Rows | None], object]


class ParameterStore:
    """Keeps the current parameters and hands a numbered block on whenever a value in it changes.

    A dotted name is a field of SCENE ("virtual_mass"), of the task's own tunnel ("tunnel.stiffness"), or of a row of a
    table by its entity ("bodies.apple.mass", "shapes.table.stiffness", "tunnels.left.radius_scale"). Limits are those
    of the first block, `fit` to the device: what changes names none of them, and whole new parameters keep them.

    Args:
        block: The first SCENE record, shape [1]; the store's own from now on.
        rows: The tables of objects it counts; None where it counts none.
        names: Per table, the row of each name; several rows may share one.
    """

    def __init__(
        self,
        block: NDArray[Any],
        rows: Rows | None = None,
        names: Mapping[str, Mapping[str, tuple[int, ...]]] | None = None,
    ) -> None:
        self._block = block
        self._rows = rows
        self._names = names or {}
        self._receivers: tuple[Receiver, ...] = ()
        self._fitted: dict[str, object] = {}
        self._ordered: dict[str, object] = {}

    @property
    def block(self) -> NDArray[Any]:
        """The current record, shape [1]; read only."""
        return self._block

    def fit(self, values: Mapping[str, object]) -> None:
        """Set the values that the device decides, limits included, before the first block is published.

        Raises:
            UsageError: A name that is no field of the haptic scene, or a block was handed on already.
        """
        if self._receivers:
            raise UsageError("the device is fitted once, at the start", "call fit before hand_to")
        changed = [self._set(name, value) for name, value in values.items()]
        self._fitted.update(values)
        if any(changed):
            self._publish()

    def hand_to(self, *receivers: Receiver) -> None:
        """Send the current block and all later ones to the recorder and the loop."""
        self._receivers = receivers
        self._publish()

    def _publish(self) -> None:
        """Number the record and hand it, with its rows, to everybody."""
        self._block["sequence"] += 1
        for receive in self._receivers:
            receive(self._block, self._rows)

    def replace(
        self,
        block: NDArray[Any],
        rows: Rows | None = None,
        names: Mapping[str, Mapping[str, tuple[int, ...]]] | None = None,
    ) -> bool:
        """Take whole new parameters (a reloaded scene); what was ordered so far still holds where it still exists.

        Returns:
            Whether the new parameters bring other limits; those of the start hold on.
        """
        block["sequence"] = self._block["sequence"]
        kept = {name: self._block[0][name].copy() for name in LIMIT_NAMES}
        self._block, self._rows, self._names = block, rows, names or {}
        for name, value in {**self._fitted, **self._ordered}.items():
            self._set(name, value)
        others = [self._set(name, value) for name, value in kept.items()]
        self._publish()
        return any(others)

    def change(self, values: Mapping[str, object]) -> bool:
        """Set fields by dotted name, e.g. {"tunnel.stiffness": 1500.0}; publish once if anything differs.

        Returns:
            Whether a value changed.

        Raises:
            UsageError: A name that is no field of the haptic scene, or one of a limit.
        """
        for name in values:
            self._refuse_limit(name)
        changed = [self._set(name, value) for name, value in values.items()]
        self._ordered.update(values)
        if any(changed):
            self._publish()
        return any(changed)

    def _refuse_limit(self, name: str) -> None:
        if name.removeprefix(_PREFIX) in LIMIT_NAMES:
            raise UsageError(f'"{name}" is a limit of the haptic loop, set once at the start', 'set it under "safety"')

    def value(self, name: str) -> float:
        """The present value of a number by dotted name, e.g. "tunnel.stiffness".

        Raises:
            UsageError: a name that is no field of the haptic scene.
        """
        records, field = self._find(name)
        return float(records[0][field])

    def _set(self, name: str, value: object) -> bool:
        records, field = self._find(name)
        changed = False
        for record in records:
            wanted = _as_long_as(record[field], value)
            if not np.array_equal(record[field], wanted):
                record[field] = wanted
                changed = True
        if changed and name.removeprefix(_PREFIX).split(".")[0] in _DERIVED:
            self._block[0]["objects"]["revision"] += 1
        return changed

    def _find(self, name: str) -> tuple[list[Any], str]:
        """The records a dotted name leads to, and the field in them."""
        *groups, field = name.removeprefix(_PREFIX).split(".")
        if groups == ["tunnel"] and self._rows is not None and len(self._rows.tunnels):
            records, dtype = [self._rows.tunnels[self._block[0]["own_tunnel"]]], self._rows.tunnels.dtype
        elif len(groups) == 2 and groups[0] in Rows._fields and self._rows is not None:
            table = getattr(self._rows, groups[0])
            records, dtype = self._named(table, groups[0], groups[1], name), table.dtype
        else:
            records, dtype = [] if groups else [self._block[0]], SCENE
        if not records or field not in (dtype.names or ()):
            raise UsageError(f'"{name}" is no parameter of the haptic scene', nearest(field, dtype.names or ()))
        return records, field

    def _named(self, table: NDArray[Any], group: str, who: str, name: str) -> list[Any]:
        known = self._names.get(group, {})
        if who not in known:
            raise UsageError(f'"{name}" is no parameter of the haptic scene', nearest(who, known))
        return [table[row] for row in known[who]]


def _as_long_as(place: Any, value: object) -> Any:
    """A value for a place, a vector of a device's joints followed by zeros for those it does not have."""
    if np.ndim(place) == 0:
        return value
    given = np.asarray(value, np.float64).ravel()
    short = 0 < given.size < np.size(place)
    return np.concatenate([given, np.zeros(np.size(place) - given.size)]) if short else value
