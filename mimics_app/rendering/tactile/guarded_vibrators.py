"""Vibrators that cannot end the session: what their driver raises makes them lost ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

from mimics_app.contracts.messages.stage_messages import TactileEvent
from mimics_app.contracts.ports.plugins import raised
from mimics_app.rendering.tactile.vibrators import Vibrators

__all__ = ["GuardedVibrators"]


class GuardedVibrators(Vibrators):
    """Passes taps to a driver until it raises; later ones are journalled as not sent.

    Args:
        driver: The driver.
    """

    def __init__(self, driver: Vibrators) -> None:
        self._driver = driver
        self._lost = ""

    def step(self, touches: Sequence[TactileEvent], now_ns: int) -> list[Mapping[str, object]]:
        """Send taps; see `Vibrators.step`."""
        if not self._lost:
            try:
                return self._driver.step(touches, now_ns)
            except Exception as error:  # noqa: BLE001  of a library: it must not end the session
                self._lost = f"the vibrators are lost: their driver {raised(error)}"
                if not touches:
                    return [{"problem": self._lost}]
        return [
            {"number": each.number, "at": each.place, "scheduled_ns": each.t_ns, "problem": self._lost}
            for each in touches
        ]

    def close(self) -> None:
        """Close the driver."""
        with suppress(Exception):  # of a library: everything else is closed after it
            self._driver.close()
