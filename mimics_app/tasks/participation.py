"""Whether the person takes part in a trial, and the assistance, which waits for that."""

from __future__ import annotations

from collections.abc import Mapping

from mimics_app.contracts.messages.orders import HapticField
from mimics_app.tasks.observation import Observation

__all__ = ["Participation"]

_SET_OUT_J = 0.005
"""Work of the person on the handle from which the hand has set out by itself [J]: a mass of 3 kg at 6 cm/s. The work
of a passive hand is never above zero, and the noise of a force sensor sums up to a tenth of this."""
_RISE_S = 0.5
"""Time in which the assistance rises from nothing to all of it [s]."""
_LEADING = "advance"
"""Name of haptic fields of tunnels whose force leads the hand along a path by itself."""


def _leads(number: HapticField) -> bool:
    return number.field == _LEADING and bool(number.table)


class Participation:
    """Follows the person through the travel of a trial.

    Assistance that leads the hand to the goal begins when the hand has set out by itself; so it helps those who move
    and carries nobody. In a passive task it begins at the go.

    Args:
        passive: Whether the task is meant to be done without any action of the person.

    Attributes:
        acted: Whether the person has taken part in the travel so far; always in a passive task.
    """

    def __init__(self, *, passive: bool) -> None:
        self._passive = passive
        self.restart()

    def restart(self) -> None:
        """Begin an attempt: nobody has acted, and nothing assists."""
        self.acted = self._passive
        self._share = 0.0

    def see(self, seen: Observation, seconds: float) -> None:
        """Take a frame of the travel with its duration [s]."""
        self.acted = self.acted or seen.own_work >= _SET_OUT_J
        if self.acted:
            self._share = min(1.0, self._share + seconds / _RISE_S)

    def allow(self, haptic: Mapping[HapticField, object]) -> dict[HapticField, object]:
        """Return haptic orders with the present share of those that lead the hand."""
        return {
            field: self._share * value if _leads(field) and isinstance(value, int | float) else value
            for field, value in haptic.items()
        }
