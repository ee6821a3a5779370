"""The two protocols of a serial amplifier, lines of text and binary frames, with one reader that resynchronises.

Lines, ASCII, one sample of every channel each:

    # rate=1000 channels=ecg,gsr,emg,resp
    12345,0.512,4.103,0.001,0.020

The header comes first and again at least every two seconds. The number in front counts samples, modulo 2^32.

Binary, little endian:

    A5 5A | kind u8 | count u8 | number u32 | payload | CRC-16/CCITT from kind to payload

    kind 1, header: count = channels, payload = rate f32, then for each channel 8 bytes of name in ASCII, filled with 0
    kind 2, samples: count = samples, number = of the first of them, payload = count * channels f32
"""

from __future__ import annotations

import binascii
import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["AmplifierReader", "Samples"]

_MARK = b"\xa5\x5a"
_HEAD = struct.Struct("<BBI")
_HEADER_KIND, _SAMPLES_KIND = 1, 2
_NAME = 8
_MOST_CHANNELS = 16
_LONGEST = 4096
"""Bytes without a whole frame or line after which the first of them is dropped."""
_NUMBERS = 1 << 32


@dataclass(frozen=True, slots=True)
class Samples:
    """Consecutive samples: count of the first, values of shape [n, channels]."""

    number: int
    values: NDArray[np.float64]


class AmplifierReader:
    """Parser of the byte stream, of either protocol.

    A header that differs from the first one is taken when it comes twice in succession: a line has no checksum.

    Attributes:
        rate: Sampling rate [Hz], 0 before the first header.
        channels: Names as the amplifier states them, () before the first header.
        damaged: Number of frames and lines that could not be read.
    """

    def __init__(self) -> None:
        self.rate = 0.0
        self.channels: tuple[str, ...] = ()
        self.damaged = 0
        self._bytes = bytearray()
        self._differing: tuple[float, list[str]] | None = None

    def feed(self, data: bytes) -> list[Samples]:
        """Take bytes and return the samples that are complete; those before the first header are dropped."""
        self._bytes += data
        found: list[Samples] = []
        while self._bytes:
            used, samples = self._binary() if self._bytes[0] == _MARK[0] else self._line()
            if used == 0:
                if len(self._bytes) <= _LONGEST:
                    break
                self.damaged += 1
                used = 1 if self._bytes[0] == _MARK[0] else len(self._bytes) - 1  # the last one may begin a mark
            del self._bytes[:used]
            if samples is not None:
                found.append(samples)
        return found

    def _binary(self) -> tuple[int, Samples | None]:
        """Read the frame at the beginning: bytes consumed (0 while it is incomplete) and its samples."""
        data = self._bytes
        if len(data) < len(_MARK) + _HEAD.size:
            return 0, None
        kind, count, number = _HEAD.unpack_from(data, len(_MARK))
        if data[1] != _MARK[1] or kind not in (_HEADER_KIND, _SAMPLES_KIND):
            return self._lost()
        if kind == _SAMPLES_KIND and not self.channels:
            return 1, None  # its length is not known yet
        size = 4 + _NAME * count if kind == _HEADER_KIND else 4 * count * len(self.channels)
        end = len(_MARK) + _HEAD.size + size
        if len(data) < end + 2:
            return 0, None
        body = bytes(data[len(_MARK) : end])
        if binascii.crc_hqx(body, 0xFFFF) != int.from_bytes(data[end : end + 2], "little"):
            return self._lost()
        payload = body[_HEAD.size :]
        if kind == _HEADER_KIND:
            names = [payload[i : i + _NAME].rstrip(b"\0") for i in range(4, len(payload), _NAME)]
            self._announce(struct.unpack_from("<f", payload)[0], [name.decode("ascii", "replace") for name in names])
            return end + 2, None
        values = np.frombuffer(payload, "<f4").astype(float).reshape(count, len(self.channels))
        return end + 2, Samples(number, values)

    def _lost(self) -> tuple[int, None]:
        """Count a damaged frame and resynchronise: the bytes up to the next mark or line."""
        self.damaged += 1
        places = (self._bytes.find(_MARK, 1), self._bytes.find(b"\n", 1) + 1)
        return min((place for place in places if place > 0), default=len(self._bytes)), None

    def _line(self) -> tuple[int, Samples | None]:
        end = self._bytes.find(b"\n")
        mark = self._bytes.find(_MARK)
        if 0 <= mark and (end < 0 or mark < end):
            self.damaged += 1
            return mark, None
        if end < 0:
            return 0, None
        text = bytes(self._bytes[:end]).strip()
        try:
            return end + 1, self._parse(text.decode("ascii"))
        except (ValueError, UnicodeDecodeError):
            self.damaged += 1
            return end + 1, None

    def _parse(self, text: str) -> Samples | None:
        """Read a line: its samples, None of a header.

        Raises:
            ValueError: It is neither a header nor a sample.
        """
        if text.startswith("#"):
            words = dict(word.split("=", 1) for word in text[1:].split() if "=" in word)
            self._announce(float(words.get("rate", "nan")), words.get("channels", "").split(","))
            return None
        if not text or not self.channels:
            return None
        number, *values = text.split(",")
        if len(values) != len(self.channels):
            raise ValueError("the number of values differs from that of the channels")
        return Samples(int(number) % _NUMBERS, np.array([[float(value) for value in values]]))

    def _announce(self, rate: float, channels: list[str]) -> None:
        if not 1.0 <= rate <= 20_000.0 or not 1 <= len(channels) <= _MOST_CHANNELS or not all(channels):
            self.damaged += 1
            return
        differs = bool(self.channels) and (rate, tuple(channels)) != (self.rate, self.channels)
        if differs and self._differing != (rate, channels):
            self.damaged += 1
            self._differing = rate, channels
            return
        self.rate, self.channels, self._differing = float(rate), tuple(channels), None
