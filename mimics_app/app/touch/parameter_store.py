"""Parameter store: the current haptic parameters, changed by dotted name and published as whole blocks.

What may be written while a session runs is a closed list: the numbers of `contracts.loop.field_ranges` that are marked
as written, each within its range; by the task manager also controller and trial. A person alone leaves a stop
(`reset`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError, counted, nearest
from mimics_app.contracts.loop.controller_slots import MAX_CONTROLLERS, MAX_OBSTACLES, Slot
from mimics_app.contracts.loop.field_ranges import Range, range_of, writable_names
from mimics_app.contracts.loop.haptic import LIMIT_NAMES, SCENE
from mimics_app.contracts.loop.object_rows import Rows
from mimics_app.contracts.messages.orders import HapticOrder
from mimics_app.rendering.haptic.block_check import check_values

__all__ = ["ParameterStore"]

_PREFIX = "haptic."

_DERIVED = frozenset(Rows._fields) - {"tunnels"}
"""Tables whose changes must raise the revision, because the loop caches results derived from them."""

_OF_TASK: Mapping[str, Range] = {"controller": Range(0, MAX_CONTROLLERS - 1), "trial": Range(0, 2.0**62)}
"""What the task manager writes besides."""

_CONTROLLERS = ("controller_names", "leads", "commands", "targets", "each_joint", "controller_parameters")
"""Fields of the controllers in the slots."""

_OF_SCENE: Mapping[str, Range] = {}

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
        self._steered: dict[int, float] = {}

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

        A value that the new scene has no place for is left out. A loop that runs keeps its controllers: where the new
        scene has others, they are kept with their parameters.

        Returns:
            Whether the new parameters have other limits, or other controllers.
        """
        for name in ("sequence", "resets", "obstacle_calls", "obstacle"):
            block[name] = self._block[name]
        kept = {name: self._block[0][name].copy() for name in LIMIT_NAMES}
        if not np.array_equal(block["controller_names"], self._block["controller_names"]):
            kept |= {name: self._block[0][name].copy() for name in _CONTROLLERS}
        self._block, self._rows, self._names = block, rows, names or {}
        for name, value in self._fitted.items():
            self._set(name, value)
        ordered, self._ordered = self._ordered, {}
        for name, value in ordered.items():
            with suppress(UsageError):
                self._write({name: value}, _OF_TASK)
        others = [self._set(name, value) for name, value in kept.items()]
        self._set_steered()
        self._publish()
        return any(others)

    def change(self, values: Mapping[str, object]) -> bool:
        """Set fields by dotted name, e.g. {"tunnel.stiffness": 1500.0}; send one block if a value differs.

        Returns:
            Whether a value changed.

        Raises:
            UsageError: A name may not be written, or a value is outside its range; then nothing changes.
        """
        changed = self._write(values, _OF_TASK)
        if changed:
            self._publish()
        return changed

    def order(self, order: HapticOrder, *, of_task: bool = False) -> dict[str, str]:
        """Set what may be set of the order of a task or a plug-in; the rest is refused, and the run continues.

        Args:
            order: The numbers.
            of_task: Whether they come from the task manager.

        Returns:
            Why a value was refused, by its name.
        """
        if not order.numbers:
            return {}
        values = {str(field): value for field, value in order.numbers.items()}
        may = _OF_TASK if of_task else _OF_SCENE
        refused: dict[str, str] = {}
        try:
            changed = self._write(values, may)
        except UsageError:
            changed = False
            for name, value in values.items():
                try:
                    changed |= self._write({name: value}, may)
                except UsageError as error:
                    refused[name] = error.what
        if changed:
            self._publish()
        return refused

    def reset(self) -> None:
        """Let the loop leave a latched stop; only for a person's own key or button."""
        self._block[0]["resets"] += 1
        self._publish()

    def steer_controller(self, components: Iterable[int], value: float) -> None:
        """Set parameters of the controller under which the person leads; only by a command, within declared limits.

        Args:
            components: Indices in SCENE.controller_parameters.
            value: Value of each, finite.
        """
        self._steered |= dict.fromkeys(components, value)
        self._set_steered()
        self._publish()

    def _set_steered(self) -> None:
        parameters = self._block[0]["controller_parameters"][Slot.PERSON]
        for component, value in self._steered.items():
            parameters[component] = value

    def call_obstacle(self, number: int) -> None:
        """Let the loop's controller begin an obstacle, by its number among the controller's.

        Raises:
            ValueError: The parameter block has no such number.
        """
        if not 0 <= number < MAX_OBSTACLES:
            raise ValueError(f"obstacle {number} of {MAX_OBSTACLES}")
        self._block[0]["obstacle"] = number
        self._block[0]["obstacle_calls"] += 1
        self._publish()

    def _write(self, values: Mapping[str, object], may: Mapping[str, Range]) -> bool:
        """Set values without sending them; return whether one differs. All or none are set.

        Raises:
            UsageError: A name may not be written, or a value is outside its range.
        """
        for name, value in values.items():
            self._check(name.removeprefix(_PREFIX), value, may)
        before = {name: self._present(name) for name in values}
        revision = int(self._block[0]["objects"]["revision"])
        changed = any([self._set(name, value) for name, value in values.items()])
        if changed:
            try:
                check_values(self._block, self._rows)
            except ValueError as error:
                self._block[0]["objects"]["revision"] = revision
                self._restore(before)
                raise UsageError(f"{', '.join(values)} cannot be set: {error}") from None
        self._ordered.update(values)
        return changed

    def _present(self, name: str) -> list[Any]:
        """Return copies of a value, one for each row of the name."""
        records, field = self._find(name)
        return [record[field].copy() for record in records]

    def _restore(self, values: Mapping[str, list[Any]]) -> None:
        for name, kept in values.items():
            records, field = self._find(name)
            for record, value in zip(records, kept, strict=True):
                record[field] = value

    def _check(self, name: str, value: object, may: Mapping[str, Range]) -> None:
        """Refuse a name that may not be written, and a value that is not a number or outside its range."""
        if name in LIMIT_NAMES:
            raise UsageError(f'"{name}" is a limit of the haptic loop, set once at the start', 'set it under "safety"')
        records, field = self._find(name)
        table = name.partition(".")[0] if "." in name else ""
        span = may.get(name) or range_of(table, field)
        if span is None:
            hint = nearest(field, writable_names(table)) if table != "points" and table != "wires" else ""
            raise UsageError(f'"{name}" may not be written while a session runs', hint)
        try:
            given = np.asarray(value, np.float64)
        except (TypeError, ValueError):
            given = np.zeros(0)
        size = np.size(records[0][field])
        if not 0 < given.size <= size:
            raise UsageError(f'"{name}" = {value!r} is refused: it takes {counted(size, "numbers")}')
        if not span.holds(given):
            raise UsageError(f'"{name}" = {value} is refused: it must be {span}')

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
            raise UsageError(f'unknown haptic parameter "{name}"', nearest(field, dtype.names or ()))
        return records, field

    def _named(self, table: NDArray[Any], group: str, who: str, name: str) -> list[Record]:
        known = self._names.get(group, {})
        if who not in known:
            raise UsageError(f'unknown haptic parameter "{name}"', nearest(who, known))
        return [table[row] for row in known[who]]


def _padded(value: object, size: int) -> NDArray[Any]:
    """Return a value, a shorter vector followed by zeros: those of the joints that a device does not have."""
    given = np.asarray(value)
    return np.concatenate([given.ravel(), np.zeros(size - given.size)]) if 0 < given.size < size else given
