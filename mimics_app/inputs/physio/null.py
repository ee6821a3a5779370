"""No recorder of body signals is connected: no signals, rather than made-up ones."""

from __future__ import annotations

from mimics_app.contracts.messages import Experience, SignalBlock

__all__ = ["NoSignals"]


class NoSignals:
    """A `SignalSource` that never has a block."""

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Nothing has arrived, whatever the time."""
        return ()

    def feel(self, experience: Experience) -> None:
        """Nobody is measured."""

    def close(self) -> None:
        """Nothing is open."""
