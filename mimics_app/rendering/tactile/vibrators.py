"""Vibrators of a session: on a serial line, or absent, with only the times of the taps recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Protocol

from mimics_app.contracts.clock import SECOND_NS, MonotonicClock
from mimics_app.contracts.errors import DeviceError
from mimics_app.contracts.messages.stage_messages import TactileEvent
from mimics_app.contracts.ports.plugins import raised
from mimics_app.rendering.tactile.wire import FRAME_BYTES, Command, command_bytes, read_answers

__all__ = ["GuardedVibrators", "NoVibrators", "SerialVibrators", "Vibrators"]

_BITS = 10
"""Bits of a byte on the line: start, eight, stop."""

_WRITE_TIMEOUT_S = 0.05


class Vibrators(Protocol):
    """Driver of a set of vibrators."""

    def step(self, touches: Sequence[TactileEvent], now_ns: int) -> list[Mapping[str, object]]:
        """Send taps; return one line for the journal per tap: when it will be felt, and the error of that time."""
        ...

    def close(self) -> None:
        """Close the line."""
        ...


class NoVibrators(Vibrators):
    """A session without vibrators: taps are recorded with their times and not felt."""

    def step(self, touches: Sequence[TactileEvent], now_ns: int) -> list[Mapping[str, object]]:
        return [_line(each, max(each.t_ns, now_ns), now_ns, channel=None) for each in touches]

    def close(self) -> None:
        """Nothing is open."""


class SerialVibrators(Vibrators):
    """A vibrator box on a serial line; taps are sent ahead and timed by the box.

    A lost line is reported once; later taps are not sent.

    Args:
        port: Serial port.
        channels: Vibrator by place of the body.
        baud: [bit/s].

    Raises:
        DeviceError: The line cannot be opened.

    Attributes:
        answered: Numbers of the taps that the box acknowledged.
    """

    def __init__(self, port: str, channels: Mapping[str, int], baud: int = 115200) -> None:
        self._channels, self._clock = dict(channels), MonotonicClock()
        self._wire_ns = FRAME_BYTES * _BITS * SECOND_NS // baud
        self._waiting = bytearray()
        self._lost = ""
        self.answered: list[int] = []
        import serial

        try:
            self._line = serial.Serial(port, baud, timeout=0, write_timeout=_WRITE_TIMEOUT_S)
        except (OSError, ValueError) as error:
            what = f"the vibrators on {port} cannot be opened: {error}"
            raise DeviceError(what, "mimics devices lists the serial ports") from None

    def step(self, touches: Sequence[TactileEvent], now_ns: int) -> list[Mapping[str, object]]:
        lines = [self._order(each) for each in touches]
        if self._lost:
            return lines
        try:
            self._waiting += self._line.read(4096)
        except OSError as error:
            self._lost = f"the vibrators' line is gone: {error}"
            lines.append({"problem": self._lost})
        self.answered += read_answers(self._waiting)
        return lines

    def close(self) -> None:
        self._line.close()

    def _order(self, touch: TactileEvent) -> Mapping[str, object]:
        channel = self._channels.get(touch.place)
        now_ns = self._clock.now_ns()
        if channel is None:
            return {**_line(touch, now_ns, now_ns, None), "problem": f'no vibrator at "{touch.place}"'}
        if self._lost:
            return {**_line(touch, now_ns, now_ns, channel), "problem": f"not sent: {self._lost}"}
        # The frames of a call follow each other on the line, which is empty between calls.
        wait_ns = max(0, touch.t_ns - now_ns - self._wire_ns)
        command = Command(
            channel, round(255 * touch.strength), round(1000 * touch.seconds), wait_ns // 1000, touch.number
        )
        try:
            self._line.write(command_bytes(command))
        except OSError as error:  # also a write time-out
            return {**_line(touch, now_ns, now_ns, channel), "problem": f"not sent: {error}"}
        return _line(touch, now_ns + self._wire_ns + wait_ns, now_ns, channel)


def _line(touch: TactileEvent, onset_ns: int, now_ns: int, channel: int | None) -> Mapping[str, object]:
    error_ms = (onset_ns - touch.t_ns) * 1e-6
    times = {"scheduled_ns": touch.t_ns, "commanded_ns": now_ns, "felt_ns": onset_ns, "error_ms": error_ms}
    return {"number": touch.number, "at": touch.place, "channel": channel, **times}


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
