"""A source of body signals that cannot end the session: what it raises makes it a lost source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import Experience, SignalBlock
from mimics_app.contracts.ports.input_port import SignalSource
from mimics_app.contracts.ports.plugins import raised
from mimics_app.inputs.physio.integrity import Faults

__all__ = ["CheckRate", "GuardedSource", "any_rate"]

CheckRate = Callable[[str, float], None]
"""(name of a signal, its rate [Hz]); raises DeviceError for a rate that cannot be processed."""

_Answer = TypeVar("_Answer")


def any_rate(name: str, rate: float) -> None:
    """Accept every rate."""


class GuardedSource(SignalSource):
    """Passes every call to a source until one of them raises, or a read returns what cannot be processed.

    Args:
        source: The source.
        who: Begins the sentence that says what it did: "its plug-in", 'the source "lsl:ECG"'.
        check_rate: Checks the rate of each signal, which may not change either.
    """

    def __init__(self, source: SignalSource, who: str, check_rate: CheckRate = any_rate) -> None:
        self._source, self._who, self._check_rate = source, who, check_rate
        self._rates: dict[str, float] = {}
        self._fault = ""

    @property
    def lost(self) -> str:
        """Why there are no more samples; "" while there are."""
        found = self._call(lambda: self._source.lost, "")
        return self._fault or found

    @property
    def clock_offset_s(self) -> float | None:
        """Newest offset of the sender's clock [s], of a source that measures one."""
        none: float | None = None
        return self._call(lambda: getattr(self._source, "clock_offset_s", none), none)

    @property
    def faults(self) -> Mapping[str, Faults]:
        """Faults of each signal so far, of a source that counts them."""
        none: Mapping[str, Faults] = {}
        return self._call(lambda: getattr(self._source, "faults", none), none)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a source says of its columns: which were read, and which were not."""
        return self._call(lambda: tuple(getattr(self._source, "notes", ())), ())

    def read(self, now_ns: int) -> tuple[SignalBlock, ...]:
        """Return the blocks since the last call; () after a fault."""
        none: tuple[SignalBlock, ...] = ()
        blocks = self._call(lambda: self._source.read(now_ns), none)
        if not isinstance(blocks, Sequence) or not all(isinstance(block, SignalBlock) for block in blocks):
            self._fault = f"{self._who} returned something other than a tuple of {SignalBlock.__module__}.SignalBlock"
            return none
        try:
            for block in blocks:
                self._admit(block)
        except DeviceError as error:
            self._fault = str(error)
            return none
        return blocks

    def take_experience(self, experience: Experience) -> None:
        """Pass the experience of this frame."""
        self._call(lambda: self._source.take_experience(experience), None)

    def close(self) -> None:
        """Close the source, also after a fault, so that its port is free."""
        self._fault = ""
        self._call(self._source.close, None)

    def _admit(self, block: SignalBlock) -> None:
        """Check the rate of a block.

        Raises:
            DeviceError: It cannot be processed, or is another than before.
        """
        before = self._rates.get(block.name)
        if before is None:
            self._check_rate(block.name, block.rate)
            self._rates[block.name] = block.rate
        elif before != block.rate:
            what = f'the rate of the signal "{block.name}" changed from {before:g} Hz to {block.rate:g} Hz'
            raise DeviceError(what, "set the amplifier to one rate")

    def _call(self, call: Callable[[], _Answer], otherwise: _Answer) -> _Answer:
        if self._fault:
            return otherwise
        try:
            return call()
        except Exception as error:  # noqa: BLE001  of a library or a third party: it must not end the session
            self._fault = f"{self._who} {raised(error)}"
            return otherwise
