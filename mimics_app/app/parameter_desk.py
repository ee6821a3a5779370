"""The haptic parameters as the frame changes them: dotted names in, whole parameter blocks out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimics_app.contracts.errors import UsageError, nearest
from mimics_app.contracts.haptic import SCENE, TUNNEL

__all__ = ["ParameterDesk"]

_PREFIX = "haptic."


class ParameterDesk:
    """Keeps the current SCENE record and hands a numbered copy on whenever a value in it changes.

    Args:
        block: The first SCENE record, shape [1]; the desk's own from now on.
    """

    def __init__(self, block: NDArray[Any]) -> None:
        self._block = block
        self._receivers: tuple[Callable[[NDArray[Any]], object], ...] = ()
        self._ordered: dict[str, object] = {}

    @property
    def block(self) -> NDArray[Any]:
        """The current record, shape [1]; read only."""
        return self._block

    def hand_to(self, *receivers: Callable[[NDArray[Any]], object]) -> None:
        """Hand every block from the present one on to the recorder that keeps it and the loop that obeys it."""
        self._receivers = receivers
        self._announce()

    def _announce(self) -> None:
        """Number the record and hand it to everybody."""
        self._block["sequence"] += 1
        for receive in self._receivers:
            receive(self._block)

    def replace(self, block: NDArray[Any]) -> None:
        """Take a whole new record (a reloaded scene); what was ordered so far still holds."""
        block["sequence"] = self._block["sequence"]
        self._block = block
        for name, value in self._ordered.items():
            self._set(name, value)
        self._announce()

    def change(self, values: Mapping[str, object]) -> bool:
        """Set fields by dotted name, e.g. {"tunnel.stiffness": 1500.0}; announce once if anything differs.

        Returns:
            Whether a value changed.

        Raises:
            UsageError: A name that is no field of the haptic scene.
        """
        changed = [self._set(name, value) for name, value in values.items()]
        self._ordered.update(values)
        if any(changed):
            self._announce()
        return any(changed)

    def value(self, name: str) -> float:
        """The present value of a number by dotted name, e.g. "tunnel.stiffness".

        Raises:
            UsageError: a name that is no field of the haptic scene.
        """
        record, field = self._find(name)
        return float(record[field])

    def _set(self, name: str, value: object) -> bool:
        record, field = self._find(name)
        if np.array_equal(record[field], value):  # type: ignore[arg-type]
            return False
        record[field] = value
        return True

    def _find(self, name: str) -> tuple[Any, str]:
        """The record a dotted name leads to, and the field in it."""
        record: Any = self._block[0]
        dtype: np.dtype[Any] = SCENE
        *groups, field = name.removeprefix(_PREFIX).split(".")
        if groups == ["tunnel"]:
            record, dtype = record["tunnel"], TUNNEL
        if (groups and groups != ["tunnel"]) or field not in (dtype.names or ()):
            raise UsageError(f'"{name}" is no parameter of the haptic scene', nearest(field, dtype.names or ()))
        return record, field
