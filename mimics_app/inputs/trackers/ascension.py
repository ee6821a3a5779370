"""Ascension Flock of Birds: binary records of six words of 14 bits, the first byte marked by its phasing bit (bit 7).

Position and angles ("Y"): x, y, z as shares of 36 inch, then rotations about z, y, x as shares of 180 degrees.
"""

from __future__ import annotations

from mimics_app.contracts.ports.tracker_port import TrackerSample
from mimics_app.inputs.trackers.polhemus import euler_quaternion

__all__ = ["RECORD_BYTES", "FlockParser", "flock_record"]

RECORD_BYTES = 12
_RANGE_M = 36 * 0.0254
_FULL = 32768.0
_PHASE = 0x80


class FlockParser:
    """Parser of the byte stream, synchronised by the phasing bit; records that are too short or too long are dropped.

    Attributes:
        rejected: Number of incomplete records.
    """

    def __init__(self) -> None:
        self._waiting = bytearray()
        self._astray = False
        self.rejected = 0

    def feed(self, data: bytes, t_ns: int) -> list[TrackerSample]:
        """Take bytes that arrived at a time [ns] and return the complete reports."""
        found = []
        for byte in data:
            if byte & _PHASE:
                if self._waiting:
                    self.rejected += 1
                self._waiting, self._astray = bytearray([byte]), False
            elif self._waiting:
                self._waiting.append(byte)
            elif not self._astray:
                self._astray = True
                self.rejected += 1
            if len(self._waiting) == RECORD_BYTES:
                found.append(_read(self._waiting, t_ns))
                self._waiting.clear()
        return found


def flock_record(position: tuple[float, float, float], angles: tuple[float, float, float]) -> bytes:
    """Return the record of a position [m] and rotations about z, y, x [deg], for emulators."""
    shares = [value / _RANGE_M for value in position] + [angle / 180.0 for angle in angles]
    record = bytearray()
    for share in shares:
        word = (max(-32768, min(32767, round(share * _FULL))) & 0xFFFF) >> 2
        record += bytes((word & 0x7F, word >> 7))
    record[0] |= _PHASE
    return bytes(record)


def _read(record: bytearray, t_ns: int) -> TrackerSample:
    words = []
    for i in range(6):
        word = ((record[2 * i] & 0x7F) | record[2 * i + 1] << 7) << 2
        words.append(word - 65536 if word >= 32768 else word)
    x, y, z = (word / _FULL * _RANGE_M for word in words[:3])
    azimuth, elevation, roll = (word / _FULL * 180.0 for word in words[3:])
    return TrackerSample("1", t_ns, (x, y, z), euler_quaternion(azimuth, elevation, roll))
