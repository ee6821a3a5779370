"""Report of the objects that the loop does not simulate: once on the terminal, and in the result of the run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from numpy.typing import NDArray

from mimics_app.app.terminal.output import say
from mimics_app.contracts.errors import counted
from mimics_app.contracts.loop.haptic import EventKind

__all__ = ["LossWatch"]


class LossWatch:
    """Finds losses among the loop's events.

    Args:
        effect_entities: Id of the entity of each row of effects.
        report: Shows a line to the person.
    """

    def __init__(self, effect_entities: Sequence[str], report: Callable[[str], None] = say) -> None:
        self._report = report
        self._names = effect_entities
        self._pairs = 0
        self._fields: list[str] = []

    def see(self, events: NDArray[Any]) -> None:
        """Take the EVENT records of a frame, oldest first."""
        for event in events:
            if event["kind"] == EventKind.LEFT_OUT:
                self._leave_out(int(event["force"]))
            elif event["kind"] == EventKind.QUARANTINE:
                self._quarantine(int(event["force"]))

    def summary(self) -> dict[str, Any]:
        """Return the largest number of pairs left out at once, and the ids of the force fields switched off."""
        return {"pairs_left_out": self._pairs, "fields_disabled": list(self._fields)}

    def _leave_out(self, pairs: int) -> None:
        if self._pairs == 0:
            what = f"{counted(pairs, 'pairs')} of neighbouring shapes exceed the capacity of the collision test"
            self._report(f"{what}: they do not collide; move the objects apart, or give them fewer shapes")
        self._pairs = max(self._pairs, pairs)

    def _quarantine(self, row: int) -> None:
        name = self._names[row] if row < len(self._names) else f"effect {row + 1}"
        self._report(f'the force field of "{name}" gave a number that is not finite: it acts no more')
        self._fields.append(name)
