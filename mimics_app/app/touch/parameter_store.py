"""Parameter store: the current haptic parameters, changed by dotted name and published as whole blocks."""

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
"""Tables whose changes must raise the revision, because the loop caches results derived from them."""

Receiver = Callable[[NDArray[Any], Rows | None], object]
"""Takes a SCENE record, shape [1], and the tables of objects."""

Record = np.void
"""A record of a structured array; its fields are numbers or arrays."""


class ParameterStore:
    """The current parameters; a block with a new sequence number is sent whenever a value changes.

    A dotted name is a field of SCENE ("virtual_mass"), of the task's own tunnel ("tunnel.stiffness"), or of a row of a
    table by its entity ("bodies.apple.mass", "shapes.table.stiffness", "tunnels.left.radius_scale"). Limits are those
    of the first block after `fit`: no later change may name one, and `replace` keeps them.

    Args:
        block: The first SCENE record, shape [1]; owned by the store from now on.
        rows: Tables of the objects; None without objects.
        names: Rows of each name, by table; several rows may share a name.
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
        """Set the values that depend on the device, limits included, before the first block is sent.

        Raises:
            UsageError: A name is no field of the haptic scene, or a block was sent already.
        """
        if self._receivers:
            raise UsageError("the device is fitted once, at the start", "call fit before send_to")
        changed = [self._set(name, value) for name, value in values.items()]
        self._fitted.update(values)
        if any(changed):
            self._publish()

    def send_to(self, *receivers: Receiver) -> None:
        """Send the current block and all later ones to these receivers in order."""
        self._receivers = receivers
        self._publish()

    def _publish(self) -> None:
        """Raise the sequence number and send the block with its rows."""
        self._block["sequence"] += 1
        for receive in self._receivers:
            receive(self._block, self._rows)

    def replace(
        self,
        block: NDArray[Any],
        rows: Rows | None = None,
        names: Mapping[str, Mapping[str, tuple[int, ...]]] | None = None,
    ) -> bool:
        """Take the parameters of a reloaded scene; the values changed so far are set again, and the limits are kept.

        Returns:
            Whether the new parameters have other limits.
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
        """Set fields by dotted name, e.g. {"tunnel.stiffness": 1500.0}; send one block if a value differs.

        Returns:
            Whether a value changed.

        Raises:
            UsageError: A name is no field of the haptic scene, or a limit.
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
        """Return the present value of a number by dotted name, e.g. "tunnel.stiffness".

        Raises:
            UsageError: The name is no field of the haptic scene.
        """
        records, field = self._find(name)
        return float(records[0][field])

    def _set(self, name: str, value: object) -> bool:
        records, field = self._find(name)
        changed = False
        for record in records:
            wanted = _padded(value, np.size(record[field]))
            if not np.array_equal(record[field], wanted):
                record[field] = wanted
                changed = True
        if changed and name.removeprefix(_PREFIX).split(".")[0] in _DERIVED:
            self._block[0]["objects"]["revision"] += 1
        return changed

    def _find(self, name: str) -> tuple[list[Record], str]:
        """Return the records of a dotted name, and its field in them."""
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

    def _named(self, table: NDArray[Any], group: str, who: str, name: str) -> list[Record]:
        known = self._names.get(group, {})
        if who not in known:
            raise UsageError(f'"{name}" is no parameter of the haptic scene', nearest(who, known))
        return [table[row] for row in known[who]]


def _padded(value: object, size: int) -> NDArray[Any]:
    """Return a value, a shorter vector followed by zeros: those of the joints that a device does not have."""
    given = np.asarray(value)
    return np.concatenate([given.ravel(), np.zeros(size - given.size)]) if 0 < given.size < size else given
