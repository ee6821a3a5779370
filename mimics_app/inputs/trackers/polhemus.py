"""Polhemus Fastrak in ASCII, also used by InterSense devices: records of 47 bytes, inches or centimetres.

A record is station "01", a space or an error letter, six numbers of seven characters (x y z, azimuth, elevation, roll
in degrees), and CR LF. It has no checksum: only its format can be checked, and its agreement with the next record.
"""

from __future__ import annotations

import math
import re

from mimics_app.contracts.ports.tracker_port import TrackerSample

__all__ = ["RECORD_BYTES", "FastrakParser", "euler_quaternion", "fastrak_record"]

RECORD_BYTES = 47
_FORM = re.compile(rb"0([1-4]) ((?: *-?\d{1,3}\.\d\d){6})\r\n")
_MOST_WAITING = 4096
"""Bytes kept without a complete record; then they are dropped."""


class FastrakParser:
    """Parser of the byte stream; nothing of a damaged record is used.

    Args:
        metres: Metres per unit of the device.

    Attributes:
        rejected: Number of lines that were not records.
    """

    def __init__(self, metres: float) -> None:
        self._metres = metres
        self._waiting = bytearray()
        self.rejected = 0

    def feed(self, data: bytes, t_ns: int) -> list[TrackerSample]:
        """Take bytes that arrived at a time [ns] and return the complete reports."""
        self._waiting += data
        found = []
        while (end := self._waiting.find(b"\n")) >= 0:
            line = bytes(self._waiting[: end + 1])
            del self._waiting[: end + 1]
            sample = self._read(line, t_ns)
            if sample is None:
                self.rejected += 1
            else:
                found.append(sample)
        if len(self._waiting) > _MOST_WAITING:
            self.rejected += 1
            self._waiting.clear()
        return found

    def _read(self, line: bytes, t_ns: int) -> TrackerSample | None:
        match = _FORM.fullmatch(line)
        if match is None or len(line) != RECORD_BYTES:
            return None
        # Numbers are in columns: a byte lost in one and gained in another shifts the decimal points.
        columns = [line[3 + 7 * i : 10 + 7 * i] for i in range(6)]
        if any(column[4:5] != b"." for column in columns):
            return None
        x, y, z, azimuth, elevation, roll = (float(column) for column in columns)
        if max(abs(azimuth), abs(roll)) > 180.0 or abs(elevation) > 90.0:
            return None
        place = (x * self._metres, y * self._metres, z * self._metres)
        return TrackerSample(match[1].decode(), t_ns, place, euler_quaternion(azimuth, elevation, roll))


def fastrak_record(
    station: int, position: tuple[float, float, float], angles: tuple[float, float, float], metres: float
) -> bytes:
    """Return the record of a station, for emulators.

    Args:
        station: 1 to 4.
        position: [m].
        angles: Azimuth, elevation, roll [deg].
        metres: Metres per unit of the device.
    """
    numbers = (*(value / metres for value in position), *angles)
    return b"0%d " % station + b"".join(b"%7.2f" % value for value in numbers) + b"\r\n"


def euler_quaternion(azimuth: float, elevation: float, roll: float) -> tuple[float, float, float, float]:
    """Return the quaternion x y z w of rotations about z, the new y and the new x [deg], as both makers define them."""
    a, e, r = (math.radians(angle) / 2.0 for angle in (azimuth, elevation, roll))
    ca, sa, ce, se, cr, sr = math.cos(a), math.sin(a), math.cos(e), math.sin(e), math.cos(r), math.sin(r)
    return (
        ca * ce * sr - sa * se * cr,
        ca * se * cr + sa * ce * sr,
        sa * ce * cr - ca * se * sr,
        ca * ce * cr + sa * se * sr,
    )
