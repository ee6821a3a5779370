"""A source of body signals of another package, which cannot end the session: what it raises makes it a lost source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from mimics_app.contracts.input_port import SignalSource
from mimics_app.contracts.messages import Experience, SignalBlock
from mimics_app.contracts.plugins import raised
from mimics_app.inputs.physio.integrity import Faults

__all__ = ["GuardedSource"]

_Answer = TypeVar("_Answer")


class GuardedSource(SignalSource):
    """Passes every call to a source until one of them raises, or a read returns anything but blocks.

    Args:
        source: The source of a plug-in.
    """

    def __init__(self, source: SignalSource) -> None:
        self._source = source
        self._fault = ""

    @property
    def lost(self) -> str:
        """Why there are no more samples; "" while there are."""
        found = self._call(lambda: self._source.lost, "")
        return self._fault or found

    @property
    def faults(self) -> Mapping[str, Faults]:
        """Faults of each signal so far, of a source that counts them."""
        return getattr(self._source, "faults", {})

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the blocks since the last call; () after a fault."""
        none: tuple[SignalBlock, ...] = ()
        blocks = self._call(lambda: self._source.read(now_ns), none)
        if isinstance(blocks, Sequence) and all(isinstance(block, SignalBlock) for block in blocks):
            return blocks
        self._fault = "its plug-in returned something other than a tuple of mimics_app.contracts.messages.SignalBlock"
        return none

    def feel(self, experience: Experience) -> None:
        """Pass the experience of this frame."""
        self._call(lambda: self._source.feel(experience), None)

    def close(self) -> None:
        """Close the source, also after a fault, so that its port is free."""
        self._fault = ""
        self._call(self._source.close, None)

    def _call(self, call: Callable[[], _Answer], otherwise: _Answer) -> _Answer:
        if self._fault:
            return otherwise
        try:
            return call()
        except Exception as error:  # noqa: BLE001  of a third party
            self._fault = f"its plug-in {raised(error)}"
            return otherwise
